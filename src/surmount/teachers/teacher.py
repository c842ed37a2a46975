"""The seam between learning and curricula: what a teacher gives and takes.

A teacher gives a distribution of tasks to the environments, is told what each roll-out of the
learner brought, and says when it is finished. The learner knows teachers only through this
protocol, and a teacher knows nothing of the learner. A training loop without environments that
draw for themselves asks a teacher for tasks by ``sample`` and tells it of each episode by
``update_on_episode`` instead of ``update_on_rollout`` (docs/adr/0070).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import ConfigError
from surmount.tasks.distribution import TaskDistribution

Decision = Literal["advance", "extend", "advance at the limit"]
RewardMeasure = Literal["episode", "step"]
"""What r of eq. 5 is: the mean reward of episodes, or the sum of rewards of learning steps."""
Rule = Literal["first test", "ratio", "newest gain", "no gain"]
"""What decided a level test, see :attr:`LevelTest.rule`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Episodes:
    """Episodes that ended during a roll-out, in the order in which they ended.

    Attributes
    ----------
    step
        Learning step, counted over all environments together, at which each ended; ``(episode,)``.
    variant
        Task of each episode in the parameters' units, ``(episode, parameter)``.
    reward
        Sum of unnormalised rewards of each episode, ``(episode,)``.
    length
        Decisions in each episode, ``(episode,)``.
    success
        Whether each reached its goal, ``(episode,)``.
    diverged
        Whether each was ended because the physics diverged, ``(episode,)``.
    covered
        Share of the way to its goal that each covered, from 0 to 1, ``(episode,)``; ``None`` from
        environments that do not tell.
    """

    step: IntArray
    variant: FloatArray
    reward: FloatArray
    length: IntArray
    success: BoolArray
    diverged: BoolArray
    covered: FloatArray | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class RolloutOutcome:
    """What one roll-out of the learner brought.

    Attributes
    ----------
    rewards
        Unnormalised reward of every learning step in the order of time, ``(step,)``; with several
        environments, all environments of one moment stand together.
    episodes
        Episodes that ended in it.
    value_errors
        Mean magnitude of the generalised advantage over each episode's decisions, ``(episode,)``:
        how much the learner's critic erred on it. ``None`` from learners without a critic.
    steps_before
        Learning steps before the roll-out, on the count of ``episodes.step``.
    """

    rewards: FloatArray
    episodes: Episodes
    value_errors: FloatArray | None = None
    steps_before: int = 0


@dataclass(frozen=True, kw_only=True)
class LevelTest:
    """One test of a level by eq. 5: what was measured and what was decided.

    Attributes
    ----------
    level, iteration
        Counted from 0; iteration 0 is the level's first, of k steps, later ones are extensions.
    steps
        Learning steps since the teacher began.
    first_window, last_window
        rF and rL: r over the first and the last W learning steps of the newest iteration. By
        episodes, the mean of the unnormalised episode rewards, ``None`` where none ended; by
        steps, the sum of the unnormalised rewards of the W learning steps.
    first_gain
        rL − rF of the level's first iteration; ``None`` where it cannot be told.
    newest_gain
        rL − rF of the newest iteration; ``None`` where no episode ended in it, or both windows
        hold the same episodes.
    ratio
        ``newest_gain / first_gain``; ``None`` where the first gain is not above the floor, or
        either gain is ``None``.
    threshold
        The level is passed where the ratio is below it.
    decision
        What was decided.
    sentence
        The same for people.
    measure
        What r is. Records from before there was a choice have no entry: they are by steps.
    first_episodes, last_episodes
        Episodes whose rewards rF and rL are means of; ``None`` by steps.
    rule
        What decided. ``"first test"``: the first iteration is compared with itself, its ratio is 1
        and it never passes. ``"ratio"``: eq. 5. ``"newest gain"``: the first gain is not above
        the floor, and the level is passed where the newest is not either. ``"no gain"``: the
        newest gain cannot be told, and the level is extended. ``None`` in records from before
        rules were recorded, in which a first test whose gain was not above the floor passed.
    """

    level: int
    iteration: int
    steps: int
    first_window: float | None
    last_window: float | None
    first_gain: float | None
    newest_gain: float | None
    ratio: float | None
    threshold: float
    decision: Decision
    sentence: str
    measure: RewardMeasure = "step"
    first_episodes: int | None = None
    last_episodes: int | None = None
    rule: Rule | None = None


@dataclass(frozen=True, kw_only=True)
class TeacherStatus:
    """Where a teacher stands, for progress displays.

    Attributes
    ----------
    label
        For example ``"level 1 of 3, extension 2"``.
    steps, planned_steps
        Learning steps done, and planned as far as known; extensions are added when decided.
    level
        Level in force, counted from 1; ``None`` where there is none.
    steps_to_test
        Learning steps until the level is tested; ``None`` where none will be.
    steps_to_next_level
        Learning steps until the next level can begin at the earliest; ``None`` where none follows,
        or nobody can tell.
    """

    label: str
    steps: int
    planned_steps: int
    level: int | None = None
    steps_to_test: int | None = None
    steps_to_next_level: int | None = None


class Teacher(Protocol):
    """Gives task distributions, takes outcomes, decides when to go on and when to stop."""

    @property
    def finished(self) -> bool:
        """Whether training under this teacher is over."""
        ...

    def status(self) -> TeacherStatus:
        """Say where the teacher stands."""
        ...

    def distribution(self) -> TaskDistribution:
        """Return the distribution from which environments draw their next tasks."""
        ...

    def sample(self, k: int = 1) -> FloatArray:
        """Draw ``k`` tasks of :meth:`distribution`, shape ``(k, parameter)``.

        For loops that set each task themselves; environments that are given the distribution draw
        from it with generators of their own.
        """
        ...

    def update_on_episode(
        self,
        episode_return: float,
        length: int,
        task: FloatArray,
        progress: float,
        env_id: int | None = None,
        *,
        value_error: float | None = None,
        covered: float | None = None,
    ) -> None:
        """Take one episode that ended, in a loop that knows no roll-outs.

        Its decisions count as learning steps, and it ends with the last of them; where single
        rewards matter its return is taken to be spread evenly over them. A training tells a
        teacher of episodes or of roll-outs, never of both.

        Parameters
        ----------
        episode_return
            Sum of its unnormalised rewards.
        length
            Decisions in it.
        task
            Its task in the parameters' units, shape ``(parameter,)``.
        progress
            1 where it reached its goal, 0 where it did not, or a share in between.
        env_id
            Which environment it was in; no teacher here depends on it.
        value_error
            As one entry of :attr:`RolloutOutcome.value_errors`.
        covered
            As one entry of :attr:`Episodes.covered`.
        """
        ...

    def update_on_rollout(self, outcome: RolloutOutcome) -> LevelTest | None:
        """Take the outcome of a roll-out; return the level test made on it, if one was due.

        Its episodes are learnt from as if each had been given to :meth:`update_on_episode`; its
        rewards are the learning steps.
        """
        ...

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on later, as JSON values."""
        ...

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a state returned by :meth:`state_dict`.

        Raises
        ------
        InputError
            If it was saved by another teacher, or under another curriculum or other tasks.
        """
        ...


def require_unfinished(teacher: Teacher) -> None:
    """Refuse a teacher under which there is nothing to train.

    Raises
    ------
    ConfigError
        If it is finished.
    """
    if teacher.finished:
        steps = teacher.status().steps
        raise ConfigError(
            f"The teacher is finished already, after {steps:,} steps."
            if steps
            else "There is nothing to learn: the teacher's curriculum has no levels, or its "
            "steps are 0.",
            remedy="Train without it, or give another teacher, such as `surmount.UniformTeacher`.",
        )
