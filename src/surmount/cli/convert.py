"""``surmount convert``: logs of other frameworks into a table of trials."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import tyro

from surmount.core.errors import ConfigError

Named = Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="NAME=COLUMN")]


def convert(
    log: Annotated[Path, tyro.conf.Positional],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="FILE")],
    variant: Named = (),
    feature: Named = (),
    trial: str = "episode",
    success: str = "success",
    network: str = "",
) -> int:
    """Turn a log with columns of its own names into trials for `surmount analyze`.

    Args:
        log: CSV or Parquet file with one row per step, for example written by a Unity agent.
        out: Table of trials to write, .parquet or .csv.
        variant: Task parameter and its column, as height_mm=StepHeight; may be repeated.
        feature: Feature and its column, as time_s=Time; may be repeated.
        trial: Column of the episode's number.
        success: Column that is true on a row where the goal is reached.
        network: Column of the training run, if there are several.
    """
    from surmount.exports.trial_logs import Columns, read_log
    from surmount.trials.table import write_trials
    from surmount.workflow.store import output_errors

    columns = Columns(
        variant=_pairs(variant, "--variant"),
        features=_pairs(feature, "--feature"),
        trial=trial,
        success=success,
        network=network,
    )
    trials = read_log(log, columns)
    with output_errors(out.parent):
        write_trials(out, trials)
    variants, _ = trials.variants()
    print(
        f"{trials.n_trials} trials on {len(variants)} variants, {int(trials.success.sum())} "
        f"succeeded, {trials.n_samples} rows: {out}"
    )
    return 0


def _pairs(given: Sequence[str], option: str) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for one in given:
        name, equals, column = (part.strip() for part in one.partition("="))
        if not equals or not name or not column:
            raise ConfigError(
                f"`{option} {one}` is not a name and a column.",
                remedy=f"Write it as {option} height_mm=StepHeight.",
            )
        if name in pairs:
            raise ConfigError(
                f"`{option} {name}` is given twice, as `{pairs[name]}` and as `{column}`.",
                remedy=f"Give each name of {option} once.",
            )
        pairs[name] = column
    return pairs
