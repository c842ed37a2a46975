"""Curricula: groups of variants, levels of weighted groups, one file to read and to edit."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.axis import (
    Axes,
    axes_from_record,
    axes_to_record,
    full_axes,
    values_of,
    variant_text,
)
from surmount.core.drawing import Chart, chart
from surmount.core.errors import InputError
from surmount.core.records import read_record, write_atomically
from surmount.tasks.curriculum_check import SCHEMA, SCHEMA_OF_AXES, curriculum_problems
from surmount.tasks.distribution import TaskDistribution


@dataclass(frozen=True, kw_only=True, eq=False)
class Box:
    """A box of task parameters that belongs to one group.

    Attributes
    ----------
    lower, upper
        Bounds LBᵢ and UBᵢ of eq. 4 in the parameters' units, shape ``(parameter,)``.
    weight
        Relative weight of the box within its group: the number of recorded variants in it.
    """

    lower: FloatArray
    upper: FloatArray
    weight: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Group:
    """Variants on which the robot behaves alike.

    Attributes
    ----------
    name
        ``"easy"``, ``"medium"``, ``"difficult"``, or numbered from the easiest.
    variants
        Recorded variants in ascending order, shape ``(variant, parameter)``.
    success_rate
        Mean success rate over the variants; the group's complexity is 1 minus it.
    boxes
        Where the group lies in the space of tasks: one box per run of neighbouring variants, or
        one cell per variant where there are several parameters, or categories.
    """

    name: str
    variants: FloatArray
    success_rate: float
    boxes: tuple[Box, ...]

    @property
    def complexity(self) -> float:
        """1 − success rate (paper II-B)."""
        return 1.0 - self.success_rate


@dataclass(frozen=True, kw_only=True)
class Level:
    """One level of the curriculum: a mixture of groups (eq. 4).

    Attributes
    ----------
    dominant
        Name of the group that the level is for.
    weights
        Weight wᵢ of each group in the order of :attr:`Curriculum.groups`, summing to 1.
    """

    dominant: str
    weights: tuple[float, ...]


ONE_GROUP = (
    "With one group there is no curriculum to compare: its level draws tasks as uniform sampling "
    "does, so that what was learnt with and without differs by chance alone."
)
"""What is said wherever results of a single group are shown."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Curriculum:
    """Groups from easy to difficult, and the levels to learn them by.

    A curriculum without levels is a defined result: every group already succeeds.

    Attributes
    ----------
    parameters
        Names of the task parameters with their units, for example ``("height_mm",)``.
    groups
        From the highest success rate to the lowest.
    levels
        In the order of learning; as many as there are groups below the success threshold.
    success_threshold
        Success rate from which a group needs no level (paper II-C: 0.95).
    axes
        One for each parameter; all are continuous where none are given.
    """

    parameters: tuple[str, ...]
    groups: tuple[Group, ...]
    levels: tuple[Level, ...]
    success_threshold: float
    axes: Axes = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", full_axes(self.axes, self.parameters))
        problems = curriculum_problems(self.to_record())
        if problems:
            raise InputError(
                f"The curriculum is not valid: {'; '.join(problems)}.",
                remedy="Correct what is named.",
            )

    @property
    def n_levels(self) -> int:
        """Number of levels."""
        return len(self.levels)

    def level_distribution(self, level: int) -> TaskDistribution:
        """Return P_j = Σᵢ wᵢ U(LBᵢ, UBᵢ) of a level counted from 0 (eq. 4).

        Raises
        ------
        InputError
            If there is no such level.
        """
        if not 0 <= level < len(self.levels):
            raise InputError(
                f"There is no level {level}: the curriculum has {len(self.levels)}.",
                remedy="Levels are counted from 0.",
            )
        return self._distribution(self.levels[level].weights)

    def group_distribution(self, group: int) -> TaskDistribution:
        """Return the distribution of one group's tasks."""
        return self._distribution([float(index == group) for index in range(len(self.groups))])

    def sample(self, level: int, rng: np.random.Generator, size: int) -> FloatArray:
        """Draw tasks of a level, shape ``(size, parameter)`` in the parameters' units."""
        return self.level_distribution(level).sample(rng, size)

    def group_of(self, variant: FloatArray) -> int | None:
        """Return the index of the group that a recorded variant belongs to, or ``None``."""
        for index, group in enumerate(self.groups):
            if np.isclose(group.variants, np.atleast_1d(variant), rtol=1e-9).all(axis=1).any():
                return index
        return None

    def groups_of(self, variants: FloatArray) -> IntArray:
        """Return the index of the group of each variant, −1 where it belongs to none.

        Parameters
        ----------
        variants
            Shape ``(trial, parameter)``; variants may occur many times.

        Returns
        -------
        IntArray
            Shape ``(trial,)``.
        """
        distinct, index = np.unique(variants, axis=0, return_inverse=True)
        found = [self.group_of(variant) for variant in distinct]
        groups = np.asarray([-1 if group is None else group for group in found], dtype=np.int64)
        return groups[index.reshape(-1)]

    def text(self, variant: FloatArray) -> str:
        """Return a variant, shape ``(parameter,)``, for people."""
        return variant_text(self.axes, variant)

    def on(self, axes: Axes) -> Curriculum:
        """Return the curriculum on other axes, such as those of an environment.

        A table of numbers does not tell whole numbers from others, nor the order of categories.

        Parameters
        ----------
        axes
            One per parameter. Categories keep their names; a range becomes that of the whole
            numbers in it.

        Raises
        ------
        InputError
            If a variant cannot lie on its new axis, or a range holds nothing of it.
        """

        def moved(values: FloatArray, round_to: Callable[[float], float] = float) -> FloatArray:
            return np.array(
                [
                    new.stored(old.value(float(value)))
                    if new.categorical
                    else round_to(float(value))
                    if new.discrete and not old.categorical
                    else (np.nan if old.categorical else float(value))
                    for old, new, value in zip(self.axes, axes, values, strict=True)
                ]
            )

        full_axes(axes, self.parameters)
        groups = tuple(
            replace(
                group,
                variants=np.stack([moved(variant) for variant in group.variants]),
                boxes=tuple(
                    replace(
                        box, lower=moved(box.lower, math.ceil), upper=moved(box.upper, math.floor)
                    )
                    for box in group.boxes
                ),
            )
            for group in self.groups
        )
        for group in groups:
            ends = [bound for box in group.boxes for bound in (box.lower, box.upper)]
            points = np.concatenate([group.variants, np.stack(ends)])
            empty = any((box.lower > box.upper).any() for box in group.boxes)
            fits = [axis.holds(column).all() for axis, column in zip(axes, points.T, strict=True)]
            if empty or not all(fits):
                demands = "; ".join(
                    f"{name} {axis.demand}"
                    for name, axis in zip(self.parameters, axes, strict=True)
                )
                raise InputError(
                    f"The curriculum's group `{group.name}` does not lie on other axes.",
                    remedy=f"They are: {demands}. Make a curriculum from trials on such tasks.",
                )
        return replace(self, groups=groups, axes=axes)

    def to_record(self) -> dict[str, Any]:
        """Return the JSON form, made to be read and edited by people.

        Categories are written by their names, whole numbers without a point. Where all axes are
        continuous it is what Surmount wrote before there were others, schema 1.
        """
        axes = axes_to_record(self.axes, self.parameters)
        return {
            "kind": "surmount curriculum",
            "schema": SCHEMA_OF_AXES if axes else SCHEMA,
            "parameters": list(self.parameters),
            **({"axes": axes} if axes else {}),
            "success_threshold": self.success_threshold,
            "groups": [
                {
                    "name": group.name,
                    "success_rate": group.success_rate,
                    "variants": [values_of(self.axes, variant) for variant in group.variants],
                    "boxes": [
                        {
                            "lower": values_of(self.axes, box.lower),
                            "upper": values_of(self.axes, box.upper),
                            "weight": box.weight,
                        }
                        for box in group.boxes
                    ],
                }
                for group in self.groups
            ],
            "levels": [
                {
                    "dominant": level.dominant,
                    "weights": {
                        group.name: weight
                        for group, weight in zip(self.groups, level.weights, strict=False)
                    },
                }
                for level in self.levels
            ],
        }

    @classmethod
    def from_record(cls, record: dict[str, Any], *, source: str = "The curriculum") -> Curriculum:
        """Build from the JSON form.

        Raises
        ------
        InputError
            Naming every problem of the record at once.
        """
        problems = curriculum_problems(record)
        if problems:
            raise InputError(
                f"{source} is not valid: {'; '.join(problems)}.",
                remedy="Correct what is named; `surmount analyze` writes a valid file.",
            )
        axes = axes_from_record(record.get("axes", {}), record["parameters"])

        def stored(values: Sequence[Any]) -> FloatArray:
            return np.array([axis.stored(one) for axis, one in zip(axes, values, strict=True)])

        groups = tuple(
            Group(
                name=group["name"],
                variants=np.stack([stored(variant) for variant in group["variants"]]),
                success_rate=float(group["success_rate"]),
                boxes=tuple(
                    Box(
                        lower=stored(box["lower"]),
                        upper=stored(box["upper"]),
                        weight=float(box["weight"]),
                    )
                    for box in group["boxes"]
                ),
            )
            for group in record["groups"]
        )
        levels = tuple(
            Level(
                dominant=level["dominant"],
                weights=tuple(float(level["weights"].get(group.name, 0.0)) for group in groups),
            )
            for level in record["levels"]
        )
        return cls(
            parameters=tuple(record["parameters"]),
            groups=groups,
            levels=levels,
            success_threshold=float(record["success_threshold"]),
            axes=axes,
        )

    def plot(self) -> Chart:
        """Draw the success of each group, and what each level draws of them.

        Returns
        -------
        Chart
            An Altair chart: a notebook shows it, ``save("curriculum.svg")`` writes it.

        Raises
        ------
        MissingExtraError
            If the extra ``report`` is not installed.
        """
        return chart("curriculum", self)

    def save(self, path: Path | str) -> None:
        """Write the curriculum as one JSON file, whole or not at all."""
        text = json.dumps(self.to_record(), indent=2, ensure_ascii=False, allow_nan=False)
        # Points and bounds on one line each: a line break cannot occur within a JSON string.
        flat = re.sub(r"\[\n\s*([^\[\]{}\n]*(?:\n[^\[\]{}\n]*)*?)\n\s*\]", _on_one_line, text)
        write_atomically(Path(path), f"{flat}\n".encode())

    @classmethod
    def load(cls, path: Path | str) -> Curriculum:
        """Read a curriculum, written by :meth:`save` or by hand.

        Raises
        ------
        InputError
            If the file cannot be read, or naming every problem of its content at once.
        """
        return cls.from_record(read_record(Path(path)), source=str(path))

    def _distribution(self, weights: Sequence[float]) -> TaskDistribution:
        box_weights: list[float] = []
        lower: list[FloatArray] = []
        upper: list[FloatArray] = []
        for group, weight in zip(self.groups, weights, strict=True):
            total = sum(box.weight for box in group.boxes)
            for box in group.boxes:
                if weight > 0 and box.weight > 0:
                    box_weights.append(weight * box.weight / total)
                    lower.append(box.lower)
                    upper.append(box.upper)
        probabilities = np.asarray(box_weights)
        return TaskDistribution(
            parameters=self.parameters,
            weights=probabilities / probabilities.sum(),
            lower=np.asarray(lower),
            upper=np.asarray(upper),
            axes=self.axes,
        )


def _on_one_line(match: re.Match[str]) -> str:
    return f"[{' '.join(part.strip() for part in match[1].splitlines())}]"
