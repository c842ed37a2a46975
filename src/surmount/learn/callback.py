"""A teacher in one's own Stable-Baselines3 script, as a callback."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any, cast

import numpy as np
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

from surmount.core.errors import InputError
from surmount.core.printing import say
from surmount.core.records import read_record, write_record
from surmount.learn.beginning import require_beginning, task_spaces, warn_of_few_steps
from surmount.learn.curriculum_log import log_curriculum, variant_regions
from surmount.learn.episode_recorder import EpisodeRecorder
from surmount.tasks.regions import Regions
from surmount.teachers.teacher import Episodes, LevelTest, Teacher


class TeacherCallback(BaseCallback):
    """Pushes a teacher's distributions to the environments and tells it what came of them.

    Environments take them by ``set_task_distribution`` and say ``variant`` and ``is_success`` in
    their infos, as :class:`surmount.TaskEnv` does. Training ends when the teacher is finished,
    at the latest after the steps given to ``learn``. Rewards are taken before ``VecNormalize``.
    Several calls of ``learn`` with the same callback go on with each other's episodes, as far as
    ``learn`` itself does (``reset_num_timesteps=False``). Too few steps for any level to change,
    and episodes that diverge, are warned of, once.

    Parameters
    ----------
    teacher
        The teacher.
    regions
        Parts of the space of tasks whose weight and success are logged, such as the groups of a
        curriculum; by default the variants of :class:`surmount.TaskEnv`, up to
        :data:`surmount.learn.curriculum_log.MOST_REGIONS` of them.
    update_steps
        Learning steps between two updates of the teacher with learners without roll-outs, such as
        SAC; the others update it after every roll-out.
    verbose
        1 prints the sentence of every level test.

    Raises
    ------
    ConfigError
        From ``learn``, if the teacher is finished before training begins, or needs a critic that
        the learner has not.
    InputError
        From ``learn``, if the environments take no distribution, have other task parameters than
        the teacher, or do not say what came of it.
    """

    def __init__(
        self,
        teacher: Teacher,
        *,
        regions: Regions | None = None,
        update_steps: int = 1000,
        verbose: int = 0,
    ) -> None:
        super().__init__(verbose)
        self.teacher = teacher
        self.tests: list[LevelTest] = []
        self._regions = regions
        self._update_steps = update_steps
        self._begun = False
        self._has_diverged = False
        self._left_with: tuple[VecEnv, Any] | None = None

    def save(self, path: Path | str) -> None:
        """Write the teacher's progress as JSON, to keep beside the saved model."""
        write_record(Path(path), self.teacher.state_dict())

    def load(self, path: Path | str) -> None:
        """Go on from saved progress."""
        self.teacher.load_state_dict(read_record(Path(path)))

    def _on_training_start(self) -> None:
        require_beginning(
            self.teacher,
            self.training_env,
            algorithm=type(self.model).__name__,
            has_critic=self._rollout_buffer() is not None,
        )
        if self._goes_on():
            self._push()
        else:
            self._begin()

    def _on_step(self) -> bool:
        normaliser = self.model.get_vec_normalize_env()
        rewards = (
            np.asarray(self.locals["rewards"])
            if normaliser is None
            else normaliser.get_original_reward()
        )
        self._record.add(rewards)
        for env in np.flatnonzero(self.locals["dones"]):
            self._end_episode(int(env), self.locals["infos"][env])
        return not self.teacher.finished

    def _on_rollout_end(self) -> None:
        buffer = self._rollout_buffer()
        steps = self._record.recorded_steps
        if steps == 0 or (buffer is None and steps < self._update_steps):
            return
        self._tell(None if buffer is None else buffer.advantages)

    def _on_training_end(self) -> None:
        left = self._record.recorded_steps > 0 and not self.teacher.finished
        if left and self._rollout_buffer() is None:
            self._tell(None)
        # A roll-out that was broken off is told to nobody, and its episodes are begun again.
        whole = self._record.recorded_steps == 0
        self._left_with = (self.training_env, self._model._last_obs) if whole else None  # noqa: SLF001

    @property
    def _model(self) -> Any:
        """The model, of which this sets and reads what `learn` itself does."""
        return cast("Any", self.model)

    def _goes_on(self) -> bool:
        """Tell whether `learn` goes on with the episodes that it left last time."""
        if self._left_with is None or self._record.steps != self.num_timesteps:
            return False
        env, observation = self._left_with
        return env is self.training_env and observation is self._model._last_obs  # noqa: SLF001

    def _begin(self) -> None:
        """Begin all episodes: `learn` has begun them before it told anyone of tasks to push."""
        env, model = self.training_env, self._model
        self._warn_of_few_steps()
        spaces = task_spaces(env)
        self._logged = self._regions or (variant_regions(spaces[0]) if spaces else None)
        parameters = len(self.teacher.distribution().parameters)
        self._record = EpisodeRecorder(env.num_envs, parameters, steps=self.num_timesteps)
        self._push()
        model._last_obs = env.reset()  # noqa: SLF001
        model._last_episode_starts = np.ones(env.num_envs, dtype=np.bool_)  # noqa: SLF001
        normaliser = self.model.get_vec_normalize_env()
        if normaliser is not None:
            model._last_original_obs = normaliser.get_original_obs()  # noqa: SLF001

    def _warn_of_few_steps(self) -> None:
        """Warn once: further calls of `learn` may bring the steps that are missing."""
        if not self._begun:
            buffer = self._rollout_buffer()
            steps = self.locals["total_timesteps"] - self.num_timesteps
            rollout_steps = 1 if buffer is None else buffer.buffer_size * buffer.n_envs
            warn_of_few_steps(self.teacher.status(), steps, rollout_steps)
        self._begun = True

    def _warn_of_divergence(self, episodes: Episodes) -> None:
        """Warn once; from then on the logger tells how many there are."""
        diverged = int(episodes.diverged.sum())
        if diverged and not self._has_diverged:
            self._has_diverged = True
            warnings.warn(
                f"{diverged} of {episodes.diverged.size} episodes of a roll-out diverged: an "
                "observation or a reward was not finite, and the episode ended there with a reward "
                "of 0. `curriculum/diverged` logs the share. Try the environment with "
                "`surmount check`.",
                stacklevel=2,
            )

    def _rollout_buffer(self) -> RolloutBuffer | None:
        """Return the roll-out of a learner with a critic that estimates advantages."""
        buffer = getattr(self.model, "rollout_buffer", None)
        return buffer if isinstance(buffer, RolloutBuffer) else None

    def _tell(self, advantages: np.ndarray | None) -> None:
        """Tell the teacher what was recorded, and environments and logs what it makes of it."""
        outcome = self._record.collect(advantages)
        self._warn_of_divergence(outcome.episodes)
        test = self.teacher.update_on_rollout(outcome)
        if test is not None:
            self.tests.append(test)
            if self.verbose:
                say(test.sentence)
        log_curriculum(
            self.logger,
            distribution=None if self.teacher.finished else self.teacher.distribution(),
            outcome=outcome,
            test=test,
            regions=self._logged,
            status=self.teacher.status(),
        )
        self._push()

    def _push(self) -> None:
        if not self.teacher.finished:
            distribution = self.teacher.distribution()
            self.training_env.env_method("set_task_distribution", distribution)

    def _end_episode(self, env: int, info: dict[str, Any]) -> None:
        for key in ("variant", "is_success"):
            if key not in info:
                raise InputError(
                    f"The infos of an ended episode hold no `{key}`.",
                    remedy="Wrap each environment in `surmount.TaskEnv`.",
                )
        self._record.end(
            env,
            variant=info["variant"],
            success=bool(info["is_success"]),
            diverged=bool(info.get("diverged", False)),
        )
