"""Speed of whole PPO training, environment included, against stock Stable-Baselines3.

    python benchmarks/training_speed.py [--help]

Prints Markdown: learning steps per second of ``surmount.learn.Trainer`` on the batched environment
and of Stable-Baselines3's PPO on single environments, same obstacle, network, batch and epochs,
roll-outs taken in turns in one process (A B A B), medians and their ratio; where the time goes in
both; and two single-threaded runs side by side against one, beside what the machine gives two
processes of physics and of matrix products alone. Takes about six minutes on two idle cores. On a
busy machine read the ratios, best those of CPU time at one thread.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo says nothing about what its compiled module holds.

from __future__ import annotations

import argparse
import copy
import multiprocessing
import os
import platform
import time
from importlib.metadata import version
from statistics import median

import mujoco
import numpy as np
import torch
from mujoco.batch import Batch
from stable_baselines3 import PPO
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import VecNormalize

from stock_ppo import stock_learner
from surmount.learn.config import LearnerConfig
from surmount.learn.ppo import ResumablePPO
from surmount.learn.rollout_collector import RolloutCollector
from surmount.learn.trainer import Trainer
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.single import ObstacleEnv
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import Interrupted, SilentMonitor

CONFIG = LearnerConfig()
STEPS = CONFIG.steps_per_rollout
NAMES = ("Surmount", "stock SB3")
PARTS = (
    ("physics", [(Batch, "step")]),
    ("rest of the environment", [(ObstacleVectorEnv, "step"), (ObstacleEnv, "step")]),
    ("vector wrappers, statistics, records", [(VecNormalize, "step_wait")]),
    (
        "inference and sampling",
        [
            (RolloutCollector, "act"),
            (RolloutCollector, "finish"),
            (ActorCriticPolicy, "forward"),
            (ActorCriticPolicy, "predict_values"),
        ],
    ),
    ("update of the networks", [(ResumablePPO, "train"), (PPO, "train")]),
    ("collecting loop and buffer", [(ResumablePPO, "collect_rollouts"), (PPO, "collect_rollouts")]),
)
"""Parts of a training step, each the calls that belong to it less the calls within of others."""


class OneRollout(SilentMonitor):
    """Asks to stop after every roll-out; calling ``run`` again goes on."""

    def __init__(self):
        self.done = False

    def progress(self, progress):
        """Notice the end of a roll-out."""
        del progress
        self.done = True

    def should_stop(self):
        """Ask to stop once after each roll-out."""
        stop, self.done = self.done, False
        return stop


def our_rollout(obstacle, n_threads, seed=0):
    """Return a function that trains on one more roll-out with this package."""
    env = ObstacleVectorEnv(obstacle, CONFIG.num_envs, n_threads=n_threads)
    teacher = UniformTeacher(env.task_distribution, 10**12)
    trainer, monitor = Trainer(env, teacher, CONFIG, seed=seed), OneRollout()

    def learn():
        try:
            trainer.run(monitor)
        except Interrupted:
            return

    return learn


def stock_rollout(obstacle, seed=0):
    """Return a function that trains on one more roll-out with stock Stable-Baselines3."""
    learner = stock_learner(obstacle, CONFIG, seed)
    return lambda: learner.learn(STEPS, reset_num_timesteps=False)


def seconds(call):
    """Return wall and CPU seconds of a call."""
    wall, cpu = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - wall, time.process_time() - cpu


class Stopwatch:
    """Adds up CPU time of wrapped methods, each without the wrapped methods it calls."""

    def __init__(self):
        self.seconds = dict.fromkeys([name for name, _ in PARTS] + ["other"], 0.0)
        self._under_way = ["other"]
        self._since = time.process_time()
        self._originals = []

    def __enter__(self):
        for part, methods in PARTS:
            for owner, name in methods:
                original = getattr(owner, name)
                self._originals.append((owner, name, original, name in vars(owner)))
                setattr(owner, name, self._timed(original, part))
        self._since = time.process_time()
        return self

    def __exit__(self, *error):
        self._account()
        for owner, name, original, own in reversed(self._originals):
            setattr(owner, name, original) if own else delattr(owner, name)

    def _account(self):
        now = time.process_time()
        self.seconds[self._under_way[-1]] += now - self._since
        self._since = now

    def _timed(self, original, part):
        def method(*args, **kwargs):
            self._account()
            self._under_way.append(part)
            try:
                return original(*args, **kwargs)
            finally:
                self._account()
                self._under_way.pop()

        return method


def compare(args):
    """Print the ratio for every number of threads, and where the time goes at the first."""
    print("| threads | | steps/s, median (range) | ratio of wall time | ratio of CPU time |")
    print("|---|---|---|---|---|")
    for n_threads in args.threads:
        torch.set_num_threads(n_threads)
        calls = (our_rollout(args.obstacle, n_threads), stock_rollout(args.obstacle))
        for call in calls:
            call()
        times = [[seconds(call) for call in calls] for _ in range(args.repetitions)]
        ours, theirs = zip(*times, strict=True)
        wall, cpu = (
            [median(t[kind] for t in group) for group in (ours, theirs)] for kind in (0, 1)
        )
        for name, group in zip(NAMES, (ours, theirs), strict=True):
            rates = sorted(STEPS / t for t, _ in group)
            last = (
                f"{wall[1] / wall[0]:.2f} | {cpu[1] / cpu[0]:.2f}" if name == NAMES[0] else "1 | 1"
            )
            print(
                f"| {n_threads} | {name} | {median(rates):,.0f} "
                f"({rates[0]:,.0f} to {rates[-1]:,.0f}) | {last} |",
                flush=True,
            )
        if n_threads == args.threads[0]:
            shares = [breakdown(call, args.breakdown_rollouts) for call in calls]
    print(
        f"\nµs per learning step, {args.threads[0]} thread(s), {args.breakdown_rollouts} roll-outs"
    )
    print(f"\n| part | {NAMES[0]} | share | {NAMES[1]} | share |\n|---|---|---|---|---|")
    totals = [sum(share.values()) for share in shares]
    for part in shares[0]:
        cells = (f"{s[part]:.1f} | {s[part] / t:.0%}" for s, t in zip(shares, totals, strict=True))
        print(f"| {part} | {' | '.join(cells)} |")
    print(f"| all | {totals[0]:.1f} | | {totals[1]:.1f} | |", flush=True)


def breakdown(call, rollouts):
    """Return µs per learning step of each part."""
    with Stopwatch() as watch:
        for _ in range(rollouts):
            call()
    return {part: 1e6 * t / (rollouts * STEPS) for part, t in watch.seconds.items()}


def physics_round(obstacle):
    """Return a function that calls ``mj_step`` alone on nine simulations, as a roll-out does."""
    env = ObstacleVectorEnv(obstacle, CONFIG.num_envs, n_threads=1)
    env.reset(seed=0)
    simulation, physics_steps = env.simulation, env.config.physics_steps_per_step
    model = simulation.model
    start = [simulation.batch.get_data(index) for index in range(CONFIG.num_envs)]
    controls = np.random.default_rng(0).uniform(-1, 1, (200, CONFIG.num_envs, model.nu))
    controls *= model.actuator_ctrlrange[:, 1]

    def step():
        datas = [copy.copy(data) for data in start]
        for row in controls:
            for data, control in zip(datas, row, strict=True):
                data.ctrl[:] = control
                mujoco.mj_step(model, data, physics_steps)

    return step, len(controls) * CONFIG.num_envs * physics_steps


def product_round():
    """Return a function that multiplies matrices alone, of the sizes of the networks' update."""
    width = CONFIG.hidden_layers[0]
    batch, weights = torch.rand(CONFIG.batch_size, width), torch.rand(width, width)

    def multiply():
        for _ in range(200):
            torch.mm(batch, weights)

    return multiply, 200


def training_round(obstacle, seed):
    """Return a function that trains on one more roll-out."""
    return our_rollout(obstacle, 1, seed), STEPS


WORK = {
    "training, learning steps": training_round,
    "`mj_step` alone, physics steps": lambda obstacle, _: physics_round(obstacle),
    "matrix products alone": lambda _, __: product_round(),
}
"""What is done by one process and by two side by side: a function and its units of work."""


def work_alone(what, obstacle, seconds, seed, barrier, results):
    """Work single-threaded in a process of its own, from a common start, as long as asked for."""
    torch.set_num_threads(1)
    call, units = WORK[what](obstacle, seed)
    call()
    barrier.wait()
    start, done = time.monotonic(), 0
    while time.monotonic() < start + seconds:
        call()
        done += units
    results.put(done / (time.monotonic() - start))


def rate_of_processes(what, count, args):
    """Return units of work per second of ``count`` processes together."""
    context = multiprocessing.get_context("spawn")
    barrier, results = context.Barrier(count), context.Queue()
    processes = [
        context.Process(
            target=work_alone,
            args=(what, args.obstacle, args.side_seconds, seed, barrier, results),
        )
        for seed in range(count)
    ]
    for process in processes:
        process.start()
    rates = [results.get() for _ in processes]
    for process in processes:
        process.join()
    return sum(rates)


def side_by_side(args):
    """Print the throughput of two single-threaded processes against that of one.

    Two runs of training cannot do better than the machine: how far two processes that share nothing
    but its processors get stands beside it, in physics and in matrix products alone.
    """
    rates = {what: [] for what in WORK}
    for _ in range(args.side_pairs):
        for what, pairs in rates.items():
            pairs.append([rate_of_processes(what, count, args) for count in (1, 2)])
    print("\n| single-threaded | one process, per second | two together | ratio (range) |")
    print("|---|---|---|---|")
    for what, pairs in rates.items():
        one, two = (median(column) for column in zip(*pairs, strict=True))
        ratios = sorted(b / a for a, b in pairs)
        print(
            f"| {what} | {one:,.0f} | {two:,.0f} | {median(ratios):.2f} "
            f"({ratios[0]:.2f} to {ratios[-1]:.2f}) |",
            flush=True,
        )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--obstacle", default="step", help="obstacle (default: %(default)s)")
    parser.add_argument(
        "--threads", type=int, nargs="+", default=[1, 2], help="thread counts (default: 1 2)"
    )
    parser.add_argument(
        "--repetitions", type=int, default=4, help="timed roll-outs of each (default: %(default)s)"
    )
    parser.add_argument(
        "--breakdown-rollouts", type=int, default=2, help="for the parts (default: %(default)s)"
    )
    parser.add_argument(
        "--side-seconds", type=float, default=8.0, help="of each process (default: %(default)s)"
    )
    parser.add_argument(
        "--side-pairs", type=int, default=3, help="of one and two; 0 for none (default: 3)"
    )
    parser.add_argument("--only-side", action="store_true", help="measure nothing else")
    args = parser.parse_args()
    packages = ("torch", "stable-baselines3", "mujoco", "numpy")
    print(", ".join(f"{name} {version(name)}" for name in packages), end="; ")
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    print(
        f"load {os.getloadavg()[0]:.1f} before the start; {args.obstacle}, {CONFIG.num_envs} ",
        end="",
    )
    print(f"environments, {CONFIG.hidden_layers}, batch {CONFIG.batch_size}, ", end="")
    print(f"{CONFIG.epochs} epochs\n", flush=True)
    if not args.only_side:
        compare(args)
    if args.side_pairs:
        side_by_side(args)


if __name__ == "__main__":
    main()
