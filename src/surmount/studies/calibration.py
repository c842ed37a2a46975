"""Likelihood of the paper's success after the initiation, under the networks of a setting.

The score of ADR 23. A setting's networks say how networks of its kind succeed and how they differ;
the score is the logarithm of the probability that two new ones, as many as the paper's, show what
the paper prints. One network of 100 % and one of 0 % are unlike two of 50 %, which a distance of
means cannot tell.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.rstar.course.obstacles import find_obstacle
from surmount.stats.new_networks import PrintedCount, predict_printed
from surmount.studies.paper.results import PAPER_RESULTS

PAPER_REPETITIONS = 30
"""Trials per variant and network after the paper's initiation (III-C)."""
LEAST_EASY = 0.5
"""A network below this on the step's easy group (21–33 mm) puts its setting out (ADR 23)."""
SCORED = tuple(
    name
    for name, result in PAPER_RESULTS.items()
    if all(group.recovered for group in result.groups)
)
"""Obstacles whose groups follow from the paper's numbers: not the channel, whose groups are
assumed; also its easy end would need an assumption of where that ends."""
SEED = 23
"""Of the draws of every score: settings are compared by the same ones."""


def printed_count(rate: float, variants: int, networks: int) -> PrintedCount:
    """Return the successes that a printed share stands for.

    Parameters
    ----------
    rate
        Success as printed: to the percent. Where the paper says "~0", at most 1 % after rounding.
    variants
        Number of variants in the group.
    networks
        Networks that the share is over: two, the only number a prediction is made for.
    """
    if networks != 2:
        raise ValueError(f"A printed share is over two networks, not {networks}.")
    trials = variants * PAPER_REPETITIONS
    percent = round(100 * rate)
    low, high = (0.0, 1.5) if percent == 0 else (percent - 0.5, percent + 0.5)
    total = networks * trials
    return PrintedCount(
        low=math.ceil(low * total / 100),
        high=min(math.ceil(high * total / 100) - 1, total),
        trials=trials,
    )


def score(obstacle: str, variants: FloatArray, successes: IntArray, trials: int) -> dict[str, Any]:
    """Return the log-likelihood of the paper's success on an obstacle, and what it is made of.

    Parameters
    ----------
    obstacle
        Name of the family, one of :data:`SCORED`.
    variants
        Sizes in mm, shape ``(variant,)``.
    successes
        Of each network on each size, shape ``(network, variant)``.
    trials
        Of each network on each size.

    Returns
    -------
    dict
        ``log_likelihood``, its ``standard_error`` by the draws, ``converged``, and ``groups``:
        the paper's success and counts, the mean of the networks, their standard deviation
        (``None`` for one), and the probability of the paper's counts in this group alone.
    """
    result = PAPER_RESULTS[obstacle]
    held = [group.holds(variants) for group in result.groups]
    counts = np.stack([successes[:, of_group].sum(axis=1) for of_group in held], axis=1)
    tried = np.array([trials * int(of_group.sum()) for of_group in held])
    sizes = find_obstacle(obstacle).variants
    printed = [
        printed_count(group.after_initiation, int(group.holds(sizes).sum()), result.networks)
        for group in result.groups
    ]
    found = predict_printed(counts, tried, printed, seed=SEED)
    rates = counts / tried
    return {
        "log_likelihood": found.log_probability,
        "standard_error": found.standard_error,
        "converged": found.converged,
        "groups": [
            {
                "name": group.name,
                "paper": group.after_initiation,
                "paper_counts": [count.low, count.high],
                "paper_trials": result.networks * count.trials,
                "mean": float(rates[:, index].mean()),
                "spread": float(rates[:, index].std(ddof=1)) if len(rates) > 1 else None,
                "probability": float(found.of_group[index]),
            }
            for index, (group, count) in enumerate(zip(result.groups, printed, strict=True))
        ],
    }


def total_score(obstacles: Mapping[str, Mapping[str, Any]]) -> float | None:
    """Return the sum of the scores over the obstacles that have one; ``None`` where none has."""
    scores = [found["score"]["log_likelihood"] for found in obstacles.values() if "score" in found]
    return float(sum(scores)) if scores else None


def reason_out(obstacles: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Return why a setting is out by the rule of half the easy step, or ``None``."""
    if "step" not in obstacles:
        return None
    easy = obstacles["step"]["groups"][0]
    for network, rate in zip(obstacles["step"]["networks"], easy["networks"], strict=True):
        if rate < LEAST_EASY:
            return (
                f"network {network} succeeds in {100 * rate:.0f} % on {easy['low_mm']:.0f}–"
                f"{easy['high_mm']:.0f} mm, below {100 * LEAST_EASY:.0f} %"
            )
    return None
