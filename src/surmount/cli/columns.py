"""Options that say which column of a log holds what, for every verb that reads trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import tyro

from surmount.core.errors import ConfigError
from surmount.trials.columns import Columns

Named = Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="NAME=COLUMN")]
Words = Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="WORD")]
Column = Annotated[str, tyro.conf.arg(metavar="COLUMN")]


@dataclass(frozen=True, kw_only=True)
class ColumnOptions:
    """Which column holds what; without them columns are found by their names."""

    variant: Named = ()
    """Task parameter and its column, as height_mm=StepHeight; may be repeated."""
    feature: Named = ()
    """Feature and its column, as time_s=Time; may be repeated; without it all other columns."""
    trial: Column = ""
    """Column of the trial's or episode's number or name."""
    success: Column = ""
    """Column of the outcome, on each row of a trial or on its last one."""
    success_above: Annotated[float | None, tyro.conf.arg(metavar="VALUE")] = None
    """Value above which a trial's last outcome is a success, where it is a reward or a code."""
    success_word: Words = ()
    """Word that means success, where outcomes are other words than true, yes, success; may be
    repeated."""
    network: Column = ""
    """Column of the training run, if there are several."""
    names: Annotated[str, tyro.conf.arg(metavar="PATTERN")] = ""
    """How the files of a folder are named, as "width{variant.width_m}_net{network}"."""
    beside: Annotated[str, tyro.conf.arg(metavar="FILE")] = ""
    """Table with the column file, and what its other columns say of each file of a folder."""

    def columns(self) -> Columns:
        """Return them as the reader wants them."""
        return Columns(
            variant=_pairs(self.variant, "--variant"),
            features=_pairs(self.feature, "--feature"),
            trial=self.trial,
            success=self.success,
            success_above=self.success_above,
            success_words=self.success_word,
            network=self.network,
            names=self.names,
            beside=self.beside,
        )


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
