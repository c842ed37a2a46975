"""The table that ``surmount evaluate`` prints: success by variant."""

from __future__ import annotations

import numpy as np
from rich.table import Table

from surmount.experiment.evaluation import Evaluation
from surmount.stats.proportions import proportion_intervals


def success_table(evaluation: Evaluation) -> Table:
    """Return successes, rates with their intervals and median times, one row a variant."""
    trials = evaluation.trials
    variants, which = trials.variants()
    tried = np.bincount(which, minlength=len(variants))
    won = np.bincount(which, weights=trials.success, minlength=len(variants)).astype(np.int64)
    interval = proportion_intervals(won, tried)
    times_s = np.where(trials.success, trials.final("time_s"), evaluation.cap_s)
    table = Table(title=f"{evaluation.task}: {trials.success.mean():.1%} of {trials.n_trials:,}")
    for heading in (
        *evaluation.space.parameters,
        "successes",
        "rate",
        "95 % (Wilson)",
        "median time, s",
    ):
        table.add_column(heading, justify="right")
    for index, variant in enumerate(variants):
        table.add_row(
            *(axis.text(value) for axis, value in zip(trials.axes, variant, strict=True)),
            f"{won[index]} / {tried[index]}",
            f"{interval.proportions[index]:.2f}",
            f"{interval.lower[index]:.2f} to {interval.upper[index]:.2f}",
            f"{np.median(times_s[which == index]):.2f}",
        )
    return table
