"""Markdown tables of what an environment shows and takes, from the code that does it.

``docs/environments.md`` holds them; a test compares.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from surmount.rstar.course.actions import ACTION_TERMS
from surmount.rstar.course.config import CourseConfig, EnvConfig, RewardConfig
from surmount.rstar.course.infos import INFO_KEYS
from surmount.rstar.course.observations import ObservationTerm, observation_terms, target_terms
from surmount.rstar.course.obstacles import Obstacle
from surmount.rstar.course.rewards import Reward
from surmount.rstar.robot import constants as c
from surmount.rstar.robot import kinematics


def observation_table(obstacle: Obstacle) -> str:
    """Return the entries of an obstacle's observation: index, symbol, unit, range, scaling."""
    terms = observation_terms(obstacle)
    return _table(("index", *_HEAD), ((index, *_row(term)) for index, term in enumerate(terms)))


def target_table() -> str:
    """Return the entries that ``observe_targets`` adds before the obstacle's size."""
    return _table(_HEAD, map(_row, target_terms()))


_HEAD = ("entry", "symbol", "unit", "range", "centre", "scale", "observed", "meaning")


def _row(term: ObservationTerm) -> tuple[str, ...]:
    low, high = (term.centre + sign * term.bound * term.scale for sign in (-1, 1))
    return (
        term.name,
        term.symbol,
        term.unit,
        f"{low:g} to {high:g}",
        f"{term.centre:g}",
        f"{term.scale:g}",
        f"± {term.bound:g}",
        term.meaning,
    )


def action_table() -> str:
    """Return the entries of an action: index, symbol, unit, range, rate of a full action."""
    rows = [
        (
            index,
            term.name,
            term.symbol,
            term.unit,
            _range(term.lower, term.upper),
            f"{term.rate:g} {term.unit} per s",
            "−1 to 1",
            term.meaning,
        )
        for index, term in enumerate(ACTION_TERMS)
    ]
    head = (
        "index",
        "target",
        "symbol",
        "unit",
        "range of the target",
        "full action",
        "action",
        "meaning",
    )
    return _table(head, rows)


def info_table() -> str:
    """Return what ``info`` holds after every reset and step."""
    return _table(("key", "meaning"), ((f"`{key}`", text) for key, text in INFO_KEYS.items()))


def stuck_table() -> str:
    """Return what an episode costs that a robot spends upright with its wheels at the front face.

    By unit of D_z, with the body in the middle and as far forward as it goes.
    """
    course = CourseConfig()
    axle_m = -(c.WHEELBASE_MM / 2 + c.WHEEL_RADIUS_MM) * 1e-3
    shift_m = float(kinematics.body_shift_mm(c.FBEM_MAX_DEG)) * 1e-3
    left_m = course.target_m - axle_m - np.array([0.0, shift_m])
    rows: list[tuple[str, ...]] = []
    for name, unit_m in (("m", 1.0), ("dm", 0.1), ("cm", 0.01)):
        config = EnvConfig(reward=RewardConfig(distance_unit_m=unit_m))
        reward = Reward(config)
        step = reward.distance(left_m, np.zeros(2)) + reward.time(np.zeros((2, 2)))
        middle, forward = (-config.steps_per_episode * step).tolist()
        rows.append((name, *(f"{cost:.3f}" for cost in (middle, forward, middle - forward))))
    head = ("unit of D_z", "FBEM 0°", f"FBEM +{c.FBEM_MAX_DEG:g}°", "saved by the swing")
    return _table(head, rows)


def _range(low: float, high: float) -> str:
    return f"{low:g} to {high:g}".replace("-", "−")


def _table(head: tuple[str, ...], rows: Iterable[tuple[object, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)
