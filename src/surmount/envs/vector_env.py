"""What training and roll-outs need of many environments at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.axis import Axes, full_axes
from surmount.tasks.distribution import TaskDistribution

Infos = dict[str, Any]


def task_axes(env: TaskVectorEnv) -> Axes:
    """Return the axes of the task parameters; all are continuous where the environment has none."""
    return full_axes(getattr(env, "task_axes", ()), env.task_parameters)


class TaskVectorEnv(Protocol):
    """A Gymnasium vector environment whose tasks are drawn inside ``reset``.

    It resets an environment in the same step in which its episode ended
    (``AutoresetMode.SAME_STEP``) and puts ``variant``, ``is_success``, ``diverged`` and
    ``features`` into its infos, one row per environment. A step takes ``step_s``.
    One with axes that are not continuous has them as ``task_axes``, see :func:`task_axes`.
    """

    task_parameters: tuple[str, ...]
    feature_names: tuple[str, ...]
    num_envs: int
    step_s: float
    render_mode: str | None

    @property
    def single_observation_space(self) -> Any:
        """Observations of one environment, a space of Gymnasium."""
        ...

    @property
    def single_action_space(self) -> Any:
        """Actions of one environment, a space of Gymnasium."""
        ...

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the tasks of coming episodes from another distribution."""
        ...

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, Infos]:
        """Begin an episode in every environment."""
        ...

    def step(self, actions: Any) -> tuple[Any, FloatArray, BoolArray, BoolArray, Infos]:
        """Take one step in every environment."""
        ...

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on bit-identically."""
        ...

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        ...

    def close(self) -> None:
        """Release resources."""
        ...
