"""What the method costs beside a plain Stable-Baselines3 script of the same learning steps.

``python benchmarks/overhead_beside_sb3.py [pairs] [steps]`` trains stock PPO on an environment of
somebody else's twice, in turn: as the initiation of ``surmount reproduce`` (tasks, features, the
contract, every episode logged, checkpoint, network, history and journal written), and by
``PPO(...).learn(steps)`` in a plain script on the same environment without Surmount. Printed is the
ratio of processor times, geometric mean over pairs with its 95 % t-interval, and that of wall
times, which on a busy machine says little.
"""

from __future__ import annotations

import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import gymnasium
import numpy as np
import torch
from scipy import stats
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env

from surmount.core.configuration import override
from surmount.experiment.presets import preset
from surmount.experiment.protocol import protocol
from surmount.experiment.running import begin
from surmount.workflow.executors import make_executor
from surmount.workflow.journal import Journal
from surmount.workflow.runner import GraphRunner

EXAMPLES = Path(__file__).parent.parent / "examples"
ENVS = 4
STOCK = {"n_steps": 512, "batch_size": 64, "device": "cpu"}
"""Stable-Baselines3's defaults, its 2,048 steps of a roll-out divided among the environments."""


@dataclass(frozen=True)
class Case:
    """An environment, with Surmount and without."""

    task: str
    plain: str
    limit: int


CASES = (
    Case("pole_lengths:make_env", "CartPole-v1", 200),
    Case("uphill_cheetah:make_env", "HalfCheetah-v5", 200),
)


class Silent:
    """Watches a run and says nothing."""

    def stage_outdated(self, stage, folders): ...
    def stage_reused(self, artefact): ...
    def stage_started(self, stage): ...
    def stage_finished(self, artefact, seconds): ...
    def stage_lost(self, stage, *, again): ...
    def listen(self, event): ...


def ours(case: Case, steps: int, seed: int) -> None:
    """Run the initiation of one network in a folder of its own."""
    config = override(
        preset(case.task, "smoke"),
        {
            "networks": 1,
            "seed": seed,
            "initial_steps": steps,
            "learner.algorithm": "PPO",
            "learner.num_envs": ENVS,
            "learner.arguments": STOCK,
        },
    )
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        begin(root, config)
        silent = Silent()
        executor = make_executor(0, silent.listen)
        GraphRunner(root, protocol(config)[:1], executor, Journal(root, silent)).run()


def plain(case: Case, steps: int, seed: int) -> None:
    """Learn as a plain script does."""

    def make():
        return gymnasium.make(case.plain, max_episode_steps=case.limit)

    PPO("MlpPolicy", make_vec_env(make, ENVS, seed=seed), seed=seed, **STOCK).learn(steps)


def seconds(work, *arguments) -> np.ndarray:
    """Return the processor and the wall time that something takes, in s."""
    before = time.process_time(), time.perf_counter()
    work(*arguments)
    return np.array([time.process_time(), time.perf_counter()]) - before


def ratio(pairs: np.ndarray) -> str:
    """Return the geometric mean of ratios, shape ``(pair,)``, with its 95 % interval."""
    logs = np.log(pairs)
    half = stats.t.ppf(0.975, len(logs) - 1) * stats.sem(logs)
    mean, lower, upper = np.exp([logs.mean(), logs.mean() - half, logs.mean() + half])
    return f"{mean:.3f} ({lower:.3f} to {upper:.3f})"


def main(pairs: int = 8, steps: int = 8_192) -> None:
    """Print the ratios."""
    torch.set_num_threads(1)
    sys.path[:0] = [str(EXAMPLES), str(EXAMPLES / "others")]
    for case in CASES:
        ours(case, 2_048, 0)  # imports and caches
        plain(case, 2_048, 0)
        taken = np.empty((pairs, 2, 2))
        for pair in range(pairs):
            for which in (0, 1) if pair % 2 else (1, 0):
                taken[pair, which] = seconds((ours, plain)[which], case, steps, pair)
        cpu, wall = (taken[:, 0] / taken[:, 1]).T
        with_it, without = taken[:, :, 0].mean(axis=0)
        print(
            f"{case.plain}: {steps:,} steps take {with_it:.1f} s of processor time with Surmount "
            f"and {without:.1f} s without; ratio {ratio(cpu)} over {pairs} pairs; wall "
            f"{ratio(wall)}",
            flush=True,
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
