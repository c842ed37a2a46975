"""Synthetic trials with known groups, to judge rules by and to try the analysis without a robot.

A behaviour is a smooth course of three quantities over time (two joint angles and the distance to
the target) with its own duration and noise. Variants of one group share a behaviour up to a graded
change from the group's first variant to its last; an outlier is one variant with a behaviour of
its own. Between two runs there may be a transition, as trained networks show it: each trial takes
the one behaviour or the other, with a probability that slides from variant to variant and passes
one half elsewhere for each network. A stuck robot stops midway and sits still until its time is up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.trials.trials import Trials

_SHAPES = 3
"""Terms of the smooth course of a quantity."""
_UNSETTLED = 0.1
"""A variant whose rarer behaviour has at least this probability belongs to no group."""
_TIME_LIMIT = 1.5
"""Duration of stuck trials, in units of the longest trial that is not stuck."""
_STILLNESS = 0.05
"""How much of its noise a stuck robot keeps."""


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
    acceleration
        How many times faster it drifts at the end of a run than at its start.
    saturated
        Whether joint angles stop at limits, as joints do, so that features stand still for long.
    unevenness
        How many times noisier the last behaviour is than the first.
    transition
        Variants, about, over which trials pass from the behaviour of one run to the next; 0 for
        all at once.
    networks
        Networks, which take the trials of a variant in turn.
    network_shift
        Variants between the places where the first and the last network pass.
    stuck
        Behaviours in which the robot stops midway and sits still until its time is up.
    own_behaviours
        Whether each network has behaviours of its own, as training runs have.
    steady_network
        Whether the last network keeps to its first behaviour: then only the others change from
        group to group.
    trials, steps
        Trials per variant, of all networks, and control steps of the longest trial that is not
        stuck.
    seed
        Seed of behaviours and noise.
    """

    sizes: tuple[int, ...] = (5, 5, 5)
    behaviours: tuple[int, ...] = (0, 1, 2)
    outliers: tuple[int, ...] = ()
    separation: float = 4.0
    grading: float = 1.0
    acceleration: float = 1.0
    saturated: bool = False
    unevenness: float = 1.0
    transition: float = 0.0
    networks: int = 2
    network_shift: float = 0.0
    stuck: tuple[int, ...] = ()
    own_behaviours: bool = False
    steady_network: bool = False
    trials: int = 20
    steps: int = 100
    seed: int = 0

    @property
    def labels(self) -> IntArray:
        """True group of each variant, shape ``(variant,)``.

        −1 for outliers, and where trials of both behaviours are common (0.1 to 0.9) in the
        networks that change.
        """
        labels = np.repeat(self.behaviours, self.sizes)
        passed = self._passed()[: self.networks - self.steady_network].mean(axis=0)
        unsettled = np.minimum(passed, 1.0 - passed) >= _UNSETTLED
        labels[unsettled.any(axis=1)] = -1
        labels[list(self.outliers)] = -1
        return labels.astype(np.int64)

    def generate(self) -> Trials:
        """Draw the trials."""
        rng = np.random.default_rng(self.seed)
        n_variants = sum(self.sizes)
        courses = self._courses(rng)
        drift = rng.standard_normal((len(self.sizes), 3, _SHAPES))
        drift *= self.grading / np.sqrt(np.square(drift).mean(axis=(1, 2), keepdims=True))
        own = self.separation * rng.standard_normal((n_variants, 3, _SHAPES))
        success_rate = np.linspace(1.0, 0.1, max(self.behaviours) + 1)
        success_rate[list(self.stuck)] = 0.0
        noise = np.linspace(1.0, self.unevenness, max(self.behaviours) + 1)
        passed = self._passed()
        others = range(self.networks - 1)
        own_courses = [
            courses,
            *(self._courses(rng) if self.own_behaviours else courses for _ in others),
        ]
        first = np.cumsum([0, *self.sizes])
        places = [self._places(size) for size in self.sizes]
        parts: list[FloatArray] = []
        success: list[bool] = []
        for variant in range(n_variants):
            for trial in range(self.trials):
                network = trial % self.networks
                chances = passed[network, variant]
                # The draw decides nothing without a transition, and is then not made.
                draw = rng.random() if self.transition or self.network_shift else 0.5
                steady = self.steady_network and network == self.networks - 1
                run = 0 if steady else int((draw < chances).sum())
                behaviour = self.behaviours[run]
                place = places[run][np.clip(variant - first[run], 0, self.sizes[run] - 1)]
                course = own_courses[network][behaviour] + place * drift[run]
                if variant in self.outliers:
                    course = own[variant]
                stuck = behaviour in self.stuck
                parts.append(self._trial(course, noise[behaviour], stuck, rng))
                success.append(bool(rng.random() < success_rate[behaviour]))
        lengths = [part.shape[0] for part in parts]
        n_trials = len(parts)
        return Trials(
            parameters=("size_mm",),
            feature_names=("time_s", "sprawl_deg", "fbem_deg", "distance_mm"),
            variant=np.repeat(100.0 + 10.0 * np.arange(n_variants), self.trials)
            .astype(np.float64)
            .reshape(-1, 1),
            network=np.tile(np.arange(self.trials) % self.networks, n_variants).astype(np.int64),
            repetition=np.tile(np.arange(self.trials) // self.networks, n_variants).astype(
                np.int64
            ),
            success=np.asarray(success, dtype=np.bool_),
            starts=np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)[: n_trials + 1],
            features=np.concatenate(parts),
        )

    def _courses(self, rng: np.random.Generator) -> FloatArray:
        courses = rng.standard_normal((max(self.behaviours) + 1, 3, _SHAPES))
        return self.separation * _pushed_apart(courses)

    def _places(self, size: int) -> FloatArray:
        """Return how far behaviour has drifted on each variant of a run, −½ to ½."""
        even = np.linspace(-0.5, 0.5, size) if size > 1 else np.zeros(1)
        bend = (self.acceleration - 1.0) / (self.acceleration + 1.0)
        return even + bend * (np.square(even) - 0.25) * (size > 1)

    def _passed(self) -> FloatArray:
        """Return how probably trials are past each boundary, ``(network, variant, boundary)``."""
        variants = np.arange(sum(self.sizes))[:, None]
        boundaries = np.cumsum(self.sizes)[:-1] - 0.5
        places = np.linspace(-0.5, 0.5, self.networks) if self.networks > 1 else np.zeros(1)
        shift = self.network_shift * places[:, None, None]
        passed = 0.5 + (variants - boundaries - shift) / (self.transition + 1.0)
        return np.clip(passed, 0.0, 1.0)

    def _trial(
        self, course: FloatArray, loudness: float, stuck: bool, rng: np.random.Generator
    ) -> FloatArray:
        share = rng.uniform(0.7, 1.0)
        n_steps = int(self.steps * _TIME_LIMIT) if stuck else max(5, int(self.steps * share))
        time = np.arange(n_steps) / self.steps
        # A stuck robot gets half as far as it would in a trial of the drawn duration.
        moved = np.minimum(time, 0.5 * share) if stuck else time
        shapes = np.stack([moved, np.sin(np.pi * moved), np.sin(2.0 * np.pi * moved)])
        # One offset per trial, and noise along it with a memory of about ten steps.
        noise = rng.standard_normal((3, 1)) * 0.7 + 0.7 * _smooth_noise(rng, n_steps)
        if stuck:
            still = int(np.argmax(time >= moved[-1]))
            noise[:, still:] = noise[:, still, None] + _STILLNESS * (
                noise[:, still:] - noise[:, still, None]
            )
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
