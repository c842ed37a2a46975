"""Learning curves of this package and of stock Stable-Baselines3, to see that they are the same.

    python benchmarks/learning_curves.py [--help]

Trains both with the same hyper-parameters on the whole range of an obstacle, a few seeds each, one
single-threaded process per run, and prints success and reward of the episodes that ended in each
window of steps: mean over seeds with its standard error, and the difference in units of its
standard error. Seeds draw different numbers in the two, so the curves agree within the noise of
seeds, not line by line: most differences stay within ± 2.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from multiprocessing import get_context

import numpy as np
import torch

from stock_ppo import EpisodeLog, stock_learner
from surmount.learn.config import LearnerConfig
from surmount.learn.trainer import Trainer
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import SilentMonitor

NAMES = ("Surmount", "stock SB3")


def episodes(name, obstacle, rollout_steps, steps, seed):
    """Train once and return steps, rewards and successes of the episodes, ``(3, episode)``."""
    torch.set_num_threads(1)
    config = LearnerConfig(rollout_steps=rollout_steps, batch_size=min(rollout_steps, 1024))
    if name == NAMES[0]:
        env = ObstacleVectorEnv(obstacle, config.num_envs)
        teacher = UniformTeacher(env.task_distribution, steps)
        ended = Trainer(env, teacher, config, seed=seed).run(SilentMonitor()).history.episodes
        return np.array([ended.step, ended.reward, ended.success], dtype=float)
    log = EpisodeLog()
    stock_learner(obstacle, config, seed).learn(steps, callback=log)
    return np.array(log.rows, dtype=float).reshape(-1, 3).T


def windows(rows, edges):
    """Return mean reward and success per window, ``(2, window)``, NaN where no episode ended."""
    step, *values = rows
    chosen = [(step > low) & (step <= high) for low, high in pairwise(edges)]
    return np.array([[v[c].mean() if c.any() else np.nan for c in chosen] for v in values])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--obstacle", default="low-entrance", help="default: %(default)s")
    parser.add_argument("--seeds", type=int, default=3, help="runs of each (default: %(default)s)")
    parser.add_argument("--steps", type=int, default=110_592, help="default: %(default)s")
    parser.add_argument("--windows", type=int, default=6, help="rows (default: %(default)s)")
    parser.add_argument(
        "--rollout-steps", type=int, default=1024, help="per environment (default: %(default)s)"
    )
    parser.add_argument("--processes", type=int, default=2, help="at once (default: %(default)s)")
    args = parser.parse_args()
    jobs = [(name, seed) for seed in range(args.seeds) for name in NAMES]
    with ProcessPoolExecutor(args.processes, mp_context=get_context("spawn")) as pool:
        futures = [
            pool.submit(episodes, name, args.obstacle, args.rollout_steps, args.steps, seed)
            for name, seed in jobs
        ]
        results = [future.result() for future in futures]
    edges = np.linspace(0, args.steps, args.windows + 1)
    curves = np.array([windows(rows, edges) for rows in results])
    curves = curves.reshape(args.seeds, len(NAMES), 2, args.windows)
    means = curves.mean(axis=0)
    errors = curves.std(axis=0, ddof=1) / np.sqrt(args.seeds) if args.seeds > 1 else 0 * means
    print(f"{args.obstacle}, {args.seeds} seeds; mean ± standard error over seeds, and difference")
    for index, quantity in ((1, "success"), (0, "reward of an episode")):
        print(f"\n| steps to | {quantity}, {NAMES[0]} | {NAMES[1]} | difference / its error |")
        print("|---|---|---|---|")
        for window in range(args.windows):
            (a, b), (ea, eb) = means[:, index, window], errors[:, index, window]
            error = np.hypot(ea, eb)
            ratio = f"{(a - b) / error:+.1f}" if error > 0 else "–"
            cells = f"{a:.3f} ± {ea:.3f} | {b:.3f} ± {eb:.3f}"
            print(f"| {edges[window + 1]:,.0f} | {cells} | {ratio} |")


if __name__ == "__main__":
    main()
