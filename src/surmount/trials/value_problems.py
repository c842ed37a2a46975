"""Sentences on entries that are not what their column holds, with their rows and what to do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import polars as pl

from surmount.core.arrays import IntArray
from surmount.trials.column_types import DECIMAL_COMMA, Field, cleaned, is_any_of
from surmount.trials.columns import Columns
from surmount.trials.source import Source
from surmount.trials.table_problems import Problems

_LARGEST_VALUE = 1e100
"""Larger values count as infinite: their squares overflow."""
_EXACT = 2**53
_SHOWN_WORDS = 10
_ABOVE = "or say above which value it is one, with `--success-above`"


def note_bad_numbers(
    field: Field, values: pl.Series, source: Source, problems: Problems, *, exact: bool = False
) -> None:
    """Note the rows where a column of numbers holds none, or one that is not finite.

    Parameters
    ----------
    field
        The column.
    values
        What it became.
    source, problems
        The table, and where problems are noted.
    exact
        Whether whole numbers must be told apart, which floating-point numbers do up to 2⁵³.
    """
    name = field.name
    number = values.cast(pl.Float64).to_numpy()
    if field.kind == "instant":
        bad = np.flatnonzero(np.isnan(number))
    else:
        bad = np.flatnonzero(~(np.abs(number) <= _LARGEST_VALUE))
    if (
        exact
        and field.kind == "number"
        and np.abs(number[~np.isnan(number)]).max(initial=0) >= _EXACT
    ):
        problems.rows(
            np.flatnonzero(np.abs(number) >= _EXACT),
            f"`{name}` is 2^53 or larger, where numbers are not told apart",
            "Number the variants, or give them names.",
        )
        bad = bad[np.isnan(number[bad])]
    if not bad.size:
        return
    raw = _raw(field, source, bad)
    there = raw.is_not_null()
    infinite = there.to_numpy() & np.isinf(
        np.where(np.abs(number[bad]) > _LARGEST_VALUE, np.inf, 0)
    )
    if raw.dtype.is_float():
        there = there & ~raw.is_nan().fill_null(value=True)
    missing = ~there.to_numpy()
    word = ~missing & ~infinite
    commas = np.zeros(bad.size, dtype=np.bool_)
    if raw.dtype == pl.String:
        commas = word & raw.str.contains(DECIMAL_COMMA).fill_null(value=False).to_numpy()
    problems.rows(
        bad[commas],
        f"`{name}` has decimal commas",
        "Write decimals with points, or separate columns by semicolons instead of commas.",
    )
    problems.rows(
        bad[word & ~commas],
        f"`{name}` is not a number",
        f"Write numbers in `{name}`, or leave it out.",
    )
    problems.rows(
        bad[missing], f"`{name}` is missing or NaN", "Drop the trial, or log a finite value."
    )
    problems.rows(
        bad[infinite],
        f"`{name}` is infinite",
        "Clip it to a finite value, such as the end of the sensor's range.",
    )


def note_bad_labels(field: Field, values: pl.Series, source: Source, problems: Problems) -> None:
    """Note the rows where a column of names or whole numbers holds neither."""
    name = field.name
    bad = np.flatnonzero(values.is_null().to_numpy())
    if not bad.size:
        return
    raw = _raw(field, source, bad)
    missing = raw.is_null()
    if raw.dtype.is_float():
        missing = missing | raw.is_nan().fill_null(value=True)
    gone = missing.to_numpy()
    problems.rows(bad[gone], f"`{name}` is missing", f"Give each row a `{name}`.")
    problems.rows(
        bad[~gone],
        f"`{name}` is neither a whole number, nor a name",
        "Write whole numbers (as floating-point numbers they are exact to 2^53 only), or names as "
        "text.",
    )


def note_bad_outcomes(
    field: Field, values: pl.Series, source: Source, columns: Columns, problems: Problems
) -> None:
    """Note the rows where an outcome says neither success nor failure."""
    bad = np.flatnonzero(values.is_nan().fill_null(value=False).to_numpy())
    if not bad.size:
        return
    raw = _raw(field, source, bad)
    shown = ", ".join(str(value) for value in raw.unique(maintain_order=True).head(3).to_list())
    if columns.success_above is not None:
        problems.rows(
            bad,
            f"`{field.name}` is not a number ({shown}), so that it is not above one either",
            "Write numbers as outcomes, or name a column that holds some, with `--success`.",
        )
        return
    number = raw.cast(pl.Float64, strict=False) if _castable(raw) else None
    numeric = number is not None and number.is_not_null().all()
    codes = numeric and bool((number == number.floor()).all())  # type: ignore[union-attr]
    what = "a code" if codes else "a reward or a share" if numeric else "a word"
    remedy = (
        "Write 1 (true) for a trial that reached its goal and 0 (false) for one that did not, "
        f"{_ABOVE}."
    )
    if not numeric:
        remedy = (
            "Write 1, true, yes or success for a trial that reached its goal, and 0, false, no or "
            "failure for one that did not, or say which words mean success, with `--success-word`."
        )
    problems.rows(bad, f"`{field.name}` is neither 0 nor 1 but {what} ({shown})", remedy)


def note_absent_words(
    field: Field, words: Sequence[str], source: Source, problems: Problems
) -> list[str]:
    """Note that no outcome is any of the words that mean success, so that all trials would fail.

    Returns
    -------
    list
        A sentence if no outcome is some of several words.
    """
    measures = [is_any_of([word], field.raw, field.type).any().alias(word) for word in words]
    heard = source.collect(source.frame.select(measures)).row(0)
    absent = [word for word, one in zip(words, heard, strict=True) if not one]
    if not absent:
        return []
    raw = cleaned(field.raw, field.type).drop_nulls().unique().sort().alias("raw")
    there = source.collect(source.frame.select(raw))["raw"].head(_SHOWN_WORDS).to_list()
    said = f"`{field.name}` is {' or '.join(absent)}: there are {', '.join(there) or 'none'}"
    if len(absent) < len(words):
        return [f"No {said}."]
    problems.add(
        f"no {said}",
        "Name those that mean success, with `--success-word`; where no trial succeeded, write 0.",
    )
    return []


def _raw(field: Field, source: Source, rows: IntArray) -> pl.Series:
    """Return what stands in some rows; text without spaces around it, null where it is empty."""
    raw = field.raw
    if field.type in (pl.String, pl.Categorical, pl.Enum):
        raw = cleaned(raw, field.type)
    elif not (field.type.is_numeric() or field.type.is_temporal()):
        raw = pl.when(raw.is_null()).then(None).otherwise(pl.lit("no number"))
    return source.collect(source.frame.select(raw.alias("raw")))["raw"].gather(rows)


def _castable(raw: pl.Series) -> bool:
    return raw.dtype == pl.String or raw.dtype.is_numeric()
