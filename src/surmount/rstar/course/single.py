"""The obstacle courses as single Gymnasium environments: a batch of one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import Env
from gymnasium.vector import AutoresetMode

from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.infos import Infos
from surmount.rstar.course.observations import Observations
from surmount.rstar.course.pictures import RENDER_MODES
from surmount.tasks.distribution import TaskDistribution


class ObstacleEnv(Env[Observations, npt.NDArray[Any]]):
    """One course; observations, actions, rewards and endings as :class:`ObstacleVectorEnv`.

    Trajectories are bit-identical to those of the vector environment, whatever its size.

    Parameters
    ----------
    obstacle
        ``"narrow-channel"``, ``"low-entrance"`` or ``"step"``.
    config
        Configuration; the defaults if None.
    render_mode
        ``"rgb_array"``, ``"human"`` or None.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012  (as Gymnasium declares it)
        "render_modes": list(RENDER_MODES),
        "render_fps": 10,
    }

    def __init__(
        self, obstacle: str, *, config: EnvConfig | None = None, render_mode: str | None = None
    ) -> None:
        self._vector = ObstacleVectorEnv(
            obstacle,
            1,
            config=config,
            autoreset_mode=AutoresetMode.DISABLED,
            render_mode=render_mode,
        )
        self.render_mode = render_mode
        self.metadata = {
            **type(self).metadata,
            "render_fps": self._vector.metadata["render_fps"],
        }
        self.observation_space = self._vector.single_observation_space
        self.action_space = self._vector.single_action_space
        self.task_parameters: tuple[str, ...] = self._vector.task_parameters
        self.feature_names: tuple[str, ...] = self._vector.feature_names

    @property
    def vector(self) -> ObstacleVectorEnv:
        """The batch of one behind this environment."""
        return self._vector

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the variants of the next episodes from ``distribution``."""
        self._vector.set_task_distribution(distribution)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin an episode; see :meth:`ObstacleVectorEnv.reset`."""
        super().reset(seed=seed)
        observation, infos = self._vector.reset(
            seed=None if seed is None else [seed], options=options
        )
        self._np_random = self._vector.generator(0)
        return observation[0], _first(infos)

    def step(self, action: npt.ArrayLike) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Hold ``action`` of shape ``(3,)`` for a step."""
        observation, reward, terminated, truncated, infos = self._vector.step(
            np.asarray(action)[None]
        )
        return (
            observation[0],
            float(reward[0]),
            bool(terminated[0]),
            bool(truncated[0]),
            _first(infos),
        )

    def state_dict(self) -> dict[str, Any]:
        """Return all that is needed to go on bit-identically."""
        return self._vector.state_dict()

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from :meth:`state_dict`."""
        self._vector.load_state_dict(state)

    def render(self) -> Any:
        """Return a frame, or show it in a window."""
        frames = self._vector.render()
        return None if frames is None else frames[0]

    def close(self) -> None:
        """Release graphics."""
        self._vector.close()


def _first(infos: Infos) -> dict[str, Any]:
    """Return the infos of the only environment, without masks."""
    first = {key: value[0] for key, value in infos.items() if not key.startswith("_")}
    return {
        key: value.item() if isinstance(value, np.generic) else value.copy()
        for key, value in first.items()
    }
