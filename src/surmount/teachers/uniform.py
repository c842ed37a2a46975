"""The teacher without a curriculum: one fixed distribution for a fixed number of steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surmount.core.arrays import FloatArray
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.draws import Draws
from surmount.teachers.state import belongs_to, require_same
from surmount.teachers.teacher import RolloutOutcome, TeacherStatus

_NAME = "one distribution"


class UniformTeacher:
    """Initiation and the paper's control: uniform variants throughout (III-C).

    Parameters
    ----------
    distribution
        What environments draw from, usually uniform over the whole range of the task parameters.
    total_steps
        Learning steps to train, over all environments. Training ends with the first roll-out
        that reaches it.
    label
        Name for displays.
    seed
        Of :meth:`sample`.
    """

    def __init__(
        self,
        distribution: TaskDistribution,
        total_steps: int,
        *,
        label: str = "uniform",
        seed: int = 0,
    ) -> None:
        self._distribution = distribution
        self._total_steps = total_steps
        self._label = label
        self._steps = 0
        self._draws = Draws(seed)

    @property
    def finished(self) -> bool:
        """Whether the steps are used up."""
        return self._steps >= self._total_steps

    def status(self) -> TeacherStatus:
        """Say where the teacher stands."""
        return TeacherStatus(label=self._label, steps=self._steps, planned_steps=self._total_steps)

    def distribution(self) -> TaskDistribution:
        """Return the fixed distribution."""
        return self._distribution

    def sample(self, k: int = 1) -> FloatArray:
        """Draw tasks, shape ``(k, parameter)``."""
        return self._draws.draw(self._distribution, k)

    def update_on_episode(
        self,
        episode_return: float,
        length: int,
        task: FloatArray,
        progress: float,
        env_id: int | None = None,
        *,
        value_error: float | None = None,
    ) -> None:
        """Count the decisions."""
        self._steps += length

    def update_on_rollout(self, outcome: RolloutOutcome) -> None:
        """Count the steps."""
        self._steps += outcome.rewards.size

    def state_dict(self) -> dict[str, Any]:
        """Return the steps done and the draws made by hand."""
        return {
            **belongs_to(_NAME, self._distribution.to_record()),
            "steps": self._steps,
            "draws": self._draws.calls,
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from the steps done."""
        require_same(state, _NAME, self._distribution.to_record())
        self._steps = int(state["steps"])
        self._draws.calls = int(state.get("draws", 0))
