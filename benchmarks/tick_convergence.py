"""Which physics tick is short enough: outcomes of the same manoeuvres at several ticks (ADR 20).

    OMP_NUM_THREADS=1 python benchmarks/tick_convergence.py --frictions 0.7 1.3

A family of manoeuvres is drawn around successful ones, each with a step of 30 to 46 mm, and
tried at ticks of 5, 2.5, 1.25 and 0.625 ms. A tick is short enough where the success rate does not
differ from that at a quarter of it (exact McNemar test on the same manoeuvres, 5 %); where there is
no quarter, at half of it. Prints Markdown; takes about half an hour a friction.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from scipy.stats import binomtest

from surmount.envs import EnvConfig, find_obstacle
from surmount.envs.manoeuvre import Manoeuvre
from surmount.envs.manoeuvre_search import LOWER, UPPER, SearchConfig, search, try_out
from surmount.envs.manoeuvre_templates import templates
from surmount.envs.simulation import Simulation

TICKS_MS = (5.0, 2.5, 1.25, 0.625)
SIZES_MM = (30.0, 34.0, 38.0, 42.0, 46.0)
SEARCHED_MM = (30.0, 36.0, 42.0, 45.0)
COUNT, HORIZON_S = 480, 12.0
BEST = 8
"""Successful manoeuvres of a search that others are drawn around, the fastest."""
FIELDS = ("speed_mps", "fbem_deg", "sprawl_deg", "until_x_m", "at_most_s")
SPREAD = dict(zip(FIELDS, 0.03 * (UPPER - LOWER), strict=True))
"""Standard deviations of what is varied: 3 % of what a search draws from."""


def around(rng, manoeuvre):
    """Return a manoeuvre near another one."""
    record = [
        {key: value + rng.normal(0, SPREAD[key]) for key, value in phase.items()}
        for phase in manoeuvre.to_record()
    ]
    for phase in record:
        phase["at_most_s"] = max(0.2, phase["at_most_s"])
        phase["speed_mps"] = float(np.clip(phase["speed_mps"], 0.05, 0.25))
        phase["fbem_deg"] = float(np.clip(phase["fbem_deg"], -72, 72))
        phase["sprawl_deg"] = float(np.clip(phase["sprawl_deg"], 0, 180))
    return Manoeuvre.from_record(record)


def family(rng, env):
    """Return manoeuvres around those that searches found, with a size each.

    Searches begin with what was made by hand, as those of the capability map do.
    """
    obstacle = find_obstacle("step")
    simulation = Simulation(obstacle, env, SearchConfig().population, 1)
    successful = []
    for size_mm in SEARCHED_MM:
        hints = [*successful[-BEST:], *templates()]
        found = search(
            obstacle, env, size_mm, SearchConfig(), seed=1, simulation=simulation, hints=hints
        )
        successful += found.successes[:BEST]
    manoeuvres = [around(rng, successful[rng.integers(len(successful))]) for _ in range(COUNT)]
    return manoeuvres, rng.choice(SIZES_MM, size=COUNT)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frictions", type=float, nargs="+", default=[0.7, 1.3])
    args = parser.parse_args()
    print("| friction | tick, ms | success | succeeds here only, at the shorter only | p | |")
    print("|---|---|---|---|---|---|")
    for friction in args.frictions:
        env = EnvConfig()
        env = replace(env, robot=replace(env.robot, friction=friction))
        manoeuvres, sizes_mm = family(np.random.default_rng(0), env)
        success = {}
        for tick_ms in TICKS_MS:
            robot = replace(env.robot, physics_tick_s=tick_ms * 1e-3)
            finer = replace(env, robot=robot)
            simulation = Simulation(find_obstacle("step"), finer, COUNT, 1)
            tried = try_out(simulation, finer, sizes_mm, manoeuvres, HORIZON_S)
            success[tick_ms] = tried.success
        for index, tick_ms in enumerate(TICKS_MS[:-1]):
            shorter = TICKS_MS[min(index + 2, len(TICKS_MS) - 1)]
            here = int((success[tick_ms] & ~success[shorter]).sum())
            there = int((success[shorter] & ~success[tick_ms]).sum())
            p = binomtest(here, here + there).pvalue if here + there else 1.0
            print(
                f"| {friction:g} | {tick_ms:g} | {success[tick_ms].mean():.3f} | {here}, {there} "
                f"of {COUNT} | {p:.2g} | {'converged' if p > 0.05 else 'not'} |",
                flush=True,
            )
        print(f"| {friction:g} | {TICKS_MS[-1]:g} | {success[TICKS_MS[-1]].mean():.3f} | | | |")


if __name__ == "__main__":
    main()
