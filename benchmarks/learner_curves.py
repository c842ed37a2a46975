"""Learning curves of this package's learner and of the one like the paper's, on one simple task.

    python benchmarks/learner_curves.py docs/results/learner [--help]

A point mass is driven to a goal by changing its force a little at every step of 10 ms, as RSTAR
is by rate commands; only reaching the goal pays. Both learners, each with credit per step
(γ 0.99, λ 0.95) and in seconds, several seeds, one single-threaded process per run. Writes
`curves.csv`, one row per run and window of learning steps, and `curves.png`, success of the
episodes that ended in each window: mean over seeds with its standard error.
"""

from __future__ import annotations

import argparse
import csv
import os
import platform
import time
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path

import gymnasium
import numpy as np
import torch
from matplotlib.figure import Figure

from surmount.learn.presets import LEARNERS, learner_preset
from surmount.learn.trainer import Trainer
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import SilentMonitor

DECISION_S = 0.01
EPISODE_DECISIONS = 400
FORCE_STEP = 0.04
"""Largest change of the force per step; the force is within ± 1."""
GAIN_MPS2, DRAG_PER_S = 2.0, 0.5
TOLERANCE_M = 0.05
GOALS_M = (0.5, 3.0)
CREDITS = {
    "per step": {},
    "in seconds": {"discount_time_s": 5.0, "gae_time_s": 0.5},
}
COLOURS = {"surmount": "#0072B2", "ml-agents": "#D55E00"}
DASHES = {"per step": "--", "in seconds": "-"}
COLUMNS = ("learner", "credit", "seed", "steps_to", "episodes", "success", "reward")


class PointMass:
    """Point masses with goals at random distances; satisfies ``surmount.learn.TaskVectorEnv``."""

    task_parameters: tuple[str, ...] = ("goal_m",)
    feature_names: tuple[str, ...] = ("time_s", "position_m")
    step_s: float = DECISION_S
    render_mode: str | None = None
    single_observation_space = gymnasium.spaces.Box(-10, 10, (4,), np.float32)
    single_action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)

    def __init__(self, num_envs: int) -> None:
        self.num_envs = num_envs
        self.whole_range = TaskDistribution.uniform(
            self.task_parameters, np.array([GOALS_M[0]]), np.array([GOALS_M[1]])
        )
        self._distribution = self.whole_range
        self._rng = np.random.default_rng()
        # Position, speed and force, goal, steps taken.
        self._x, self._v, self._u, self._goal, self._age = np.zeros((5, num_envs))

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        self._distribution = distribution

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        self._begin(np.ones(self.num_envs, dtype=bool))
        return self._observe(), self._infos(np.zeros(self.num_envs, dtype=bool))

    def step(self, actions):
        self._u = np.clip(self._u + FORCE_STEP * np.clip(actions[:, 0], -1, 1), -1, 1)
        self._v += DECISION_S * (GAIN_MPS2 * self._u - DRAG_PER_S * self._v)
        self._x += DECISION_S * self._v
        self._age += 1
        reached = np.abs(self._goal - self._x) < TOLERANCE_M
        cut = ~reached & (self._age >= EPISODE_DECISIONS)
        rewards = np.where(reached, 5.0, 0.0) - 1.0 / EPISODE_DECISIONS
        infos, done = self._infos(reached), reached | cut
        if done.any():
            infos |= {"final_info": infos.copy(), "final_obs": self._observe()}
            self._begin(done)
        return self._observe(), rewards, reached, cut, infos

    def state_dict(self):
        raise NotImplementedError("runs of this benchmark are short and begun anew")

    def load_state_dict(self, state: Mapping[str, object]) -> None:
        raise NotImplementedError("runs of this benchmark are short and begun anew")

    def close(self) -> None:
        pass

    def _begin(self, which) -> None:
        for values in (self._x, self._v, self._u, self._age):
            values[which] = 0.0
        self._goal[which] = self._distribution.sample(self._rng, int(which.sum()))[:, 0]

    def _observe(self):
        ahead = self._goal - self._x
        return np.stack([ahead, self._v, self._u, self._goal], axis=1).astype(np.float32)

    def _infos(self, reached):
        return {
            "variant": self._goal[:, None].copy(),
            "is_success": reached.copy(),
            "diverged": np.zeros(self.num_envs, dtype=bool),
            "features": np.stack([DECISION_S * self._age, self._x], axis=1),
        }


def train(learner, credit, seed, steps):
    """Train once and return steps, successes and rewards of the episodes, ``(3, episode)``."""
    torch.set_num_threads(1)
    config = learner_preset(learner, hidden_layers=(64, 64), **CREDITS[credit])
    env = PointMass(config.num_envs)
    teacher = UniformTeacher(env.whole_range, steps)
    ended = Trainer(env, teacher, config, seed=seed).run(SilentMonitor()).history.episodes
    return np.array([ended.step, ended.success, ended.reward], dtype=float)


def windows(run, episodes, edges):
    """Return the rows of one run, one per window."""
    step, success, reward = episodes
    rows = []
    for low, high in pairwise(edges):
        chosen = (step > low) & (step <= high)
        means = [values[chosen].mean() if chosen.any() else np.nan for values in (success, reward)]
        rows.append((*run, int(high), int(chosen.sum()), *(f"{mean:.4f}" for mean in means)))
    return rows


def draw(rows, path):
    """Draw mean success over seeds, with its standard error."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.subplots()
    for learner in LEARNERS:
        for credit in CREDITS:
            mine = [row for row in rows if row[:2] == (learner, credit)]
            steps = sorted({row[3] for row in mine})
            curves = np.array([[float(row[5]) for row in mine if row[3] == step] for step in steps])
            mean = np.nanmean(curves, axis=1)
            error = np.nanstd(curves, axis=1, ddof=1) / np.sqrt(curves.shape[1])
            thousands = np.array(steps) / 1000
            axes.plot(
                thousands,
                mean,
                color=COLOURS[learner],
                linestyle=DASHES[credit],
                label=f"{learner}, credit {credit}",
            )
            axes.fill_between(
                thousands,
                mean - error,
                mean + error,
                color=COLOURS[learner],
                alpha=0.15,
                linewidth=0,
            )
    axes.set_xlabel("learning steps in thousands")
    axes.set_ylabel("success of episodes")
    axes.set_ylim(0, 1)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    figure.savefig(path, dpi=150)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path, help="folder to write to")
    parser.add_argument("--seeds", type=int, default=5, help="runs of each (default: %(default)s)")
    parser.add_argument("--steps", type=int, default=184_320, help="default: %(default)s")
    parser.add_argument("--windows", type=int, default=10, help="per curve (default: %(default)s)")
    parser.add_argument("--processes", type=int, default=2, help="at once (default: %(default)s)")
    args = parser.parse_args()
    runs = [
        (learner, credit, seed)
        for seed in range(args.seeds)
        for learner in LEARNERS
        for credit in CREDITS
    ]
    begun = time.perf_counter()
    with ProcessPoolExecutor(args.processes, mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(train, *run, args.steps) for run in runs]
        results = [future.result() for future in futures]
    edges = np.linspace(0, args.steps, args.windows + 1)
    rows = [
        row for run, found in zip(runs, results, strict=True) for row in windows(run, found, edges)
    ]
    args.out.mkdir(parents=True, exist_ok=True)
    with (args.out / "curves.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(rows)
    draw(rows, args.out / "curves.png")
    print(f"{len(runs)} runs of {args.steps:,} steps in {time.perf_counter() - begun:.0f} s,")
    print(f"{args.processes} at once; {platform.machine()}, {os.cpu_count()} cores,")
    print(f"Python {platform.python_version()}, PyTorch {torch.__version__}")
    last = edges[-2]
    for learner in LEARNERS:
        for credit in CREDITS:
            shares = [float(r[5]) for r in rows if r[:2] == (learner, credit) and r[3] > last]
            listed = ", ".join(f"{share:.2f}" for share in sorted(shares))
            print(f"{learner}, credit {credit}: last window {np.mean(shares):.3f} ({listed})")


if __name__ == "__main__":
    main()
