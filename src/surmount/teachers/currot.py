"""CURROT: particles that move to the target by optimal transport, where success allows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError
from surmount.core.seeds import generator
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.transport import matching, moved_towards


@dataclass(frozen=True, kw_only=True)
class CurrotConfig:
    """Curriculum by optimal transport (Klink et al. 2022)."""

    particles: int = 100
    """Tasks that stand for the distribution (the publication's value for the point mass)."""

    success_bound: float = 0.5
    """δ: estimated success that a particle keeps (assumed; the publication bounds the discounted
    return of the point mass, by 4)."""

    step_rms: float = 0.125
    """Root mean square of the particles' moves at an update, in ranges of the parameters (of the
    publication's bound of 0.5 on half the mean square, in a plane of width 8)."""

    update_episodes: int = 40
    """Episodes between two updates (its value for the point mass)."""

    bandwidth: float = 0.1
    """Standard deviation of the kernel by which success is estimated, in ranges of the parameters
    (assumed; the publication fits it)."""

    noise: float = 1e-3
    """Half width around a particle within which a task is drawn, in ranges (its value)."""

    def __post_init__(self) -> None:
        for name in ("success_bound", "step_rms", "bandwidth", "noise"):
            if not 0 < getattr(self, name) <= 1:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give a value above 0, at most 1."
                )
        for name in ("particles", "update_episodes"):
            if getattr(self, name) < 1:
                raise ConfigError(f"`{name}` is {getattr(self, name)}.", remedy="Give at least 1.")


class CurrotTeacher(AdaptiveTeacher):
    """Moves particles of tasks towards target tasks, each only as far as it succeeds.

    After P. Klink, H. Yang, C. D'Eramo, J. Peters and J. Pajarinen, "Curriculum reinforcement
    learning via constrained optimal transport" (ICML 2022). Every so many episodes, newly drawn
    target tasks are matched to the particles at the least sum of squared distances; each particle
    goes towards its own as far as a kernel estimate of success stays above δ and the mean move
    below its bound. Particles where success is estimated below δ first go to matched tasks that
    succeeded, of which those are kept that lie nearest to the target.

    Departures: performance is success instead of the discounted return; the matching is exact
    instead of by Sinkhorn iterations, and the program along the ways is solved by bisection instead
    of an interior-point method; success is estimated by kernels of one given width, from the kept
    successes and the failures among as many newest episodes as there are particles (older ones
    would bar the way for ever where success is all or nothing); and until
    something succeeds the particles stay spread over the range, where the publication searches
    around the better half of its returns.

    Parameters
    ----------
    whole_range
        The range of tasks, over which particles begin.
    target
        Tasks that are wanted in the end.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Bounds.
    """

    def __init__(
        self,
        whole_range: TaskDistribution,
        target: TaskDistribution,
        *,
        total_steps: int,
        seed: int,
        config: CurrotConfig,
    ) -> None:
        super().__init__(
            label="CURROT",
            tasks=[whole_range.to_record(), target.to_record()],
            total_steps=total_steps,
            seed=seed,
        )
        self._config = config
        self._target = target
        self._low = whole_range.lower.min(axis=0)
        self._extent = np.maximum(whole_range.upper.max(axis=0) - self._low, 1e-12)
        rng = generator(seed, "particles")
        self._particles = self._scaled(whole_range.sample(rng, config.particles))
        self._parameters = whole_range.parameters
        self._succeeded: FloatArray = np.empty((0, self._extent.size))
        self._newest: FloatArray = np.empty((0, self._extent.size + 1))
        self._new: list[tuple[list[float], float]] = []
        self._updates = 0

    @property
    def particles(self) -> FloatArray:
        """The particles in the parameters' units, ``(particle, parameter)``."""
        return self._low + self._extent * self._particles

    def distribution(self) -> TaskDistribution:
        """Return small boxes around the particles, all alike."""
        lower = np.clip(self._particles - self._config.noise, 0.0, 1.0)
        upper = np.clip(self._particles + self._config.noise, 0.0, 1.0)
        return TaskDistribution(
            parameters=self._parameters,
            weights=np.full(len(lower), 1.0 / len(lower)),
            lower=self._low + self._extent * lower,
            upper=self._low + self._extent * upper,
        )

    def take(self, episode: EndedEpisode) -> None:
        """Keep the episode, and move the particles once there are enough."""
        self._new.append((self._scaled(episode.task).tolist(), episode.progress))
        if len(self._new) >= self._config.update_episodes:
            self._update()
            self._updates += 1
            self._new = []

    def _scaled(self, tasks: FloatArray) -> FloatArray:
        return (tasks - self._low) / self._extent

    def _update(self) -> None:
        config = self._config
        tasks = np.array([task for task, _ in self._new])
        success = np.array([progress >= 1.0 for _, progress in self._new])
        rng = generator(self._seed, "target", self._updates)
        target = np.clip(self._scaled(self._target.sample(rng, config.particles)), 0.0, 1.0)
        succeeded = np.concatenate([tasks[success], self._succeeded])
        kept, _ = matching(succeeded, target)
        self._succeeded = succeeded[kept]
        newest = np.column_stack([tasks, success])
        self._newest = np.concatenate([newest, self._newest])[: config.particles]
        if not len(self._succeeded):
            return
        particles = self._particles.copy()
        lost = np.flatnonzero(self._estimate(particles) < config.success_bound)
        # There may be fewer successes than particles; then several go to the same one.
        while lost.size:
            rows, columns = matching(particles[lost], self._succeeded)
            particles[lost[rows]] = self._succeeded[columns]
            lost = np.delete(lost, rows)
        rows, columns = matching(particles, target)
        self._particles = moved_towards(
            particles[rows],
            target[columns],
            self._estimate,
            config.success_bound,
            config.step_rms,
        )

    def _estimate(self, points: FloatArray) -> FloatArray:
        """Return success around each point by kernels on the tasks that are kept, ``(point,)``."""
        failed = self._newest[self._newest[:, -1] == 0.0, :-1]
        known = np.concatenate([self._succeeded, failed])
        good = np.arange(len(known)) < len(self._succeeded)
        squared = np.square(points[:, None, :] - known[None, :, :]).sum(axis=2)
        # Relative to the nearest, so that far from all tasks it is the nearest one that counts.
        nearer = squared - squared.min(axis=1, keepdims=True)
        weight = np.exp(-nearer / (2.0 * self._config.bandwidth**2))
        return (weight @ good.astype(np.float64)) / weight.sum(axis=1)

    def _state(self) -> dict[str, Any]:
        return {
            "particles": self._particles.tolist(),
            "succeeded": self._succeeded.tolist(),
            "newest": self._newest.tolist(),
            "new": [[list(task), progress] for task, progress in self._new],
            "updates": self._updates,
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        size = self._extent.size
        for name, columns in (("particles", size), ("succeeded", size), ("newest", size + 1)):
            values = np.asarray(state[name], dtype=np.float64).reshape(-1, columns)
            setattr(self, f"_{name}", values)
        self._new = [
            ([float(value) for value in task], float(progress)) for task, progress in state["new"]
        ]
        self._updates = int(state["updates"])
