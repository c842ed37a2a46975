"""Synthetic trials with known groups, to judge rules by and to try the analysis without a robot.

A behaviour is a smooth course of three quantities over time (two joint angles and the distance to
the target) with its own duration and noise. Variants of one group share a behaviour up to a graded
change from the group's first variant to its last; an outlier is one variant with a behaviour of
its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.trials import Trials

_SHAPES = 3
"""Terms of the smooth course of a quantity."""


@dataclass(frozen=True, kw_only=True)
class SyntheticFamily:
    """A task family with known groups.

    Attributes
    ----------
    sizes
        Variants in each run of neighbouring variants, from the first variant on.
    behaviours
        Behaviour of each run; a behaviour that occurs twice makes a group that is not contiguous.
    outliers
        Indices of variants with a behaviour of their own.
    separation
        How far behaviours lie apart, in units of the noise's standard deviation (about).
    grading
        How far behaviour drifts from the first to the last variant of a run, in the same units.
    saturated
        Whether joint angles stop at limits, as joints do, so that features stand still for long.
    unevenness
        How many times noisier the last behaviour is than the first.
    trials, steps
        Trials per variant, and control steps of the longest trial.
    seed
        Seed of behaviours and noise.
    """

    sizes: tuple[int, ...] = (5, 5, 5)
    behaviours: tuple[int, ...] = (0, 1, 2)
    outliers: tuple[int, ...] = ()
    separation: float = 4.0
    grading: float = 1.0
    saturated: bool = False
    unevenness: float = 1.0
    trials: int = 20
    steps: int = 100
    seed: int = 0

    @property
    def labels(self) -> IntArray:
        """True group of each variant, −1 for outliers; shape ``(variant,)``."""
        labels = np.repeat(self.behaviours, self.sizes)
        labels[list(self.outliers)] = -1
        return labels.astype(np.int64)

    def generate(self) -> Trials:
        """Draw the trials."""
        rng = np.random.default_rng(self.seed)
        n_variants = sum(self.sizes)
        courses = rng.standard_normal((max(self.behaviours) + 1, 3, _SHAPES))
        courses = self.separation * _pushed_apart(courses)
        drift = rng.standard_normal((len(self.sizes), 3, _SHAPES))
        drift *= self.grading / np.sqrt(np.square(drift).mean(axis=(1, 2), keepdims=True))
        own = self.separation * rng.standard_normal((n_variants, 3, _SHAPES))
        success_rate = np.linspace(1.0, 0.1, max(self.behaviours) + 1)
        noise = np.linspace(1.0, self.unevenness, max(self.behaviours) + 1)
        parts: list[FloatArray] = []
        lengths: list[int] = []
        success: list[bool] = []
        variant = 0
        for run, (size, behaviour) in enumerate(zip(self.sizes, self.behaviours, strict=True)):
            for place in np.linspace(-0.5, 0.5, size) if size > 1 else [0.0]:
                course = courses[behaviour] + place * drift[run]
                if variant in self.outliers:
                    course = own[variant]
                for _ in range(self.trials):
                    parts.append(self._trial(course, noise[behaviour], rng))
                    lengths.append(parts[-1].shape[0])
                    success.append(bool(rng.random() < success_rate[behaviour]))
                variant += 1
        n_trials = len(parts)
        return Trials(
            parameters=("size_mm",),
            feature_names=("time_s", "sprawl_deg", "fbem_deg", "distance_mm"),
            variant=np.repeat(100.0 + 10.0 * np.arange(n_variants), self.trials)
            .astype(np.float64)
            .reshape(-1, 1),
            network=np.tile(np.arange(self.trials) % 2, n_variants).astype(np.int64),
            repetition=np.tile(np.arange(self.trials) // 2, n_variants).astype(np.int64),
            success=np.asarray(success, dtype=np.bool_),
            starts=np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)[: n_trials + 1],
            features=np.concatenate(parts),
        )

    def _trial(self, course: FloatArray, loudness: float, rng: np.random.Generator) -> FloatArray:
        n_steps = max(5, int(self.steps * rng.uniform(0.7, 1.0)))
        time = np.arange(n_steps) / self.steps
        shapes = np.stack([time, np.sin(np.pi * time), np.sin(2.0 * np.pi * time)])
        # One offset per trial, and noise along it with a memory of about ten steps.
        noise = rng.standard_normal((3, 1)) * 0.7 + 0.7 * _smooth_noise(rng, n_steps)
        values = course @ shapes + loudness * noise
        if self.saturated:
            values[:2] = np.clip(values[:2], -1.0, 1.0)
        sprawl, fbem, distance = values
        return np.stack([20.0 * time, 48.0 + 10.0 * sprawl, 20.0 * fbem, 300.0 - 30.0 * distance]).T


def _pushed_apart(courses: FloatArray) -> FloatArray:
    """Scale behaviours about their mean so that the two nearest differ by 1 (root mean square)."""
    centred = courses - courses.mean(axis=0)
    if courses.shape[0] == 1:
        return centred
    difference = centred[:, None] - centred[None]
    gaps = np.sqrt(np.square(difference).mean(axis=(2, 3)))
    return centred / gaps[np.triu_indices(courses.shape[0], 1)].min()


def _smooth_noise(rng: np.random.Generator, n_steps: int) -> FloatArray:
    memory = 10
    white = rng.standard_normal((3, n_steps + memory - 1))
    total = np.cumsum(np.concatenate([np.zeros((3, 1)), white], axis=1), axis=1)
    return (total[:, memory:] - total[:, :-memory]) / np.sqrt(memory)
