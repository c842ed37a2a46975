"""Kills a run at random moments, goes on, and compares every artefact with an uninterrupted run.

    OMP_NUM_THREADS=1 python benchmarks/kill_soak.py --kills 50 --out out/kills

The whole protocol on the narrow channel, as small as it can be with checkpoints worth losing. The
program that runs it is ended by SIGKILL a random time after its first stage began or was found
finished, so that kills hit work and not the start of Python; its workers follow by themselves. When
a run comes to its end, every file of every stage is compared with the reference by its SHA-256, and
a new run begins in another folder, until all kills are spent. Prints the learning steps that were
repeated: for each stage that was under way at a kill, the steps it had last told, minus those of
the checkpoint it went on from. A worker tells its steps five times a second.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from surmount.core.configuration import override
from surmount.core.records import file_hash
from surmount.experiment.presets import preset
from surmount.experiment.running import begin
from surmount.workflow.executors import make_executor
from surmount.workflow.monitor import Progress
from surmount.workflow.store import sole_user

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from plain_run import run

CHANGES = {
    "networks": 2,
    "initial_steps": 20_000,
    "checkpoint_steps": 2_000,
    "env.step_s": 0.1,
    "env.episode_s": 4.0,
    "learner.hidden_layers": [32, 32],
    "learner.rollout_steps": 64,
    "learner.batch_size": 192,
    "trials.repetitions": 2,
    "tests.repetitions": 2,
    "analysis.components": 2,
    "analysis.bootstrap": 5,
    "advancement.iteration_steps": 10_000,
    "advancement.extension_steps": 5_000,
    "advancement.window_steps": 2_000,
    "advancement.max_extensions": 1,
}
WENT_ON = "went on from the checkpoint at "


class Watcher:  # as `RunObserver` describes it
    """Writes what stages tell to a file that outlives the kill."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("a", encoding="utf-8")

    def stage_outdated(self, stage: str, folders) -> None:
        pass

    def stage_reused(self, artefact) -> None:
        self._write(artefact.stage, "reused", 0)

    def stage_started(self, stage: str) -> None:
        self._write(stage, "started", 0)

    def stage_finished(self, artefact, seconds: float) -> None:
        self._write(artefact.stage, "finished", 0)

    def stage_lost(self, stage: str, *, again: bool) -> None:
        self._write(stage, "lost", 0)

    def listen(self, event) -> None:
        told = event.told
        if isinstance(told, Progress) and told.unit == "steps":
            self._write(event.stage, "steps", told.done)
        elif isinstance(told, str) and told.startswith(WENT_ON):
            steps = told.removeprefix(WENT_ON).split()[0].replace(",", "")
            self._write(event.stage, "resumed", int(steps))

    def _write(self, stage: str, kind: str, steps: int) -> None:
        self._file.write(json.dumps([stage, kind, steps]) + "\n")
        self._file.flush()


def work(root: Path, log: Path) -> None:
    config = override(preset("narrow-channel", "smoke"), CHANGES)
    with sole_user(root):
        begin(root, config)
        watcher = Watcher(log)
        executor = make_executor(2, watcher.listen)
        try:
            run(root, config, executor, watcher)
        finally:
            executor.close()


def content(root: Path) -> dict[str, str]:
    """Return the hash of every file of every finished stage, of the files themselves."""
    return {
        path.relative_to(root).as_posix(): file_hash(path)
        for path in sorted((root / "stages").rglob("*"))
        if path.is_file()
    }


def repeated_steps(log: Path) -> tuple[int, int]:
    """Return the learning steps repeated and done in all, from what stages told."""
    last: dict[str, int] = {}
    repeated = done = 0
    for line in log.read_text(encoding="utf-8").splitlines():
        stage, kind, steps = json.loads(line)
        if kind == "started":
            before = last.get(stage, 0)
            repeated += before
            last[stage] = 0
        elif kind == "resumed":
            repeated -= steps  # of what was counted as lost, this was not
            last[stage] = steps
        elif kind == "steps":
            done += max(0, steps - last.get(stage, 0))
            last[stage] = steps
        elif kind == "finished":
            last.pop(stage, None)
    return repeated, done


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--shortest", type=float, default=0.0, help="least seconds to a kill")
    parser.add_argument("--longest", type=float, default=20.0, help="most seconds to a kill")
    parser.add_argument("--out", type=Path, default=Path("out/kills"))
    parser.add_argument("--work", type=Path, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.work is not None:
        work(chosen.work, chosen.out)
        return
    shutil.rmtree(chosen.out, ignore_errors=True)
    chosen.out.mkdir(parents=True)
    began = time.monotonic()
    work(chosen.out / "reference", chosen.out / "reference.log")
    print(f"uninterrupted: {time.monotonic() - began:.0f} s", flush=True)
    expected = content(chosen.out / "reference")
    rng = random.Random(chosen.seed)  # noqa: S311
    kills = runs = repeated = done = 0
    while kills < chosen.kills:
        root, log = chosen.out / f"run-{runs}", chosen.out / f"run-{runs}.log"
        finished = False
        while not finished:
            limit = rng.uniform(chosen.shortest, chosen.longest) if kills < chosen.kills else None
            finished = attempt(root, log, limit)
            kills += not finished
        found = content(root)
        if found != expected:
            different = [name for name in expected if found.get(name) != expected[name]]
            sys.exit(f"{root} differs from the reference in {different}")
        again, whole = repeated_steps(log)
        repeated, done, runs = repeated + again, done + whole, runs + 1
        print(f"run {runs}: identical, {len(expected)} files; {kills} kills so far; {again:,} of "
              f"{whole:,} steps repeated", flush=True)  # fmt: skip
    print(f"{kills} kills over {runs} runs: all artefacts identical; {repeated:,} of {done:,} "
          f"learning steps were repeated ({100 * repeated / done:.1f} %), {repeated / kills:,.0f} "
          f"per kill; a checkpoint every {CHANGES['checkpoint_steps']:,}")  # fmt: skip


def attempt(root: Path, log: Path, limit: float | None) -> bool:
    """Go on with a run, kill it some time after it began, and say whether it came to its end."""
    command = [sys.executable, __file__, "--work", str(root), "--out", str(log)]
    told = log.stat().st_size if log.exists() else 0
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)  # noqa: S603
    while process.poll() is None and (not log.exists() or log.stat().st_size == told):
        time.sleep(0.05)
    try:
        code = process.wait(timeout=limit)
    except subprocess.TimeoutExpired:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        return False
    if code:
        sys.exit(f"{root} ended with code {code}")
    return True


if __name__ == "__main__":
    multiprocessing.freeze_support()
    main()
