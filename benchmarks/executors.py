"""What executors cost, what a second process brings, and how far a cluster would.

    OMP_NUM_THREADS=1 python benchmarks/executors.py --out docs/results/executors

Three measurements on this machine and one simulation:

* overhead: time of a chain of stages that do nothing but write a number, per stage, in this
  process, in a local worker and on a Ray started here, each after a first stage has warmed it up;
* efficiency: four stages that each take a fixed amount of processor time, in one worker and in two;
  beside it, what the machine gives two processes without any of our code (the peer);
* processor time of training, per learning step, at the paper's scale, for each obstacle, and of one
  network's trials;
* makespan, simulated: 3 obstacles, 10 networks, 8 teachers, from the graph that `surmount compare`
  runs and the times just measured, on 1 to 256 workers; a free worker takes the stage that became
  ready first, as the runner does. How many levels a network learns is not known beforehand: two
  levels of one iteration and one extension are assumed, and nothing else.
"""

from __future__ import annotations

import argparse
import heapq
import json
import multiprocessing
import tempfile
import time
from pathlib import Path

import torch
from matplotlib.figure import Figure

from surmount.core.configuration import override
from surmount.core.records import write_record
from surmount.experiment.presets import preset
from surmount.experiment.teaching import comparison_graph
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import Actor, roll_out
from surmount.learn.trainer import Trainer
from surmount.teachers.catalogue import TEACHERS, TeachersConfig
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.executors import make_executor
from surmount.workflow.graph import Stage, StageKind, check_graph, dependencies
from surmount.workflow.monitor import SilentMonitor
from surmount.workflow.runner import GraphRunner

OBSTACLES = ("narrow-channel", "low-entrance", "step")
NETWORKS = 10
TEACHERS_COMPARED = tuple(TEACHERS)[:8]
LEVELS = 2
CHAIN = 20
WORK_S = 4.0
WORKERS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
PAYS = 0.5
"""Doubling the workers pays while each of them is busy at least this share of the time."""


class Nobody:  # noqa: D101 - as `RunObserver` describes it
    def stage_outdated(self, stage: str, folders) -> None:
        pass

    def stage_reused(self, artefact) -> None:
        pass

    def stage_started(self, stage: str) -> None:
        pass

    def stage_finished(self, artefact, seconds: float) -> None:
        pass

    def stage_lost(self, stage: str, *, again: bool) -> None:
        pass


def write(context) -> None:
    write_record(context.output / "n.json", {"n": context.seed})


def burn(context) -> None:
    spend(WORK_S)
    write_record(context.output / "n.json", {"n": context.seed})


WRITE = StageKind(name="write", function=write)
BURN = StageKind(name="burn", function=burn)


def spend(seconds: float) -> None:
    """Use so much processor time."""
    until = time.process_time() + seconds
    matrix = torch.ones(64, 64)
    while time.process_time() < until:
        matrix = matrix @ matrix / 64


def chain(seed: int, length: int) -> list[Stage]:
    return [
        Stage(name=f"link-{i}", kind=WRITE, seed=seed,
              inputs={"before": (f"link-{i - 1}",)} if i else {})
        for i in range(length)
    ]  # fmt: skip


def timed(executor, stages) -> float:
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / ".lock").touch()
        began = time.monotonic()
        GraphRunner(root, stages, executor, Nobody()).run()
        return time.monotonic() - began


def overhead(kind: str, processes: int) -> float | None:
    """Return seconds per stage that does nothing, ``None`` where Ray is not installed."""
    try:
        executor = make_executor(processes, lambda _: None, kind=kind)
    except ModuleNotFoundError:
        return None
    try:
        timed(executor, chain(0, 1))
        return timed(executor, chain(1, CHAIN)) / CHAIN
    finally:
        executor.close()


def efficiency() -> dict[str, float]:
    """Return the seconds of four stages in one worker and in two, and of the machine alone."""
    seconds: dict[str, float] = {}
    for processes in (1, 2):
        executor = make_executor(processes, lambda _: None)
        try:
            warm = [Stage(name=f"warm-{i}", kind=WRITE) for i in range(processes)]
            timed(executor, warm)
            stages = [Stage(name=f"burn-{i}", kind=BURN, seed=i) for i in range(4)]
            seconds[f"stages in {processes}"] = timed(executor, stages)
        finally:
            executor.close()
        began = time.monotonic()
        for _ in range(4 // processes):
            children = [multiprocessing.Process(target=spend, args=(WORK_S,))
                        for _ in range(processes)]  # fmt: skip
            for child in children:
                child.start()
            for child in children:
                child.join()
        seconds[f"bare processes, {processes}"] = time.monotonic() - began
    return seconds


def stage_seconds(obstacle: str) -> dict[str, float]:
    """Return processor time: of a learning step, and of one network's trials."""
    config = preset(obstacle, "paper")
    family, space = config.family, config.family.space(config.env)
    env = family.training_env(config.env, config.learner.num_envs)
    steps = 2 * config.learner.steps_per_rollout
    trainer = Trainer(env, UniformTeacher(space.whole_range, steps), config.learner, seed=0)
    began = time.process_time()
    network = trainer.run(SilentMonitor()).network
    per_step = (time.process_time() - began) / steps
    env.close()
    few = RolloutConfig(repetitions=2)
    trials = family.trial_env(config.env, len(space.variants) * few.repetitions)
    actor = Actor(network, trials.single_observation_space, trials.single_action_space)
    began = time.process_time()
    roll_out(trials, actor, space.variants, few, network=0, seed=0, monitor=SilentMonitor())
    whole = (time.process_time() - began) * config.trials.repetitions / few.repetitions
    trials.close()
    return {"learning step": per_step, "trials": whole}


def durations(obstacle: str, measured: dict[str, float]) -> tuple[dict[str, Stage], dict]:
    config = override(preset(obstacle, "paper"), {"networks": NETWORKS})
    graph = check_graph(comparison_graph(config, TEACHERS_COMPARED, TeachersConfig()))
    advancement = config.advancement
    arm = LEVELS * (advancement.iteration_steps + advancement.extension_steps)
    seconds = {}
    for name in graph:
        kind = name.partition("/")[0]
        if kind == "initiation":
            seconds[name] = config.initial_steps * measured["learning step"]
        elif kind in {"curriculum", "control", "teach"}:
            seconds[name] = arm * measured["learning step"]
        elif kind == "trials" or kind.startswith("test-"):
            seconds[name] = measured["trials"]
        else:
            seconds[name] = measured["analysis"]
    return graph, seconds


def makespan(graphs: list[tuple[dict[str, Stage], dict[str, float]]], workers: int) -> float:
    """Simulate the runner: a free worker takes the stage that has been ready longest."""
    waiting = [(index, name) for index, (graph, _) in enumerate(graphs) for name in graph]
    done: set[tuple[int, str]] = set()
    running: list[tuple[float, tuple[int, str]]] = []
    now = 0.0
    while waiting or running:
        for stage in list(waiting):
            if len(running) == workers:
                break
            index, name = stage
            graph, seconds = graphs[index]
            if all((index, needed) in done for needed in dependencies(graph[name])):
                waiting.remove(stage)
                heapq.heappush(running, (now + seconds[name], stage))
        now, finished = heapq.heappop(running)
        done.add(finished)
    return now


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/executors"))
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    kinds = {"in this process": ("in-process", 0), "local worker": ("processes", 1),
             "Ray on this machine": ("ray", 1)}  # fmt: skip
    costs = {name: overhead(*options) for name, options in kinds.items()}
    for name, cost in costs.items():
        print(f"overhead per stage, {name}: {'not installed' if cost is None else f'{cost:.4f} s'}")
    two = efficiency()
    ours = two["stages in 1"] / two["stages in 2"] / 2
    peer = two["bare processes, 1"] / two["bare processes, 2"] / 2
    print(f"efficiency at 2 processes: stages {ours:.2f}, the machine alone {peer:.2f}")
    measured = {obstacle: stage_seconds(obstacle) | {"analysis": 60.0} for obstacle in OBSTACLES}
    for obstacle, found in measured.items():
        print(f"{obstacle}: {1e3 * found['learning step']:.3f} ms of processor per learning step, "
              f"{found['trials']:.0f} s for one network's trials")  # fmt: skip
    graphs = [durations(obstacle, measured[obstacle]) for obstacle in OBSTACLES]
    work = sum(sum(seconds.values()) for _, seconds in graphs)
    stages = sum(len(graph) for graph, _ in graphs)
    rows = []
    for workers in WORKERS:
        span = makespan(graphs, workers)
        rows.append({"workers": workers, "hours": span / 3600, "speedup": work / span,
                     "efficiency": work / span / workers})  # fmt: skip
        print(f"{workers:4d} workers: {span / 3600:8.1f} h, speed-up {work / span:6.1f}, "
              f"efficiency {work / span / workers:.2f}")  # fmt: skip
    last = max(row["workers"] for row in rows if row["efficiency"] >= PAYS)
    print(f"{stages} stages, {work / 3600:.0f} h of processor; pays up to {last} workers")
    chosen.out.mkdir(parents=True, exist_ok=True)
    record = {"overhead_s": costs, "two_processes_s": two, "measured_s": measured,
              "stages": stages, "work_h": work / 3600, "makespan": rows}  # fmt: skip
    (chosen.out / "executors.json").write_text(json.dumps(record, indent=1) + "\n")
    draw(rows, chosen.out / "makespan.png")


def draw(rows, path: Path) -> None:
    figure = Figure(figsize=(7.2, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    workers = [row["workers"] for row in rows]
    left.loglog(workers, [row["hours"] for row in rows], "o-", base=2)
    left.set_yscale("log", base=10)
    left.set(xlabel="workers", ylabel="makespan (h)")
    right.semilogx(workers, [row["efficiency"] for row in rows], "o-", base=2)
    right.axhline(PAYS, color="grey", linewidth=0.8, linestyle="--")
    right.set(xlabel="workers", ylabel="share of time at work", ylim=(0, 1.05))
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main()
