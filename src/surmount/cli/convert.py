"""``surmount convert``: logs of any make into a table of trials."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.columns import ColumnOptions
from surmount.core.printing import say


def convert(
    log: Annotated[Path, tyro.conf.Positional],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="FILE")],
    columns: tyro.conf.OmitArgPrefixes[ColumnOptions] = ColumnOptions(),  # noqa: B008 - frozen
) -> int:
    """Turn logs with columns of their own names into a table of trials, and say what is in it.

    Args:
        log: CSV, Parquet or Arrow file with one row per step, a folder of such files, or a Minari
            data set.
        out: Table of trials to write, .parquet or .csv.
        columns: Which column holds what.
    """
    from surmount.trials.table import read_trials, write_trials
    from surmount.workflow.store import output_errors

    trials = read_trials(log, columns=columns.columns())
    with output_errors(out.parent):
        write_trials(out, trials)
    variants, _ = trials.variants()
    say(
        f"{trials.n_trials} trials on {len(variants)} variants, {int(trials.success.sum())} "
        f"succeeded, {trials.n_samples} rows: {out}"
    )
    for note in trials.notes:
        say(f"  {note}")
    return 0
