"""Learning of every network as curves, with the levels and tests of its curriculum: the data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.report.document.parts import Columns
from surmount.report.results import TrainingResult
from surmount.teachers.teacher import LevelTest
from surmount.workflow.run_layout import CURRICULUM, INITIATION, TRAININGS

Measure = Literal["reward", "success"]
Trainings = Mapping[str, Mapping[int, TrainingResult]]

SMOOTHING = 25
"""A curve is averaged over about this fraction of its roll-outs, at least 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """One training of one network on the axis of steps since the network began.

    Attributes
    ----------
    kind
        What was trained.
    begin
        Learning steps before it.
    steps, values
        Learning steps at the end of each roll-out, and the measure there, ``(rollout,)``.
    smooth
        Running mean over ``window`` roll-outs of the same level, ``(rollout,)``.
    window
        Odd number of roll-outs.
    """

    kind: str
    begin: int
    steps: IntArray
    values: FloatArray
    smooth: FloatArray
    window: int

    def at(self, step: int) -> float:
        """Return the running mean at the roll-out that ends nearest to a step."""
        return float(self.smooth[int(np.abs(self.steps - step).argmin())])


def running_mean(values: FloatArray, window: int, part: IntArray) -> FloatArray:
    """Return the mean over neighbours of the same part.

    Parameters
    ----------
    values
        Shape ``(rollout,)``.
    window
        Odd number of neighbours, the value itself included; fewer at the ends of a part.
    part
        Part that each value belongs to, ascending: a level, so that the mean does not mix two.
    """
    total = np.concatenate([[0.0], np.cumsum(values)])
    index, half = np.arange(values.size), window // 2
    first = np.searchsorted(part, part, side="left")
    last = np.searchsorted(part, part, side="right")
    low, high = np.maximum(index - half, first), np.minimum(index + half + 1, last)
    return (total[high] - total[low]) / (high - low)


def curves_of(trainings: Trainings, network: int, measure: Measure) -> list[Curve]:
    """Return the curves of a network, initiation first; none where a measure is undefined."""
    begin, found = 0, list[Curve]()
    for kind in TRAININGS:
        training = trainings.get(kind, {}).get(network)
        if training is None:
            continue
        values = [*training.reward.tolist()] if measure == "reward" else [*training.success]
        rows = [row for row, value in enumerate(values) if value is not None]
        if rows:
            known = np.array([values[row] for row in rows], dtype=np.float64)
            window = 2 * (known.size // SMOOTHING // 2) + 1
            found.append(
                Curve(
                    kind=kind,
                    begin=begin,
                    steps=begin + training.steps[rows],
                    values=known,
                    smooth=running_mean(known, window, level_of_rollouts(training, rows)),
                    window=window,
                )
            )
        if kind == INITIATION:
            begin = training.total_steps
    return found


def level_of_rollouts(training: TrainingResult, rows: list[int]) -> IntArray:
    """Return how many levels had been left before each of these roll-outs began."""
    return levels_left_before(training, training.steps[rows])


def levels_left_before(training: TrainingResult, steps: IntArray) -> IntArray:
    """Return how many levels had been left before each of these learning steps was made."""
    ends = [test.steps for test in training.level_tests if test.decision != "extend"]
    return np.searchsorted(ends, steps, side="left").astype(np.int64)


def tests_of(trainings: Trainings, network: int) -> list[tuple[int, LevelTest]]:
    """Return every level test with its learning steps since the network began."""
    training = trainings.get(CURRICULUM, {}).get(network)
    initiation = trainings.get(INITIATION, {}).get(network)
    begin = initiation.total_steps if initiation else 0
    return [(begin + test.steps, test) for test in training.level_tests] if training else []


def levels_of(tests: list[tuple[int, LevelTest]], begin: int) -> list[tuple[int, int, int]]:
    """Return level, first and last step of each level that was ended."""
    levels: list[tuple[int, int, int]] = []
    start = begin
    for step, test in tests:
        if test.decision != "extend":
            levels.append((test.level, start, step))
            start = step
    return levels


def learning_data(
    drawn: Mapping[int, list[Curve]], trainings: Trainings, measure: Measure
) -> Columns:
    """Return all roll-outs and level tests as one table."""
    columns: dict[str, list[object]] = {
        name: []
        for name in ("kind", "network", "stage", "steps", measure, "running_mean", "level",
                     "iteration", "measure", "first_window", "last_window", "first_episodes",
                     "last_episodes", "first_gain", "newest_gain", "ratio", "threshold", "rule",
                     "decision")
    }  # fmt: skip
    for network, curves in drawn.items():
        for curve in curves:
            rows = curve.steps.size
            _extend(
                columns,
                rows,
                kind=["rollout"] * rows,
                network=[network] * rows,
                stage=[curve.kind] * rows,
                steps=curve.steps.tolist(),
                running_mean=curve.smooth.tolist(),
                **{measure: curve.values.tolist()},
            )
        tests = tests_of(trainings, network)
        fields = ("level", "iteration", "measure", "first_window", "last_window",
                  "first_episodes", "last_episodes", "first_gain", "newest_gain", "ratio",
                  "threshold", "rule", "decision")  # fmt: skip
        _extend(
            columns,
            len(tests),
            kind=["level test"] * len(tests),
            network=[network] * len(tests),
            stage=[CURRICULUM] * len(tests),
            steps=[step for step, _ in tests],
            **{name: [getattr(test, name) for _, test in tests] for name in fields},
        )
    return columns


def _extend(columns: dict[str, list[object]], rows: int, **values: list[object]) -> None:
    for name, column in columns.items():
        column.extend(values.get(name, [None] * rows))
