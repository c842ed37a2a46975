"""The type of each column, decided once from all of its entries.

Names of networks and trials never pass through a number: an entry is a whole number only where it
is written as one in the only way there is (``7``, not ``07``, ``7.0`` or ``1e3``), and a column
holds whole numbers only where all of its entries are. Task parameters and features are numbers; a
task parameter whose entries are all words is a category.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, cast

import polars as pl

from surmount.trials.columns import FILE_COLUMN, Columns
from surmount.trials.roles import Roles
from surmount.trials.source import Source
from surmount.trials.table_problems import Problems

MISSING_WORDS = ("", "NA", "N/A", "n/a", "NaN", "nan", "NAN", "NaT", "null", "NULL", "None", "<NA>")
_YES = ("1", "1.0", "true", "t", "yes", "y", "success", "succeeded", "successful")
_NO = ("0", "0.0", "false", "f", "no", "n", "failure", "failed", "fail")
_TRUTHS = {"true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0}
DECIMAL_COMMA = r"^[+-]?\d*,\d+([eE][+-]?\d+)?$"
"""A number with a comma for its decimals, as a regular expression."""
_THOUSANDS = r"^[+-]?[1-9]\d{0,2},\d{3}$"
_EXACT = 2**53
"""Whole numbers up to here are floating-point numbers exactly."""
Kind = Literal["number", "instant", "label", "category"]
Entry = tuple[pl.Expr, Any]
"""Entries of a column as they are, and their type."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Field:
    """A column, or one entry of a column of lists, with what it becomes.

    Attributes
    ----------
    name
        Name of its column.
    raw
        Its entries as they are.
    type
        Their type.
    kind
        ``"number"`` (64-bit float), ``"instant"`` (date-times, in nanoseconds), ``"label"``
        (64-bit integers or text) or ``"category"`` (text).
    expression
        Its entries as that; null where they are none.
    """

    name: str
    raw: pl.Expr
    type: Any
    kind: Kind
    expression: pl.Expr


@dataclass(frozen=True, kw_only=True, eq=False)
class Plan:
    """How a table is read: one field for each thing that trials are made of.

    Attributes
    ----------
    n_rows
        Rows of the table.
    parameters, features
        By the name of the parameter, or of the feature.
    network, trial, success
        ``None`` where there is no such column.
    outcome
        Success as 1, 0 or null.
    """

    n_rows: int
    parameters: Mapping[str, Field]
    network: Field | None
    trial: Field | None
    success: Field | None
    features: Mapping[str, Field]


def plan_reading(source: Source, roles: Roles, columns: Columns, problems: Problems) -> Plan:
    """Decide the type of every column that is needed.

    Parameters
    ----------
    source
        The table.
    roles
        Its columns.
    columns
        What outcomes mean.
    problems
        Where problems of whole columns are noted.
    """
    schema = source.schema()
    features = _expanded(source, schema, roles.features, problems)
    parameters = _expanded(source, schema, roles.parameters, problems)
    singles = {
        key: (pl.col(name), schema[name])
        for key, name in (
            ("network", roles.network),
            ("trial", roles.trial),
            ("success", roles.success),
        )
        if name in schema
    }
    if FILE_COLUMN in schema:
        name = pl.col(FILE_COLUMN)
        if "trial" in singles:
            name = pl.concat_str(name, singles["trial"][0].cast(pl.String), separator=":")
        singles["trial"] = (name, pl.String())
    labels = [singles[key] for key in ("network", "trial") if key in singles]
    numbers = [*features.values(), *parameters.values()]
    if "success" in singles and columns.success_above is not None:
        numbers.append(singles["success"])
    survey = _Survey(source, numbers, labels)

    def label(key: str) -> Field | None:
        if key not in singles:
            return None
        return _label(getattr(roles, key) or "file", *singles[key], survey)

    success = None
    if "success" in singles:
        raw, kind = singles["success"]
        success = Field(
            name=roles.success,
            raw=raw,
            type=kind,
            kind="number",
            expression=_outcome(roles.success, raw, kind, columns, survey),
        )
    plan = Plan(
        n_rows=survey.n_rows,
        parameters={
            name: _parameter(_column_of(roles.parameters, name), *field, survey)
            for name, field in parameters.items()
        },
        network=label("network"),
        trial=label("trial"),
        success=success,
        features={
            name: _number(_column_of(roles.features, name), *field, survey)
            for name, field in features.items()
        },
    )
    if survey.with_commas and survey.with_points:
        problems.add(
            f"`{survey.with_commas[0]}` has decimal commas and `{survey.with_points[0]}` points",
            "Write all decimals alike, and no separators of thousands.",
        )
    elif survey.with_thousands and survey.with_thousands == survey.with_commas:
        problems.add(
            f"`{survey.with_thousands[0]}` has commas that may separate decimals or thousands",
            "Write decimals with points, and no separators of thousands.",
        )
    return plan


def _outcome(name: str, raw: pl.Expr, kind: Any, columns: Columns, survey: _Survey) -> pl.Expr:
    """Return outcomes as 1.0 and 0.0, null where they are missing, NaN where they are neither."""
    if not (_is_number(kind) or _is_text(kind)):
        return pl.when(raw.is_not_null()).then(float("nan"))
    if columns.success_words:
        return is_any_of(columns.success_words, raw, kind).cast(pl.Float64)
    if columns.success_above is not None:
        number = _number(name, raw, kind, survey).expression.fill_nan(None)
        there = cleaned(raw, kind) if _is_text(kind) else number
        above = pl.coalesce((number > columns.success_above).cast(pl.Float64), float("nan"))
        return pl.when(there.is_not_null()).then(above)
    if kind == pl.Boolean:
        return raw.cast(pl.Float64)
    if kind.is_numeric():
        value = raw.cast(pl.Float64).fill_nan(None)
        return (
            pl.when(value.is_null() | value.is_in([0.0, 1.0]))
            .then(value)
            .otherwise(pl.lit(float("nan")))
        )
    word = cleaned(raw, kind).str.to_lowercase()
    return (
        pl.when(word.is_null())
        .then(None)
        .when(word.is_in(_YES))
        .then(1.0)
        .when(word.is_in(_NO))
        .then(0.0)
        .otherwise(float("nan"))
    )


def is_any_of(words: Sequence[str], raw: pl.Expr, kind: Any) -> pl.Expr:
    """Return whether entries are any of some words, or of the numbers that these stand for."""
    entry = cleaned(raw, kind).str.to_lowercase()
    wanted = pl.Series([word.strip().lower() for word in words])
    numbers = wanted.cast(pl.Float64, strict=False).drop_nulls()
    same = entry.cast(pl.Float64, strict=False).is_in(numbers.implode())
    return entry.is_in(wanted.implode()) | (entry.is_not_null() & same.fill_null(value=False))


def cleaned(raw: pl.Expr, kind: Any) -> pl.Expr:
    """Return text without spaces around it, null where it says that nothing is there."""
    text = raw.cast(pl.String) if kind != pl.String else raw
    text = text.str.strip_chars()
    return pl.when(text.is_in(MISSING_WORDS)).then(None).otherwise(text)


def _is_text(kind: Any) -> bool:
    return kind in (pl.String, pl.Categorical, pl.Enum)


class _Survey:
    """What the entries of text columns look like, counted in one pass over the table.

    Columns in which something is amiss, missing or written with commas are looked at closer, in
    one more pass.
    """

    def __init__(self, source: Source, numbers: Sequence[Entry], labels: Sequence[Entry]) -> None:
        self.commas = source.decimal_commas
        self.told = source.told
        self.with_commas: list[str] = []
        self.with_thousands: list[str] = []
        self.with_points: list[str] = []
        text = {str(raw): (raw, kind) for raw, kind in (*numbers, *labels) if _is_text(kind)}
        places = {key: str(place) for place, key in enumerate(text)}
        plain: list[pl.Expr] = [pl.len().alias("rows")]
        for key, (raw, kind) in text.items():
            told = raw if kind == pl.String else raw.cast(pl.String)
            read = told.cast(pl.Float64, strict=False)
            if any(key == str(one) for one, _ in labels):
                read = _canonical(told)
            plain.append((read.is_null() & raw.is_not_null()).sum().alias(places[key]))
        first = source.collect(source.frame.select(plain)).row(0, named=True)
        self.n_rows = int(first["rows"])
        self._plain = {key for key in text if not first[places[key]]}
        closer = [
            measure.sum().alias(f"{places[key]} {name}")
            for key, (raw, kind) in text.items()
            if key not in self._plain or self.commas
            for name, measure in _measures(cleaned(raw, kind)).items()
        ]
        second = source.collect(source.frame.select(closer)).row(0, named=True) if closer else {}
        self._counts = {
            key: {name: int(second.get(f"{places[key]} {name}") or 0) for name in _MEASURES}
            for key in text
        }

    def plain(self, raw: pl.Expr) -> bool:
        """Whether all entries of a column are what it should hold, with nothing around them."""
        return str(raw) in self._plain

    def count(self, raw: pl.Expr, measure: str) -> int:
        """Return of how many entries something holds; 0 where nobody had to look."""
        return self._counts[str(raw)][measure]


_MEASURES = ("filled", "whole", "numbers", "commas", "thousands", "points")


def _measures(text: pl.Expr) -> dict[str, pl.Expr]:
    return {
        "filled": text.is_not_null(),
        "whole": _canonical(text).is_not_null(),
        "numbers": text.cast(pl.Float64, strict=False).is_not_null(),
        "commas": text.str.contains(DECIMAL_COMMA),
        "thousands": text.str.contains(_THOUSANDS),
        "points": text.str.contains(".", literal=True),
    }


def _canonical(text: pl.Expr) -> pl.Expr:
    """Return whole numbers that are written in the only way there is, null for all others."""
    number = text.cast(pl.Int64, strict=False)
    return pl.when(number.cast(pl.String) == text).then(number)


def _label(name: str, raw: pl.Expr, kind: Any, survey: _Survey) -> Field:
    if kind.is_integer() or kind == pl.Boolean:
        expression = raw.cast(pl.Int64, strict=False)
        if kind in (pl.UInt64, pl.Int128):
            expression = raw.cast(pl.String)
    elif kind.is_float() or kind.is_decimal():
        value = raw.cast(pl.Float64)
        whole = (value == value.floor()) & (value.abs() <= _EXACT)
        expression = pl.when(whole).then(value).otherwise(None).cast(pl.Int64, strict=False)
    elif _is_text(kind):
        text = cleaned(raw, kind)
        if survey.plain(raw):
            expression = raw.cast(pl.String).cast(pl.Int64, strict=False)
        elif survey.count(raw, "whole") == survey.count(raw, "filled"):
            expression = text.cast(pl.Int64, strict=False)
        else:
            expression = text
    elif kind.is_temporal():
        expression = raw.cast(pl.String, strict=False)
    else:
        expression = pl.lit(None, dtype=pl.Int64)
    return Field(name=name, raw=raw, type=kind, kind="label", expression=expression)


def _parameter(name: str, raw: pl.Expr, kind: Any, survey: _Survey) -> Field:
    words = _is_text(kind) and not survey.plain(raw) and survey.count(raw, "filled")
    if words and not (survey.count(raw, "numbers") or survey.count(raw, "commas")):
        return Field(name=name, raw=raw, type=kind, kind="category", expression=cleaned(raw, kind))
    field = _number(name, raw, kind, survey)
    if field.kind == "instant":  # a moment is no task parameter
        nothing = pl.lit(None, dtype=pl.Float64)
        return Field(name=name, raw=raw, type=kind, kind="number", expression=nothing)
    return field


def _number(name: str, raw: pl.Expr, kind: Any, survey: _Survey) -> Field:
    def field(expression: pl.Expr, becomes: Kind = "number") -> Field:
        return Field(name=name, raw=raw, type=kind, kind=becomes, expression=expression)

    if kind == pl.Duration:
        return field(raw.dt.total_nanoseconds() / 1e9)
    if kind == pl.Datetime:
        return field(raw.dt.timestamp("ns"), "instant")
    if kind.is_numeric() or kind == pl.Boolean:
        return field(raw.cast(pl.Float64))
    if not _is_text(kind):
        return field(pl.lit(None, dtype=pl.Float64))
    if survey.count(raw, "points") and name not in survey.told:
        survey.with_points.append(name)
    if survey.plain(raw):
        return field(raw.cast(pl.String).cast(pl.Float64, strict=False))
    text = cleaned(raw, kind)
    value = text.cast(pl.Float64, strict=False)
    commas = survey.count(raw, "commas")
    if survey.commas and commas and not survey.count(raw, "points"):
        survey.with_commas.append(name)
        if survey.count(raw, "thousands") == commas:
            survey.with_thousands.append(name)
        return field(text.str.replace(",", ".", literal=True).cast(pl.Float64, strict=False))
    truths = text.str.to_lowercase().replace_strict(_TRUTHS, default=None, return_dtype=pl.Float64)
    return field(value if commas else pl.coalesce(value, truths))


def _expanded(
    source: Source, schema: Mapping[str, Any], wanted: Mapping[str, str], problems: Problems
) -> dict[str, Entry]:
    """Return columns by their names, those of lists as one for each entry, ``name.0`` and so on."""
    fields: dict[str, Entry] = {}
    sizes = _list_sizes(source, schema, wanted, problems)
    for name, column in wanted.items():
        stem, _, entry = column.rpartition(".")
        if column in sizes:
            inner = schema[column].inner
            fields |= {
                f"{name}.{i}": (_entry(column, schema[column], i), inner)
                for i in range(sizes[column])
            }
        elif column in schema:
            fields[name] = (pl.col(column), schema[column])
        elif stem in sizes and entry.isdecimal() and int(entry) < sizes[stem]:
            fields[name] = (_entry(stem, schema[stem], int(entry)), schema[stem].inner)
        elif stem in sizes:
            problems.add(
                f"`{stem}` has {sizes[stem]} entries, not {entry}", "They are counted from 0."
            )
    return fields


def _entry(column: str, kind: Any, place: int) -> pl.Expr:
    if kind == pl.Array:
        return pl.col(column).arr.get(place)
    return pl.col(column).list.get(place, null_on_oob=True)


def _list_sizes(
    source: Source, schema: Mapping[str, Any], wanted: Mapping[str, str], problems: Problems
) -> dict[str, int]:
    """Return how many entries columns of lists have; the same in every row, or a problem."""
    stems = {column.rpartition(".")[0] for column in wanted.values() if column not in schema}
    either = {*wanted.values(), *stems}
    named = [name for name in schema if name in either]
    sizes: dict[str, int] = {}
    lists: list[str] = []
    for name in named:
        kind = schema[name]
        if kind in (pl.List, pl.Array) and not _is_number(kind.inner):
            problems.add(
                f"`{name}` holds lists of {_words(kind.inner)}, which are no features",
                "Log plain numbers, or name the features that count.",
            )
            sizes[name] = 0
        elif kind == pl.Array:
            sizes[name] = int(cast(Any, kind).shape[0])
        elif kind == pl.List:
            lists.append(name)
    if lists:
        lengths = source.collect(
            source.frame.select(
                *(pl.col(name).list.len().min().alias(f"{name} least") for name in lists),
                *(pl.col(name).list.len().max().alias(f"{name} most") for name in lists),
            )
        ).row(0, named=True)
        for name in lists:
            least, most = lengths[f"{name} least"] or 0, lengths[f"{name} most"] or 0
            sizes[name] = most
            if least != most:
                problems.add(
                    f"`{name}` holds lists of {least} to {most} entries",
                    "Log as many numbers on each row.",
                )
    return sizes


def _is_number(kind: Any) -> bool:
    return bool(kind.is_numeric()) or kind == pl.Boolean


def _words(kind: Any) -> str:
    return "lists" if kind in (pl.List, pl.Array) else "text or records"


def _column_of(wanted: Mapping[str, str], name: str) -> str:
    return wanted.get(name, name)
