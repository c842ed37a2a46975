"""Kills workers and runs at chosen moments of every stage, and compares every artefact.

    OMP_NUM_THREADS=1 python benchmarks/aimed_kills.py --kills 50 --out out/aimed
    OMP_NUM_THREADS=1 python benchmarks/aimed_kills.py --kills 50 --ray --out out/aimed-ray

Where `kill_soak.py` kills at random, this aims: half-way through writing a checkpoint and right
after it, before a stage's manifest, between the manifest and the rename that publishes the stage,
after the rename, and after the checkpoint was dropped but before the runner is told. Each moment of
each stage once; of thirteen kills, twelve end the worker (its stage is run again) and one the
whole run (the same command is given again). Afterwards every file of every stage is compared by
its SHA-256 with a run in one process that nobody disturbed, and nothing unfinished may be left.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from plain_run import run
from ray_head import ray_cluster
from small import Watcher, small_config

from kill_soak import content
from surmount.experiment.protocol import protocol
from surmount.experiment.running import begin
from surmount.workflow.executors import make_executor
from surmount.workflow.run_layout import TRAININGS
from surmount.workflow.store import sole_user

AIM = Path(__file__).parent / "aim"
MOMENTS = (
    "within a checkpoint",
    "after a checkpoint",
    "before the manifest",
    "between manifest and rename",
    "after the rename",
    "before it is told",
)
OF_TRAININGS = 2
"""The first so many moments are of stages that save themselves."""
RETRIES = 1000
RUN_EVERY = 13
"""Of so many kills one ends the whole run."""
PRELOADED = ["surmount.workflow.work", "surmount.rstar.family", "surmount.experiment.statistics"]


def work(root: Path, networks: int, executor: str, address: str | None) -> None:
    if executor == "processes":  # workers are forked from a server that has imported everything
        server = multiprocessing.get_context("forkserver")
        server.set_forkserver_preload(PRELOADED)
        multiprocessing.get_context = lambda _method=None: server
    config = small_config(networks=networks)
    watcher = Watcher()
    with sole_user(root):
        begin(root, config)
        processes = {"in-process": 0, "processes": 2, "ray": None}[executor]
        kind = "processes" if executor == "in-process" else executor
        made = make_executor(processes, watcher.listen, kind=kind, address=address)
        try:
            run(root, config, made, watcher, retries=RETRIES)
        finally:
            made.close()


def moments(networks: int, kills: int) -> list[str]:
    """Return so many moments, evenly over all stages: ``<moment>@<stage>``."""
    found = [
        f"{moment}@{stage.name.replace('/', '%')}"
        for place, stage in enumerate(protocol(small_config(networks=networks)))
        for number, moment in enumerate(MOMENTS)
        if number >= OF_TRAININGS or stage.name.split("/")[0] in TRAININGS
        if number != len(MOMENTS) - 1 - place % 2  # after either, the stage is found finished
    ]
    chosen = min(kills, len(found))
    return [found[index * len(found) // chosen] for index in range(chosen)]


def command(root: Path, networks: int, executor: str, address: str | None = None) -> list[str]:
    given = [sys.executable, __file__, "--work", str(root), "--executor", executor]
    given += ["--networks", str(networks)]
    return given if address is None else [*given, "--address", address]


def soak(out: Path, reference: Path, networks: int, kills: int, executor: str) -> None:
    aims, hits = out / "aims", out / "hits"
    for folder in (aims, hits):
        folder.mkdir()
    os.environ |= {"SURMOUNT_AIM": str(aims.resolve()), "SURMOUNT_HITS": str(hits.resolve())}
    sys.path.insert(0, str(AIM))
    wanted = moments(networks, kills)
    for index, name in enumerate(wanted):
        (aims / name).write_text("worker" if index % RUN_EVERY else "run", encoding="utf-8")
    root, began, calls = out / "run", time.monotonic(), 0
    with contextlib.ExitStack() as stack:
        address, environment = None, {"PYTHONPATH": os.pathsep.join(sys.path)}
        if executor == "ray":
            address, environment = stack.enter_context(ray_cluster(workers=2))
        code = None
        while code != 0:
            calls += 1
            driver = subprocess.Popen(  # noqa: S603
                command(root, networks, executor, address), env=os.environ | environment
            )
            (hits / "driver").write_text(str(driver.pid), encoding="utf-8")
            code = driver.wait()
            if code not in (0, -9):
                sys.exit(f"{root} ended with code {code}")
    done = {path.name for path in hits.iterdir()} - {"driver"}
    missed = [name for name in wanted if name not in done]
    expected, found = content(reference), content(root)
    if found != expected:
        different = [name for name in expected if found.get(name) != expected[name]]
        sys.exit(f"{root} differs from the reference in {different}")
    with sole_user(root):
        left = list(root.rglob(".*.tmp"))
    if left:
        sys.exit(f"{left} were left")
    by_moment = {moment: sum(name.startswith(f"{moment}@") for name in done) for moment in MOMENTS}
    print(f"{executor}: {len(done)} kills ({calls - 1} of whole runs, in {calls} calls and "
          f"{time.monotonic() - began:.0f} s), {len(expected)} files identical; "
          f"{', '.join(f'{count} {moment}' for moment, count in by_moment.items())}; "
          f"not come to: {missed or 'none'}", flush=True)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=57)
    parser.add_argument("--networks", type=int, default=2)
    parser.add_argument("--ray", action="store_true", help="on Ray with two workers")
    parser.add_argument("--reference", type=Path, help="run to compare with; made if not given")
    parser.add_argument("--out", type=Path, default=Path("out/aimed"))
    parser.add_argument("--work", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--executor", default="processes", help=argparse.SUPPRESS)
    parser.add_argument("--address", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.work is not None:
        work(chosen.work, chosen.networks, chosen.executor, chosen.address)
        return
    shutil.rmtree(chosen.out, ignore_errors=True)
    chosen.out.mkdir(parents=True)
    began = time.monotonic()
    reference = chosen.reference or chosen.out / "reference"
    subprocess.run(command(reference, chosen.networks, "in-process"), check=True)  # noqa: S603
    print(f"undisturbed, in one process: {time.monotonic() - began:.0f} s", flush=True)
    soak(chosen.out, reference, chosen.networks, chosen.kills, "ray" if chosen.ray else "processes")


if __name__ == "__main__":
    multiprocessing.freeze_support()
    main()
