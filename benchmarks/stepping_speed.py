"""Speed of stepping the environments, as ratios to named peers within one run.

    OMP_NUM_THREADS=1 python benchmarks/stepping_speed.py [peers|parts|scaling|memory ...]

peers    9 environments, same model, starts, actions and physics steps. Peers: a bare loop, in
         which as many Python threads each call ``mj_step(model, data, nstep)`` on their share of
         the simulations and never wait for each other; Stable-Baselines3's DummyVecEnv and
         SubprocVecEnv, Gymnasium's SyncVectorEnv and AsyncVectorEnv over single environments.
parts    Where the time of a step of the batched environment goes: MuJoCo's call, and what
         Python does around it. Percentiles of single steps: on a busy machine the lower ones
         are of those that nothing else interrupted.
scaling  Ticks a second over 1 to 256 environments, beside the bare loop on as many threads.
memory   Resident memory that a further environment takes; on Linux.

Repetitions are interleaved, so that other work on the machine meets all alike; shown are medians,
and the median of the ratios within a repetition. Every peer ends in the same state, bit by bit.
Prints Markdown.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo says nothing about what its compiled module holds.

from __future__ import annotations

import argparse
import platform
import subprocess
import sys
import threading
import time
from contextlib import ExitStack
from unittest import mock

import gymnasium
import mujoco
import numpy as np
from mujoco.batch import Batch
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv

import surmount.rstar  # noqa: F401  (registers the environments)
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.episodes import Episodes
from surmount.rstar.course.observations import Observer
from surmount.rstar.course.rewards import Reward
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.single import ObstacleEnv

OBSTACLE, GYM_ID = "step", "surmount/Step-v0"
OPTIONS = {"start": "fixed", "variant": 30.0}
WHOLE_STATE = mujoco.mjtState.mjSTATE_INTEGRATION.value


def random_actions(steps, num_envs):
    """Actions that move the robot about before the step: no episode ends.

    In a quarter of the longest episode none reaches the target, nor falls off the floor.
    """
    assert steps <= EnvConfig().steps_per_episode // 4, "Measure fewer steps."
    return np.random.default_rng(0).uniform(-1, 1, (steps, num_envs, 3)).astype(np.float32)


class Bare:
    """MuJoCo alone: as many threads as asked for, each with its share of the simulations."""

    def __init__(self, num_envs, n_threads):
        env = ObstacleVectorEnv(OBSTACLE, num_envs, n_threads=1)
        env.reset(seed=0, options=OPTIONS)
        self.model, self.ticks = env.simulation.model, env.config.physics_steps_per_step
        self.start = env.state_dict()["simulation"]
        names = [self.model.actuator(i).name.split("_")[-1] for i in range(self.model.nu)]
        self.kind = np.array([{"fbem": 1, "sprawl": 2}.get(name, 0) for name in names])
        self.full = self.model.actuator_ctrlrange[:, 1].copy()
        self.datas = [mujoco.MjData(self.model) for _ in range(num_envs)]
        self.shares = [range(first, num_envs, n_threads) for first in range(n_threads)]

    def run(self, actions):
        """Return the seconds that so many steps take."""
        controls = actions.astype(np.float64)[:, :, self.kind] * self.full
        for data, row in zip(self.datas, self.start, strict=True):
            mujoco.mj_setState(self.model, data, row, WHOLE_STATE)

        def work(share):
            step, model, datas, physics_steps = mujoco.mj_step, self.model, self.datas, self.ticks
            for controls_now in controls:
                for env in share:
                    data = datas[env]
                    data.ctrl[:] = controls_now[env]
                    step(model, data, physics_steps)

        threads = [threading.Thread(target=work, args=(share,)) for share in self.shares]
        begin = time.perf_counter()
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return time.perf_counter() - begin

    def positions(self):
        """Return where the robots are in the end."""
        return np.array([data.qpos[:3] for data in self.datas])


class Ours:
    """The batched environment."""

    def __init__(self, num_envs, n_threads):
        self.env = ObstacleVectorEnv(OBSTACLE, num_envs, n_threads=n_threads)

    def run(self, actions):
        """Return the seconds that so many steps take."""
        self.env.reset(seed=0, options=OPTIONS)
        begin = time.perf_counter()
        for action in actions:
            self.seen, _, terminated, truncated, _ = self.env.step(action)
            assert not (terminated | truncated).any()
        return time.perf_counter() - begin

    def positions(self):
        """Return where the robots are in the end."""
        return self.env.simulation.batch.bind("qpos")[:, :3]


class StableBaselines:
    """One of Stable-Baselines3's vector environments over single environments."""

    def __init__(self, kind, num_envs):
        self.env = kind([lambda: ObstacleEnv(OBSTACLE)] * num_envs)

    def run(self, actions):
        """Return the seconds that so many steps take."""
        self.env.set_options(OPTIONS)
        self.env.reset()
        begin = time.perf_counter()
        for action in actions:
            self.seen, _, _, _ = self.env.step(action)
        return time.perf_counter() - begin


class Gymnasium:
    """One of Gymnasium's vector environments over single environments."""

    def __init__(self, mode, num_envs):
        self.env = gymnasium.make_vec(GYM_ID, num_envs=num_envs, vectorization_mode=mode)

    def run(self, actions):
        """Return the seconds that so many steps take."""
        self.env.reset(seed=0, options=OPTIONS)
        begin = time.perf_counter()
        for action in actions:
            self.seen, _, _, _, _ = self.env.step(action)
        return time.perf_counter() - begin


def interleaved(runners, actions, repeats):
    """Return seconds, shape ``(repetition, runner)``, in an order that turns."""
    seconds = np.empty((repeats, len(runners)))
    for repeat in range(-1, repeats):  # the first one warms up
        for turn in range(len(runners)):
            index = (turn + repeat) % len(runners)
            taken = runners[index].run(actions)
            if repeat >= 0:
                seconds[repeat, index] = taken
    return seconds


def peers(args):
    num_envs, threads = 9, args.threads
    actions = random_actions(args.steps, num_envs)
    runners = {
        f"bare `mj_step` loop, {threads} threads": Bare(num_envs, threads),
        f"batched environment, {threads} threads": Ours(num_envs, threads),
        "batched environment, 1 thread": Ours(num_envs, 1),
        "SB3 DummyVecEnv": StableBaselines(DummyVecEnv, num_envs),
        "SB3 SubprocVecEnv": StableBaselines(SubprocVecEnv, num_envs),
        "Gymnasium SyncVectorEnv": Gymnasium("sync", num_envs),
        "Gymnasium AsyncVectorEnv": Gymnasium("async", num_envs),
    }
    listed = list(runners.values())
    seconds = interleaved(listed, actions, args.repeats)
    bare, ours, *others = listed
    np.testing.assert_array_equal(bare.positions(), ours.positions())
    for other in others:
        np.testing.assert_array_equal(other.seen, ours.seen)
    print(f"\n{num_envs} environments, {bare.ticks} physics steps a step, {args.steps} steps, ")
    print(f"{args.repeats} interleaved repetitions.\n")
    print("| | physics steps a second | steps a second | batched environment is |")
    print("|---|---|---|---|")
    steps = args.steps * num_envs / np.median(seconds, axis=0)
    ratio = np.median(seconds / seconds[:, 1:2], axis=0)
    for name, rate, times in zip(runners, steps, ratio, strict=True):
        print(f"| {name} | {rate * bare.ticks:,.0f} | {rate:,.0f} | {times:.2f} × as fast |")
    for runner in others[1:]:
        runner.env.close()


WHOLE, PHYSICS, COMMANDS = "whole step", "MuJoCo's call", "commands, divergence"
PARTS = (
    (WHOLE, ObstacleVectorEnv, "step"),
    (PHYSICS, Batch, "step"),
    (COMMANDS, Simulation, "advance"),
    ("measures", Simulation, "measure"),
    ("endings", Episodes, "go_on"),
    ("reward", Reward, "running"),
    ("infos", ObstacleVectorEnv, "_infos"),
    ("observations", Observer, "observe"),
)
"""Parts of a step and their methods."""


def timed(method, taken):
    """Return the method with the seconds of its calls kept."""

    def call(*args, **kwargs):
        begin = time.perf_counter()
        result = method(*args, **kwargs)
        taken.append(time.perf_counter() - begin)
        return result

    return call


def seconds_of_parts(args, threads):
    """Return seconds of every step, by part."""
    env = ObstacleVectorEnv(OBSTACLE, 9, n_threads=threads)
    actions = random_actions(args.steps, env.num_envs)
    everything = {part: [] for part, _, _ in PARTS}
    for _ in range(args.repeats):
        env.reset(seed=0, options=OPTIONS)
        with ExitStack() as patches:
            for part, owner, name in PARTS:
                method = timed(getattr(owner, name), everything[part])
                patches.enter_context(mock.patch.object(owner, name, method))
            for action in actions:
                env.step(action)
    return {part: np.array(taken) for part, taken in everything.items()}


def parts(args):
    percentiles = (5, 25, 50)
    for threads in sorted({1, args.threads}):
        taken = seconds_of_parts(args, threads)
        taken[COMMANDS] -= taken[PHYSICS]
        whole = taken.pop(WHOLE)
        taken["the rest, and looking at the clock"] = whole - sum(taken.values())
        taken |= {"all but MuJoCo's call": whole - taken[PHYSICS], WHOLE: whole}
        print(f"\n9 environments, {threads} threads, µs a step, percentiles.\n")
        print(f"| part | {' | '.join(f'{p} %' for p in percentiles)} |")
        print("|---" * (len(percentiles) + 1) + "|")
        for part, seconds in taken.items():
            cells = (f"{1e6 * value:.1f}" for value in np.percentile(seconds, percentiles))
            print(f"| {part} | {' | '.join(cells)} |")


def scaling(args):
    print("\n| environments | threads | physics steps a second | bare loop | ratio |")
    print("|---|---|---|---|---|")
    for num_envs in (1, 2, 4, 9, 16, 32, 64, 128, 256):
        for threads in sorted({1, min(args.threads, num_envs)}):
            steps = min(250, max(20, 2000 // num_envs))
            runners = [Bare(num_envs, threads), Ours(num_envs, threads)]
            seconds = interleaved(runners, random_actions(steps, num_envs), args.repeats)
            bare, ours = steps * num_envs * runners[0].ticks / np.median(seconds, axis=0)
            ratio = np.median(seconds[:, 0] / seconds[:, 1])
            print(f"| {num_envs} | {threads} | {ours:,.0f} | {bare:,.0f} | {ratio:.2f} |")
            sys.stdout.flush()


def memory(args):
    del args
    # Not getrusage: what it says of a process begins with the peak of the process that began it.
    code = (
        "import re; from surmount import ObstacleVectorEnv\n"
        "env = ObstacleVectorEnv('step', {}, n_threads=2); env.reset(seed=0)\n"
        "for _ in range(20): env.step(env.action_space.sample())\n"
        "print(re.search(r'VmHWM:\\s+(\\d+) kB', open('/proc/self/status').read())[1])"
    )
    sizes = (2, 256, 4096)
    peak = [
        int(
            subprocess.run(  # noqa: S603  (our own code)
                [sys.executable, "-c", code.format(size)], capture_output=True, check=True
            ).stdout
        )
        for size in sizes
    ]
    each = (peak[2] - peak[1]) / (sizes[2] - sizes[1])
    print(
        f"\nPeak resident memory with {sizes[0]}, {sizes[1]} and {sizes[2]} environments: ", end=""
    )
    print(", ".join(f"{value / 1024:.0f} MiB" for value in peak), end=". ")
    print(f"Each further environment takes {each:.1f} KiB.")


def main():
    every = {"peers": peers, "parts": parts, "scaling": scaling, "memory": memory}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "parts", nargs="*", choices=[[], *every], help="what to measure; all if none"
    )
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeats", type=int, default=15)
    args = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, NumPy {np.__version__}, {platform.machine()}")
    for name in args.parts or every:
        every[name](args)
        sys.stdout.flush()


if __name__ == "__main__":
    main()
