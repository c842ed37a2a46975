"""Which physics step is short enough: outcomes of manoeuvres at several of them (ADR 20).

    OMP_NUM_THREADS=1 python benchmarks/physics_step_convergence.py --frictions 1.3

A family of manoeuvres is drawn around those made by hand, each with a step of 30 to 46 mm. None is
chosen by its success, which would favour the physics step that it was tried at. One is short enough
where its success rate does not differ from that at a quarter of it, contacts staying as stiff as
they are (exact McNemar test on the same manoeuvres, 5 %). Prints Markdown; takes 20 minutes a
friction.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from scipy.stats import binomtest

from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre
from surmount.rstar.manoeuvres.search import LOWER, UPPER, try_out
from surmount.rstar.manoeuvres.templates import templates

TICKS_MS = (5.0, 2.5, 1.25, 0.625, 0.3125)
QUARTER = 2
"""Places in the list to a quarter of a physics step."""
SIZES_MM = (30.0, 34.0, 38.0, 42.0, 46.0)
COUNT, HORIZON_S = 480, 12.0
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


def family(rng):
    """Return manoeuvres around those made by hand, and a size for each."""
    made = templates()
    manoeuvres = [around(rng, made[rng.integers(len(made))]) for _ in range(COUNT)]
    return manoeuvres, rng.choice(SIZES_MM, size=COUNT)


def success_at(env, tick_ms, manoeuvres, sizes_mm):
    """Return which manoeuvres succeed at a physics step."""
    finer = replace(env, robot=replace(env.robot, physics_step_s=tick_ms * 1e-3))
    simulation = Simulation(find_obstacle("step"), finer, COUNT, 1)
    return try_out(simulation, finer, sizes_mm, manoeuvres, HORIZON_S).success


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frictions", type=float, nargs="+", default=[EnvConfig().robot.friction])
    args = parser.parse_args()
    print("| friction | physics step, ms | success | only here, only at a quarter | p |")
    print("|---|---|---|---|---|")
    for friction in args.frictions:
        manoeuvres, sizes_mm = family(np.random.default_rng(0))
        env = replace(EnvConfig(), robot=replace(EnvConfig().robot, friction=friction))
        success = [success_at(env, tick_ms, manoeuvres, sizes_mm) for tick_ms in TICKS_MS]
        for index, (tick_ms, here) in enumerate(zip(TICKS_MS, success, strict=True)):
            row = f"| {friction:g} | {tick_ms:g} | {here.mean():.3f} |"
            if index + QUARTER < len(success):
                quarter = success[index + QUARTER]
                more, less = int((here & ~quarter).sum()), int((quarter & ~here).sum())
                p = binomtest(more, more + less).pvalue if more + less else 1.0
                verdict = "converged" if p > 0.05 else "not"
                print(f"{row} {more}, {less} of {COUNT} | {p:.2g}, {verdict} |", flush=True)
            else:
                print(f"{row} | |", flush=True)


if __name__ == "__main__":
    main()
