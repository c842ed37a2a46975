"""Self-paced learning: a Gaussian of tasks that moves to its target as fast as success allows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError
from surmount.core.seeds import generator
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.unit_box import UnitBox, require_distances
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.points import points_within


@dataclass(frozen=True, kw_only=True)
class SelfPacedConfig:
    """Self-paced deep reinforcement learning (Klink et al. 2020, 2021)."""

    success_bound: float = 0.5
    """V_LB: expected success below which the distribution returns to easier tasks (assumed)."""

    step_bound: float = 0.05
    """ε: largest divergence in nats between one distribution and the next (the publications'
    value in most experiments)."""

    update_episodes: int = 50
    """Episodes between two updates (assumed)."""

    smallest_deviation: float = 0.02
    """Lower bound of the standard deviations, as a share of the range (assumed)."""

    points: int = 256
    """Tasks drawn for each distribution that is pushed (assumed)."""

    def __post_init__(self) -> None:
        for name in ("success_bound", "step_bound", "smallest_deviation"):
            if not 0 < getattr(self, name) <= 1:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give a value above 0, at most 1."
                )
        for name, least in (("update_episodes", 2), ("points", 1)):
            if getattr(self, name) < least:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy=f"Give at least {least}."
                )


class SelfPacedTeacher(AdaptiveTeacher):
    """Moves a Gaussian from the easy group to the whole range, keeping success above a bound.

    After P. Klink, C. D'Eramo, J. Peters and J. Pajarinen, "Self-paced deep reinforcement
    learning" (NeurIPS 2020), in the form of P. Klink et al., "A probabilistic interpretation of
    self-paced learning with applications to reinforcement learning" (JMLR 2021): minimise
    KL(p ‖ target) such that the expected performance, estimated by importance weights from the
    newest episodes, stays above V_LB and KL(p ‖ p_before) below ε; where performance is below
    V_LB, raise it within ε instead. Performance is success here, and covariances are diagonal.

    Tasks are drawn from the Gaussian cut off at the range, while weights and divergences are those
    of the whole Gaussian, and every episode counts as drawn from the newest one. The target is a
    Gaussian too, so the ends of the range are practised less than its middle even at the end. Where
    no episode succeeds the Gaussian stays: no direction is better.

    Parameters
    ----------
    whole_range
        The range of tasks. The target has the mean and deviation of the uniform distribution on it.
        Gaussians lie on the scale of its axes; categories have no distances and are refused.
    begin
        Distribution to begin with, for example that of the easy group: its mean and deviation
        count.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Bounds.
    """

    def __init__(
        self,
        whole_range: TaskDistribution,
        begin: TaskDistribution,
        *,
        total_steps: int,
        seed: int,
        config: SelfPacedConfig,
    ) -> None:
        require_distances(whole_range.axes, whole_range.parameters, "Self-paced learning")
        super().__init__(
            label="self-paced",
            tasks=[whole_range.to_record(), begin.to_record()],
            total_steps=total_steps,
            seed=seed,
        )
        self._config = config
        self._parameters = whole_range.parameters
        self._axes = whole_range.axes
        self._box = UnitBox(whole_range)
        self._target = self._moments(whole_range)
        self._now = self._moments(begin)
        self._updates = 0
        self._tasks: list[list[float]] = []
        self._success: list[float] = []

    @property
    def mean(self) -> FloatArray:
        """Mean of the Gaussian in the parameters' units, ``(parameter,)``."""
        return self._box.tasks(self._now[None, : self._box.size])[0]

    @property
    def deviation(self) -> FloatArray:
        """Standard deviations on the scale of each axis, ``(parameter,)``.

        Of a continuous axis in its units, of a logarithmic one in its natural logarithm.
        """
        return self._box.extent * np.exp(self._now[self._box.size :])

    def distribution(self) -> TaskDistribution:
        """Return tasks drawn from the Gaussian within the range."""
        rng = generator(self._seed, "points", self._updates)
        mean, deviation = self._now[: self._box.size], np.exp(self._now[self._box.size :])

        def draw(size: int) -> FloatArray:
            return mean + deviation * rng.standard_normal((size, mean.size))

        points = self._box.tasks(points_within(draw, self._config.points, rng))
        return TaskDistribution(
            parameters=self._parameters,
            weights=np.full(len(points), 1.0 / len(points)),
            lower=points,
            upper=points,
            axes=self._axes,
        )

    def take(self, episode: EndedEpisode) -> None:
        """Keep the episode, and move the Gaussian once there are enough."""
        self._tasks.append(self._box.places(episode.task[None])[0].tolist())
        self._success.append(episode.progress)
        if len(self._success) >= self._config.update_episodes:
            tasks, success = np.asarray(self._tasks), np.asarray(self._success)
            self._now = self_paced_step(self._now, self._target, tasks, success, self._config)
            self._updates += 1
            self._tasks, self._success = [], []

    def _moments(self, distribution: TaskDistribution) -> FloatArray:
        """Return mean and logarithm of the deviation in units of the range, one after the other."""
        lower, upper = self._box.sides(distribution)
        weights = distribution.weights[:, None]
        mean = (weights * (lower + upper) / 2).sum(axis=0)
        square = (weights * (lower**2 + lower * upper + upper**2) / 3).sum(axis=0)
        deviation = np.sqrt(np.maximum(square - mean**2, self._config.smallest_deviation**2))
        return np.concatenate([mean, np.log(deviation)])

    def _state(self) -> dict[str, Any]:
        return {
            "now": self._now.tolist(),
            "updates": self._updates,
            "tasks": [list(task) for task in self._tasks],
            "success": list(self._success),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._now = np.asarray(state["now"], dtype=np.float64)
        self._updates = int(state["updates"])
        self._tasks = [[float(value) for value in task] for task in state["tasks"]]
        self._success = [float(value) for value in state["success"]]


def divergence(first: FloatArray, second: FloatArray) -> float:
    """Return KL(first ‖ second) in nats of Gaussians with diagonal covariances.

    Parameters
    ----------
    first, second
        Means and, after them, logarithms of the deviations, shape ``(2 * parameter,)``.
    """
    size = first.size // 2
    gap = (first[:size] - second[:size]) ** 2 + np.exp(2 * first[size:])
    return float((second[size:] - first[size:] + gap / (2 * np.exp(2 * second[size:])) - 0.5).sum())


def self_paced_step(
    now: FloatArray,
    target: FloatArray,
    tasks: FloatArray,
    success: FloatArray,
    config: SelfPacedConfig,
) -> FloatArray:
    """Return the next Gaussian.

    Parameters
    ----------
    now, target
        As in :func:`divergence`, in units of the range.
    tasks, success
        Episodes drawn from ``now``, shapes ``(episode, parameter)`` and ``(episode,)``.
    config
        Bounds.
    """
    from scipy.optimize import minimize  # noqa: PLC0415 - slow; not for a list of teachers

    size = now.size // 2

    def expected(candidate: FloatArray) -> float:
        ratio = _log_density(candidate, tasks) - _log_density(now, tasks)
        return float((np.exp(np.minimum(ratio, 50.0)) * success).mean())

    bounds = [(0.0, 1.0)] * size + [(np.log(config.smallest_deviation), 0.0)] * size
    near = {"type": "ineq", "fun": lambda candidate: config.step_bound - divergence(candidate, now)}
    if success.mean() >= config.success_bound:
        enough = {"type": "ineq", "fun": lambda c: expected(c) - config.success_bound}
        found = minimize(
            lambda candidate: divergence(candidate, target),
            now,
            method="SLSQP",
            bounds=bounds,
            constraints=[near, enough],
        )
    elif success.any():
        found = minimize(
            lambda candidate: -expected(candidate),
            now,
            method="SLSQP",
            bounds=bounds,
            constraints=[near],
        )
    else:
        return now  # nothing succeeded: no direction is better
    within = divergence(found.x, now) <= 1.05 * config.step_bound
    return np.asarray(found.x) if within and np.isfinite(found.x).all() else now


def _log_density(gaussian: FloatArray, tasks: FloatArray) -> FloatArray:
    size = gaussian.size // 2
    white = (tasks - gaussian[:size]) / np.exp(gaussian[size:])
    return -(white**2).sum(axis=1) / 2 - float(gaussian[size:].sum())
