"""Which column of a table holds what, as somebody says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from surmount.core.errors import ConfigError

TIME = "time_s"
KEYS = ("network", "trial", "success")
FILE_COLUMN = "surmount.file"
"""Column that holds the name of the file a row is from, where there are several."""


def is_own_column(name: str) -> bool:
    """Whether a table of trials has a column of this name that holds no feature."""
    return name in ("variant", *KEYS) or name.startswith("variant.")


@dataclass(frozen=True, kw_only=True)
class Columns:
    """Which columns of a log hold what; what is not named is found by its name.

    Attributes
    ----------
    variant
        Column of each task parameter, by the parameter's name; none named means ``variant`` or
        ``variant.<name>``.
    network
        Column of the network, or training run, that acted.
    trial
        Column of the trial's or episode's number or name.
    success
        Column of the outcome, on each row of a trial or on its last one.
    features
        Column of each feature, by the feature's name; none named means all other columns.
        ``time_s`` is the time since the start of the trial.
    success_above
        Value above which the last outcome of a trial is a success, where outcomes are rewards,
        shares or codes; ``None`` where they are 1 and 0 or words.
    success_words
        Words that mean success, where outcomes are other words than true, yes and success; all
        others then mean failure.
    names
        How the files of a folder are named, as ``"width{variant.width_m}_net{network}"``; what
        stands in braces becomes a column.
    beside
        Table with the column ``file``, and further columns for all rows of that file; in a folder
        ``trials.csv`` is taken by itself.
    """

    variant: Mapping[str, str] = field(default_factory=dict[str, str])
    network: str = ""
    trial: str = ""
    success: str = ""
    features: Mapping[str, str] = field(default_factory=dict[str, str])
    success_above: float | None = None
    success_words: tuple[str, ...] = ()
    names: str = ""
    beside: str = ""

    def __post_init__(self) -> None:
        for name in self.features:
            if is_own_column(name) or name in self.variant:
                what = "a task parameter" if name in self.variant else "a column of its own"
                raise ConfigError(
                    f"A feature cannot be named `{name}`, which is {what} in a table of trials.",
                    remedy="Give the feature another name.",
                )
        if self.success_above is not None and not math.isfinite(self.success_above):
            raise ConfigError(
                f"`success_above` is {self.success_above}, which no outcome is above or below.",
                remedy="Give a number.",
            )
        if self.success_above is not None and self.success_words:
            raise ConfigError(
                "`success_above` and `success_words` are both given.",
                remedy="Say either above which number, or by which words a trial succeeded.",
            )

    @property
    def named(self) -> frozenset[str]:
        """All columns that were named."""
        keys = filter(None, [self.network, self.trial, self.success])
        return frozenset([*self.variant.values(), *self.features.values(), *keys])

    @property
    def mapped(self) -> bool:
        """Whether a column was named, so that the table is a log of somebody else's making."""
        return bool(self.variant or self.trial or self.features)
