"""Random actions for millions of steps: what goes wrong, and how far.

    OMP_NUM_THREADS=1 python benchmarks/random_actions_soak.py --steps 10000000 --processes 2 \
        --out soak.jsonl [--set robot.gear=both ...]

Variants are uniform, starts random, as in training. A third of the environments draws new actions
at every step, a third holds each for up to a second, a third goes from one limit to another and
holds it for up to a second. All three obstacles take an equal share.

At every step, of every environment: values that are not finite, divergence, tunnelling (the
centre of base, carrier or wheel inside a block, inside the floor or under it), energy, speed. At
every step, of one environment in turn: depth of contacts. At every hundredth, of one
environment: overlap of the robot's own parts, which do not collide in the simulation.

The limits were set before the runs: see ``LIMITS``. The script ends with an error if one is passed.

Work is done in pieces, each with its own seed. With ``--out`` every finished piece is written down,
and the same command goes on where it was stopped. Prints Markdown.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from pathlib import Path

import numpy as np
from gymnasium.vector import AutoresetMode

from surmount.core import configuration
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from soundness import Soundness

NUM_ENVS = 36
PIECE = 100_000
"""Steps of a piece, over all of its environments."""
DEPTHS_MM = (1.0, 2.0, 3.0, 5.0)
SELF_EVERY = 100
LONGEST_HOLD_S = 1.0
LIMITS = {
    "diverged": 0,
    "warnings": 0,
    "not_finite": 0,
    "tunnelled": 0,
    "floor_mm": 6.0,
    "block_mm": 6.0,
    "self_mm": 1.0,
    "total_j": 75.0,
}
"""What must not be passed. Depths: a fifth of a wheel's radius; and twice the 0.46 mm by which the
motor nubs meet by construction. Energy: the work of all four servos in one sweep of their ranges
at full torque, 2 × (8 N m × 180° + 4 N m × 144°) = 70 J, and 5 J for a centre 0.2 m above the
floor."""
FAST_DEGPS = 160.0
"""Joints are commanded at 80 degrees/s at most; twice that is a servo let go."""


class RandomActions:
    """New actions at every step, held ones, and full ones of either sign, a third each."""

    def __init__(self, rng, num_envs, interval_s):
        self.rng = rng
        self.longest = max(1, round(LONGEST_HOLD_S / interval_s))
        self.kind = np.arange(num_envs) % 3
        self.left = np.zeros(num_envs, dtype=int)
        self.now = np.zeros((num_envs, 3))

    def next(self):
        """Return the next actions."""
        due = np.flatnonzero((self.left == 0) | (self.kind == 0))
        drawn = self.rng.uniform(-1, 1, (due.size, 3))
        full = self.kind[due] == 2
        drawn[full] = np.sign(drawn[full])
        self.now[due] = drawn
        self.left[due] = self.rng.integers(1, self.longest + 1, due.size)
        self.left -= 1
        return self.now


LARGEST = ("floor_mm", "block_mm", "self_mm", "kinetic_j", "total_j", "speed_mps", "joint_degps")
COUNTED = (
    *("episodes", "successes", "diverged", "not_finite", "tunnelled", "fast"),
    *("looks", "self_looks"),
)


class Worst:
    """The largest value seen and where."""

    def __init__(self):
        self.value, self.where = 0.0, None

    def see(self, values, step, variants, envs=None):
        """Look at values of some environments."""
        index = int(np.argmax(values))
        if values[index] > self.value:
            env = index if envs is None else envs
            self.value = float(values[index])
            self.where = {"step": step, "env": env, "size_mm": float(variants[env])}


def run_piece(task):
    """Run one piece and return what was seen."""
    obstacle, piece, steps, seed, record = task
    config = configuration.from_record(EnvConfig, record)
    num_envs = min(NUM_ENVS, steps)
    # Episodes that end are looked at before they begin anew.
    env = ObstacleVectorEnv(
        obstacle, num_envs, config=config, n_threads=1, autoreset_mode=AutoresetMode.DISABLED
    )
    looks = Soundness(env.obstacle, config, env.simulation)
    root = np.random.SeedSequence([seed, list(OBSTACLES).index(obstacle), piece])
    env_seed, action_seed = root.generate_state(2)
    actions = RandomActions(np.random.default_rng(action_seed), num_envs, config.step_s)
    _, infos = env.reset(seed=int(env_seed))
    worst = {name: Worst() for name in LARGEST}
    counts = dict.fromkeys(COUNTED, 0)
    deeper = {name: [0] * len(DEPTHS_MM) for name in ("floor_mm", "block_mm")}
    data, steps = None, steps // num_envs
    begin = time.process_time()
    for step in range(steps):
        size_mm = infos["variant"][:, 0]
        observation, reward, terminated, truncated, infos = env.step(actions.next())
        numbers = (observation, reward, infos["features"])
        counts["not_finite"] += int(not all(np.isfinite(values).all() for values in numbers))
        counts["tunnelled"] += int(looks.tunnelled(size_mm).sum())
        energy = looks.energy_j()
        worst["kinetic_j"].see(energy[:, 1], step, size_mm)
        worst["total_j"].see(energy.sum(axis=1), step, size_mm)
        worst["speed_mps"].see(looks.speed_mps(), step, size_mm)
        speed_degps = looks.joint_speed_degps()
        worst["joint_degps"].see(speed_degps, step, size_mm)
        counts["fast"] += int(np.count_nonzero(speed_degps > FAST_DEGPS))
        seen = step % num_envs
        data = env.simulation.data(seen, data)
        counts["looks"] += 1
        for name, depth in zip(deeper, looks.penetration_mm(data), strict=True):
            worst[name].see([depth], step, size_mm, seen)
            for index, limit in enumerate(DEPTHS_MM):
                deeper[name][index] += int(depth > limit)
        if step % SELF_EVERY == 0:
            counts["self_looks"] += 1
            worst["self_mm"].see([looks.self_penetration_mm(data)], step, size_mm, seen)
        ended = terminated | truncated
        if ended.any():
            counts["episodes"] += int(ended.sum())
            counts["successes"] += int(infos["is_success"].sum())
            counts["diverged"] += int(infos["diverged"].sum())
            _, infos = env.reset(options={"reset_mask": ended})
    return {
        "obstacle": obstacle,
        "piece": piece,
        "steps": steps * num_envs,
        "physics steps": steps * num_envs * config.physics_steps_per_step,
        "seconds": time.process_time() - begin,
        "counts": counts | {"warnings": int(env.simulation.batch.warning.sum())},
        "deeper": deeper,
        "worst": {name: {"value": w.value, "where": w.where} for name, w in worst.items()},
    }


def pieces(args, record):
    """Return what there is to do: obstacle, number, steps, seed and configuration."""
    share = -(-args.steps // len(args.obstacles))
    size = min(PIECE, share)
    return [
        (obstacle, number, size, args.seed, record)
        for number in range(-(-share // size))
        for obstacle in args.obstacles
    ]


def finished(path, header):
    """Return the pieces written down by an earlier call with the same header."""
    if path is None or not path.exists():
        return []
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]  # a kill may have left half a line
    path.write_text(whole, encoding="utf-8")
    first, *lines = whole.splitlines()
    if json.loads(first) != header:
        raise SystemExit(f"{path} is of another run: name another file with --out.")
    return [json.loads(line) for line in lines]


def work(args, config):
    """Run all pieces that are not yet finished and return what all of them saw."""
    record = configuration.to_record(config)
    header = {"config": record, "seed": args.seed, "piece": PIECE, "num_envs": NUM_ENVS}
    path = args.out
    results = finished(path, header)
    done = {(result["obstacle"], result["piece"], result["steps"]) for result in results}
    tasks = [
        task
        for task in pieces(args, record)
        if (task[0], task[1], task[2] // NUM_ENVS * NUM_ENVS) not in done
    ]
    if path is not None and not path.exists():
        path.write_text(json.dumps(header) + "\n", encoding="utf-8")
    with multiprocessing.get_context("spawn").Pool(args.processes) as pool:
        for result in pool.imap_unordered(run_piece, tasks):
            results.append(result)
            if path is not None:
                with path.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(result) + "\n")
    return results


ROWS = (
    ("steps", "steps", ",d"),
    ("physics steps", "physics steps", ",d"),
    ("episodes ended", "episodes", ",d"),
    ("of them at the target", "successes", ",d"),
    ("simulations that diverged", "diverged", ",d"),
    ("MuJoCo's warnings", "warnings", ",d"),
    ("steps with a value that is not finite", "not_finite", ",d"),
    ("tunnelling, environments × steps", "tunnelled", ",d"),
    ("looks at contacts", "looks", ",d"),
    ("deepest in the floor, mm", "floor_mm", ".2f"),
    *(
        (f"deeper than {depth:g} mm in the floor", ("floor_mm", depth), ".4%")
        for depth in DEPTHS_MM
    ),
    ("deepest in the obstacle, mm", "block_mm", ".2f"),
    *((f"deeper than {d:g} mm in the obstacle", ("block_mm", d), ".4%") for d in DEPTHS_MM),
    ("looks at the robot's own parts", "self_looks", ",d"),
    ("deepest overlap of its own parts, mm", "self_mm", ".2f"),
    ("largest kinetic energy, J", "kinetic_j", ".2f"),
    ("largest kinetic and potential energy, J", "total_j", ".2f"),
    ("largest speed of the base, m/s", "speed_mps", ".2f"),
    ("fastest sprawl or FBEM joint, degrees/s", "joint_degps", ".0f"),
    (f"faster than {FAST_DEGPS:g} degrees/s, environments × steps", "fast", ",d"),
)


def over_all(results, key):
    """Return a sum, a largest value, or the share of looks that were deeper than a depth."""
    if isinstance(key, tuple):
        name, index = key[0], DEPTHS_MM.index(key[1])
        return sum(r["deeper"][name][index] for r in results) / over_all(results, "looks")
    if key in LARGEST:
        return max(result["worst"][key]["value"] for result in results)
    return sum(result["counts"].get(key, result.get(key)) for result in results)


def table(results, obstacles):
    """Return the Markdown table of what was seen."""
    groups = [[r for r in results if r["obstacle"] == name] for name in obstacles] + [results]
    lines = [f"| | {' | '.join(obstacles)} | all | limit |", "|---" * (len(obstacles) + 3) + "|"]
    for what, key, form in ROWS:
        cells = [format(over_all(group, key), form) for group in groups]
        limit = format(LIMITS[key], form) if key in LIMITS else ""
        lines.append(f"| {what} | {' | '.join(cells)} | {limit} |")
    return "\n".join(lines)


def extremes(results):
    """Return where each largest value was seen, to be run again."""
    lines = []
    for name in results[0]["worst"]:
        worst = max(results, key=lambda result: result["worst"][name]["value"])
        seen = worst["worst"][name]
        lines.append(
            f"- largest `{name}`, {seen['value']:.2f}: {worst['obstacle']}, piece "
            f"{worst['piece']}, {seen['where']}"
        )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=60_000, help="steps, over all obstacles")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--obstacles", nargs="+", choices=list(OBSTACLES), default=list(OBSTACLES))
    parser.add_argument("--out", type=Path, help="file of finished pieces, to go on from")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    args = parser.parse_args()
    config = configuration.override(EnvConfig(), dict(item.split("=", 1) for item in args.set))
    begin = time.perf_counter()
    results = work(args, config)
    minutes = sum(result["seconds"] for result in results) / 60
    print(f"{args.processes} processes, {time.perf_counter() - begin:.0f} s; ", end="")
    print(f"{minutes:.1f} core-minutes in all pieces. Settings: {args.set or 'defaults'}.\n")
    print(table(results, args.obstacles))
    print(f"\n{extremes(results)}")
    passed = [key for key, limit in LIMITS.items() if over_all(results, key) > limit]
    if passed:
        raise SystemExit(f"Beyond its limit: {', '.join(passed)}.")


if __name__ == "__main__":
    main()
