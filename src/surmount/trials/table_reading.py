"""From columns to trials: read once, checked, and every problem told at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import polars as pl

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.axis import CONTINUOUS, Axes, Axis, stored_values, variant_text
from surmount.core.errors import SurmountError
from surmount.core.names import LONGEST_NAME, is_printable
from surmount.trials.column_types import Field, Plan, plan_reading
from surmount.trials.columns import TIME, Columns
from surmount.trials.roles import MARK_OF_END, Roles
from surmount.trials.row_groups import RowGroups, group_rows
from surmount.trials.source import Source, require_memory
from surmount.trials.table_problems import Problems
from surmount.trials.trials import Trials
from surmount.trials.value_problems import (
    note_absent_words,
    note_bad_labels,
    note_bad_numbers,
    note_bad_outcomes,
)

_SAME = 2e-7
"""Relative difference that rounding to 32 bits may make (6e-8 for each value), with some room."""
_SAME_AS_ZERO = 1e-9
"""Difference, as a share of the largest value, that what should be 0 may have from it."""


def read_source(
    source: Source,
    roles: Roles,
    columns: Columns,
    problems: Problems,
    *,
    minimum_variants: int,
    minimum_samples: int,
) -> Trials:
    """Read trials from a table whose columns have been found.

    Memory: 8 bytes per feature and row remain; on top come one column and the identities.

    Raises
    ------
    InputError
        Naming every problem of the table at once.
    """
    schema = source.schema()
    complete = not problems.found
    if not schema:
        problems.found.clear()
        problems.add("the table has no rows", "Log at least one trial.")
        problems.raise_if_any(source.name)
    plan = plan_reading(source, roles, columns, problems)
    require_memory(source.name, plan.n_rows, len(schema))
    if plan.n_rows == 0:
        problems.add("the table has no rows", "Log at least one trial.")
        problems.raise_if_any(source.name)
    reader = _Reader(source, plan, columns, problems)
    if not reader.identified:
        reader.note_features()
        problems.raise_if_any(source.name)
    rows = reader.groups()
    variant = reader.variants(rows)
    if plan.parameters:
        _check_variants(variant, rows.lengths, reader, minimum_variants, minimum_samples)
    if not complete:  # without a column nobody knows which rows are one trial
        reader.note_features()
        problems.raise_if_any(source.name)
    success = reader.outcomes(rows)
    if roles.success == MARK_OF_END and not columns.success and success.all():
        problems.add(
            f"`{MARK_OF_END}` is true at the end of every trial, and so is no outcome",
            "Name the column of the outcome with `--success`; a reward with `--success-above` too.",
        )
    features = reader.features(rows)
    if columns.mapped or TIME in plan.features:
        _check_numbering(rows, reader, features, mapped=columns.mapped)
    network, names = reader.numbered("network", rows)
    if not all(map(is_printable, names)):
        problems.add(
            f"the name of a network has control characters or over {LONGEST_NAME} characters",
            "Give networks short names of letters and digits.",
        )
    problems.raise_if_any(source.name)
    return Trials(
        parameters=tuple(plan.parameters),
        feature_names=tuple(plan.features),
        variant=variant,
        network=network,
        repetition=reader.numbered("trial", rows)[0],
        success=success,
        starts=rows.starts,
        features=features,
        network_names=names,
        axes=reader.axes,
        notes=(*source.notes, *roles.notes, *reader.notes),
    )


class _Reader:
    """The columns of a table while trials are made from them; each is forgotten once it is used."""

    def __init__(self, source: Source, plan: Plan, columns: Columns, problems: Problems) -> None:
        self.source, self.plan, self.problems = source, plan, problems
        self._columns = columns
        self.notes: list[str] = []
        labels = {"network": plan.network, "trial": plan.trial}
        parameters = {f"parameter {i}": one for i, one in enumerate(plan.parameters.values())}
        self._ids = [*(parameters or ["parameter 0"]), *labels]
        features = {f"feature {i}": one for i, one in enumerate(plan.features.values())}
        present = {**parameters, **labels, "success": plan.success, **features}
        frame = source.collect(
            source.frame.select(one.expression.alias(name) for name, one in present.items() if one)
        )
        if not frame.width:
            frame = pl.select(pl.repeat(0, plan.n_rows).alias("row"))
        absent = [name for name in (*self._ids, "success") if name not in frame.columns]
        self._frame = frame.with_columns(pl.lit(0).alias(name) for name in absent)
        before = len(problems.found)
        if plan.success:
            note_bad_outcomes(plan.success, frame["success"], source, columns, problems)
        self._outcomes_said = len(problems.found) == before
        if plan.success and columns.success_words and self._outcomes_said:
            self.notes += note_absent_words(plan.success, columns.success_words, source, problems)
        before = len(problems.found)
        for name, one in {**parameters, **labels}.items():
            if one and one.kind == "number":
                note_bad_numbers(one, frame[name], source, problems, exact=True)
            elif one:
                note_bad_labels(one, frame[name], source, problems)
        self.identified = len(problems.found) == before
        self.axes = self._on_axes(parameters)

    def _on_axes(self, parameters: dict[str, Field]) -> Axes:
        """Put numbers for the names of categories; return the axes that parameters lie on.

        Names are categories in alphabetical order, numbers continuous, unless the file says more.
        """
        if not self.identified:
            return ()
        axes: list[Axis] = []
        for (column, one), name in zip(parameters.items(), self.plan.parameters, strict=True):
            given = self._frame[column].unique().sort().to_list()
            axis = CONTINUOUS
            try:
                if one.kind == "category":
                    axis = Axis(kind="categorical", names=tuple(given))
                if name in self.source.axes:
                    axis = Axis.from_record(self.source.axes[name])
                elif axis.categorical:
                    self.notes.append(
                        f"`{one.name}` holds names: `{name}` is read as a category of "
                        f"{len(given)} kinds ({', '.join(given[:5])}"
                        f"{', …' if len(given) > 5 else ''})."
                    )
                values = stored_values(name, given, axis) if axis != CONTINUOUS else None
            except (SurmountError, KeyError, TypeError, AttributeError) as error:
                why = error.message if isinstance(error, SurmountError) else "damaged"
                self.problems.add(
                    f"`{one.name}` does not lie on its axis ({why.rstrip('.')})",
                    "Give variants short names or numbers; write the table by `write_trials`.",
                )
                axis, values = CONTINUOUS, np.arange(float(len(given)))
            if values is not None:
                code = pl.col(column).replace_strict(given, values, return_dtype=pl.Float64)
                self._frame = self._frame.with_columns(code)
            axes.append(axis)
        return tuple(axes)

    def groups(self) -> RowGroups:
        """Return which rows each trial has."""
        rows = group_rows(self._frame.select(self._ids))
        self._frame = self._frame.drop(self._ids)
        return rows

    def outcomes(self, rows: RowGroups) -> BoolArray:
        """Return the success of each trial, shape ``(trial,)``: what its last outcome says."""
        value = self._frame.drop_in_place("success").cast(pl.Float32).to_numpy()
        filled = np.flatnonzero(~np.isnan(value))
        trial, said = rows.trial[filled], value[filled] > 0.5
        last = np.full(rows.n_trials, -1, dtype=np.int64)
        last[trial] = np.arange(trial.size)  # of several, the last one counts
        success = said[last] if said.size else np.zeros(rows.n_trials, dtype=np.bool_)
        if self._columns.success_above is None:
            order = np.argsort(trial, kind="stable")
            one, same = said[order], trial[order][1:] == trial[order][:-1]
            falls = np.flatnonzero(same & one[:-1] & ~one[1:]) + 1
            self.problems.rows(
                np.sort(filled[order[falls]]),
                "`success` falls from 1 to 0 within a trial",
                "`success` is the outcome of the whole trial: repeat it on each of its rows, or "
                "write it on its last one.",
            )
        self.problems.rows(
            rows.first[last < 0] if self._outcomes_said else rows.first[:0],
            "no row of the trial that begins here has a `success`",
            "Write the outcome on each row of a trial, or on its last one.",
        )
        return success

    def variants(self, rows: RowGroups) -> FloatArray:
        """Return the task parameters of each trial, shape ``(trial, parameter)``."""
        count = max(len(self.plan.parameters), 1)
        columns = [rows.ids[f"parameter {i}"].to_numpy() for i in range(count)]
        return np.stack(columns, axis=1).astype(np.float64)

    def numbered(self, key: str, rows: RowGroups) -> tuple[IntArray, tuple[str, ...]]:
        """Return whole numbers as they are, or names as numbers in alphabetical order."""
        values = rows.ids[key]
        if values.dtype != pl.String:
            return values.to_numpy().astype(np.int64), ()
        names = values.unique().sort()
        number = np.searchsorted(names.to_numpy().astype(str), values.to_numpy().astype(str))
        return number.astype(np.int64), tuple(names.to_list())

    def features(self, rows: RowGroups) -> FloatArray:
        """Return the features with the rows of each trial together, ``(sample, feature)``."""
        values = np.empty((len(self.plan.features), rows.trial.size)).T
        for index, (name, field, column) in enumerate(self._feature_columns()):
            if field.kind == "instant":
                note_bad_numbers(field, column, self.source, self.problems)
                values[:, index] = self._since_start(name, column.fill_null(0).to_numpy(), rows)
                continue
            note_bad_numbers(field, column, self.source, self.problems)
            values[:, index] = rows.ordered(column.to_numpy())
        if TIME in self.plan.features:
            self._check_time(values[:, list(self.plan.features).index(TIME)], rows)
        return values

    def _feature_columns(self) -> Iterator[tuple[str, Field, pl.Series]]:
        """Give each feature's column out once, so that it takes no memory when it has been read."""
        columns = {column.name: column for column in self._frame.get_columns()}
        places = [f"feature {index}" for index in range(len(self.plan.features))]
        self._frame = self._frame.select(pl.exclude(places))
        for place, (name, field) in zip(places, self.plan.features.items(), strict=True):
            yield name, field, columns.pop(place)

    def _since_start(
        self, name: str, instants: np.ndarray[Any, Any], rows: RowGroups
    ) -> FloatArray:
        """Return date-times, in nanoseconds, as seconds since the first row of their trial."""
        ordered = rows.ordered(instants)
        self.notes.append(
            f"`{name}` holds date-times: they are read as seconds since the start of each trial."
        )
        return (ordered - np.repeat(ordered[rows.starts[:-1]], rows.lengths)) / 1e9

    def note_features(self) -> None:
        """Note the problems of the features where trials cannot be told apart."""
        for _, field, column in self._feature_columns():
            note_bad_numbers(field, column, self.source, self.problems)

    def _check_time(self, time: FloatArray, rows: RowGroups) -> None:
        """Note rows whose time is that of the row before, or earlier, within their trial."""
        step = np.diff(time)
        step[rows.starts[1:-1] - 1] = 1.0
        self.problems.rows(
            np.sort(rows.row_of(np.flatnonzero(step == 0.0) + 1)),
            f"the same `{TIME}` as in another row of the same trial",
            "Remove duplicate rows, or give each repetition its own number in `trial`.",
        )
        self.problems.rows(
            np.sort(rows.row_of(np.flatnonzero(step < 0.0) + 1)),
            f"`{TIME}` runs backwards within a trial",
            "Write the rows of a trial in the order of time; where several agents write one log, "
            "number their trials by agent, as in `3:17`.",
        )


def _check_variants(
    variant: FloatArray,
    lengths: IntArray,
    reader: _Reader,
    minimum_variants: int,
    minimum_samples: int,
) -> None:
    problems, axes = reader.problems, reader.axes
    variants, index = np.unique(variant, axis=0, return_inverse=True)
    counts = np.bincount(index.reshape(-1), weights=lengths).astype(np.int64)
    if variants.shape[0] < minimum_variants:
        problems.add(
            f"there is only one variant ({variant_text(axes, variants[0])})"
            if variants.shape[0] == 1
            else f"there are only {variants.shape[0]} variants",
            f"Record trials on at least {minimum_variants} variants of the task.",
        )
    for axis, column in zip(axes, variants.T, strict=True):
        if axis.discrete:
            continue
        values = np.unique(column)
        close = _rounded_apart(values)
        for left, right in zip(values[:-1][close], values[1:][close], strict=True):
            problems.add(
                f"variants {float(left)!r} and {float(right)!r} differ by rounding only",
                "Write the same number on all rows of a variant.",
            )
    for values, count in zip(variants, counts.tolist(), strict=True):
        if count < minimum_samples:
            problems.add(
                f"variant {variant_text(axes, values)} has {count} rows, fewer than "
                f"{minimum_samples}",
                "Record more trials on it, or leave the variant out.",
            )


def _rounded_apart(values: FloatArray) -> BoolArray:
    """Whether each of ascending values differs from the next by rounding only, ``(value - 1,)``.

    Whole numbers are exact, and small numbers are no zeros where all are positive, as on a
    logarithmic axis.
    """
    size = np.abs(values)
    near = _SAME * np.maximum(size[1:], size[:-1])
    if values[0] <= 0:
        near = np.maximum(near, _SAME_AS_ZERO * size.max())
    whole = values == np.floor(values)
    close: BoolArray = (np.diff(values) <= near) & ~(whole[1:] & whole[:-1])
    return close


def _check_numbering(
    rows: RowGroups, reader: _Reader, features: FloatArray, *, mapped: bool
) -> None:
    """Note trials whose variant changes on the way, or say of a log that numbers repeat.

    Where a number of a trial comes again with another variant, the trials were numbered anew for
    each variant if time begins anew there. Without a time, they were if most numbers come again.
    """
    ids = rows.ids.with_columns(
        variant=pl.struct(name for name in rows.ids.columns if name.startswith("parameter "))
    )
    several = ids.group_by("network", "trial").agg(pl.col("variant").n_unique() > 1)
    again = int(several["variant"].sum())
    if not again:
        return
    names = tuple(reader.plan.features)
    first = rows.first
    before = np.maximum(first - 1, 0)
    same = np.asarray(first > 0)
    for key in ("network", "trial"):
        column = rows.ids[key]
        same &= (column == column.gather(pl.Series(rows.trial[before]))).to_numpy()
    if TIME in names:
        time = features[:, names.index(TIME)]
        place = np.empty(time.size, dtype=np.int64)
        place[rows.row_of(np.arange(time.size))] = np.arange(time.size)
        same &= time[place[first]] > time[place[before]]
    elif 2 * again > several.height:
        same &= False
    reader.problems.rows(
        first[same],
        f"{_listed(tuple(reader.plan.parameters))} changes within a trial",
        "Give each trial one number: count on after each reset, also where the task changes.",
    )
    if mapped and not same.any():
        reader.notes.append(
            "Numbers of trials come again on other variants: those are read as other trials."
        )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)
