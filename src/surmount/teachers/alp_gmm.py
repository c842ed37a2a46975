"""ALP-GMM: practise where the return changes, found by mixtures of Gaussians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.fitting import fit_mixture
from surmount.analysis.mixture import Mixture
from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError
from surmount.core.seeds import derive_seed, generator
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.points import points_within
from surmount.teachers.shares import require_shares

_FIT = AnalysisConfig(restarts=2, max_iterations=50)
_EPISODES_BEFORE_PROGRESS = 5
"""Episodes that are remembered with no progress, before nearest ones mean anything (the authors'
code has more than 5 too)."""


@dataclass(frozen=True, kw_only=True)
class AlpGmmConfig:
    """Absolute learning progress by Gaussian mixtures (Portelas et al. 2019)."""

    fit_episodes: int = 250
    """N: episodes between two fits, length of the window they are made on, and of the uniform
    beginning (the publication's value)."""

    max_components: int = 10
    """Largest number of Gaussians tried; the smallest is 2 (the publication's values)."""

    uniform_share: float = 0.2
    """p_rnd: share of tasks drawn uniformly (the publication's value)."""

    points: int = 256
    """Tasks drawn from the mixture for each distribution that is pushed; a roll-out begins far
    fewer episodes (assumed)."""

    def __post_init__(self) -> None:
        require_shares(self)
        for name, least in (("fit_episodes", 10), ("max_components", 2), ("points", 1)):
            if getattr(self, name) < least:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy=f"Give at least {least}."
                )


class AlpGmmTeacher(AdaptiveTeacher):
    """Draws tasks from Gaussians chosen by their mean absolute learning progress.

    After R. Portelas, C. Colas, K. Hofmann and P.-Y. Oudeyer, "Teacher algorithms for curriculum
    learning of deep RL in continuously parameterized environments" (CoRL 2019). The absolute
    learning progress of an episode is the difference between its return and that of the episode
    nearest in task space among all before it; the first six have none. Every N episodes, mixtures
    of 2 to ``max_components`` Gaussians are fitted to the pairs of task and progress of the newest
    N, and the one with the lowest AIC is kept; a Gaussian is drawn in proportion to its mean
    progress, and a task from its marginal. Tasks outside the range are drawn again (the authors'
    code moves them to its edge).

    Parameters
    ----------
    whole_range
        The range of tasks; uniform tasks are drawn from it.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Window, components and uniform share.
    """

    def __init__(
        self,
        whole_range: TaskDistribution,
        *,
        total_steps: int,
        seed: int,
        config: AlpGmmConfig,
    ) -> None:
        super().__init__(
            label="ALP-GMM", tasks=whole_range.to_record(), total_steps=total_steps, seed=seed
        )
        self._whole = whole_range
        self._low = whole_range.lower.min(axis=0)
        self._extent = np.maximum(whole_range.upper.max(axis=0) - self._low, 1e-12)
        self._config = config
        self._tasks: FloatArray = np.empty((0, self._extent.size))
        self._returns: list[float] = []
        self._progress: list[float] = []
        self._mixture: Mixture | None = None

    def distribution(self) -> TaskDistribution:
        """Return tasks newly drawn from the mixture, beside the uniform share."""
        if self._mixture is None:
            return self._whole
        rng = generator(self._seed, "points", len(self._returns))
        weights, parts = self._gaussians(self._mixture)

        def draw(size: int) -> FloatArray:
            chosen = rng.choice(weights.size, size=size, p=weights)
            noise = rng.standard_normal((size, self._extent.size))
            means, factors = parts
            return means[chosen] + np.einsum("nij,nj->ni", factors[chosen], noise)

        points = self._low + self._extent * points_within(draw, self._config.points, rng)
        share = self._config.uniform_share
        drawn = np.full(len(points), (1.0 - share) / len(points))
        return TaskDistribution(
            parameters=self._whole.parameters,
            weights=np.concatenate([share * self._whole.weights, drawn]),
            lower=np.concatenate([self._whole.lower, points]),
            upper=np.concatenate([self._whole.upper, points]),
        )

    def take(self, episode: EndedEpisode) -> None:
        """Compute the episode's progress, and fit anew every N episodes."""
        place = (episode.task - self._low) / self._extent
        if len(self._returns) > _EPISODES_BEFORE_PROGRESS:
            distance = np.square(self._tasks - place).sum(axis=1)
            before = self._returns[int(distance.argmin())]
            self._progress.append(abs(episode.episode_return - before))
        else:
            self._progress.append(0.0)
        self._tasks = np.concatenate([self._tasks, place[None]])
        self._returns.append(episode.episode_return)
        if len(self._returns) % self._config.fit_episodes == 0:
            self._mixture = self._fit()

    def _fit(self) -> Mixture | None:
        window = self._config.fit_episodes
        progress = np.asarray(self._progress[-window:])
        pairs = np.column_stack([self._tasks[-window:], progress])
        if not (np.ptp(pairs, axis=0) > 0).all():
            return None  # nothing changes anywhere: all tasks are alike
        seed = derive_seed(self._seed, "fit", len(self._returns))
        fits = [
            fit_mixture(pairs, components, seed=seed, config=_FIT)
            for components in range(2, self._config.max_components + 1)
        ]
        return min(fits, key=_aic)

    def _gaussians(self, mixture: Mixture) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
        """Return each Gaussian's probability, and means and Cholesky factors of its marginal."""
        progress = np.maximum(mixture.means[:, -1], 0.0)
        weights = progress if progress.sum() > 0 else np.ones_like(progress)
        factors = np.linalg.cholesky(mixture.covariances[:, :-1, :-1]).astype(np.float64)
        return weights / weights.sum(), (mixture.means[:, :-1], factors)

    def _state(self) -> dict[str, Any]:
        return {
            "tasks": self._tasks.tolist(),
            "returns": list(self._returns),
            "progress": list(self._progress),
            "mixture": None if self._mixture is None else self._mixture.to_record(),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._tasks = np.asarray(state["tasks"], dtype=np.float64).reshape(-1, self._extent.size)
        self._returns = [float(value) for value in state["returns"]]
        self._progress = [float(value) for value in state["progress"]]
        mixture = state["mixture"]
        self._mixture = None if mixture is None else Mixture.from_record(mixture)


def _aic(mixture: Mixture) -> float:
    if mixture.fit is None:
        raise ValueError("The mixture was not fitted.")
    return 2.0 * mixture.n_parameters - 2.0 * mixture.fit.log_likelihood
