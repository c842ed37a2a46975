"""What the method costs beside a plain Stable-Baselines3 script of the same learning steps.

``python benchmarks/overhead_beside_sb3.py [rollouts]`` trains stock PPO on environments of
somebody else's twice at once, in turn: as the initiation of ``surmount reproduce`` (tasks,
features, every episode logged, checkpoint, network, history and journal written), and by
``PPO(...).learn(...)`` in a plain script on the same environment without Surmount. Each roll-out of
the one is followed by one of the other, so that both meet the same load of the machine. Printed is
the ratio of processor times summed over roll-outs with its 95 % bootstrap interval over pairs of
roll-outs; that of wall times, which on a busy machine says little; and the seconds before the first
and after the last roll-out, once for a training.
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
ROLLOUT = 2_048
STOCK = {"n_steps": ROLLOUT // ENVS, "batch_size": 64, "device": "cpu"}
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


class InTurn:
    """Watches an initiation, and lets the plain script learn a roll-out after each of its own.

    Attributes
    ----------
    ours, plain
        Processor and wall seconds of each roll-out; of ours also of what comes after the last.
    """

    def __init__(self, model: PPO) -> None:
        self._model = model
        self.ours, self.plain = [], []
        self._since = now()

    def listen(self, event):
        """Take the time of a roll-out, and let the other follow."""
        if isinstance(event.told, str):
            return
        self.ours.append(now() - self._since)
        before = now()
        self._model.learn(ROLLOUT, reset_num_timesteps=False)
        self.plain.append(now() - before)
        self._since = now()

    def end(self):
        """Take the time of what came after the last roll-out."""
        self.ours.append(now() - self._since)

    def stage_outdated(self, stage, folders): ...
    def stage_reused(self, artefact): ...
    def stage_started(self, stage): ...
    def stage_finished(self, artefact, seconds): ...
    def stage_lost(self, stage, *, again): ...


def now() -> np.ndarray:
    """Return processor and wall time in s."""
    return np.array([time.process_time(), time.perf_counter()])


def measure(case: Case, rollouts: int) -> InTurn:
    """Run the initiation of one network in a folder of its own, and a plain script beside it."""
    config = override(
        preset(case.task, "smoke"),
        {
            "networks": 1,
            "initial_steps": rollouts * ROLLOUT,
            "learner.algorithm": "PPO",
            "learner.num_envs": ENVS,
            "learner.arguments": STOCK,
        },
    )

    def make():
        return gymnasium.make(case.plain, max_episode_steps=case.limit)

    model = PPO("MlpPolicy", make_vec_env(make, ENVS, seed=0), seed=0, **STOCK)
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        begin(root, config)
        watch = InTurn(model)
        executor = make_executor(0, watch.listen)
        GraphRunner(root, protocol(config)[:1], executor, Journal(root, watch)).run()
        watch.end()
    return watch


def ratio(ours: np.ndarray, plain: np.ndarray) -> str:
    """Return the ratio of sums over roll-outs, ``(rollout,)``, with its 95 % interval."""
    drawn = np.random.default_rng(0).integers(len(ours), size=(10_000, len(ours)))
    several = ours[drawn].sum(axis=1) / plain[drawn].sum(axis=1)
    lower, upper = np.quantile(several, [0.025, 0.975])
    return f"{ours.sum() / plain.sum():.3f} ({lower:.3f} to {upper:.3f})"


def main(rollouts: int = 24) -> None:
    """Print the ratios."""
    torch.set_num_threads(1)
    sys.path[:0] = [str(EXAMPLES), str(EXAMPLES / "others")]
    for case in CASES:
        measure(case, 1)  # imports and caches
        watch = measure(case, rollouts + 1)
        ours, plain = np.array(watch.ours[1:-1]), np.array(watch.plain[1:])
        once = watch.ours[0][0] - ours[:, 0].mean() + watch.ours[-1][0]
        print(
            f"{case.plain}: {rollouts * ROLLOUT:,} steps, processor time {ours[:, 0].sum():.1f} s "
            f"with Surmount, {plain[:, 0].sum():.1f} s without; ratio "
            f"{ratio(ours[:, 0], plain[:, 0])} over {rollouts} roll-outs, of wall time "
            f"{ratio(ours[:, 1], plain[:, 1])}; {once:.2f} s of processor time once",
            flush=True,
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
