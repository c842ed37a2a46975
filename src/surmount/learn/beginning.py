"""What a teacher needs of a training in Stable-Baselines3, said before the first step."""

from __future__ import annotations

import warnings

from stable_baselines3.common.vec_env import VecEnv

from surmount.core.errors import ConfigError, InputError
from surmount.tasks.space import TaskSpace
from surmount.teachers.teacher import Teacher, TeacherStatus, require_unfinished


def require_beginning(teacher: Teacher, env: VecEnv, *, algorithm: str, has_critic: bool) -> None:
    """Refuse a training that cannot begin.

    Parameters
    ----------
    teacher
        The teacher.
    env
        The environments that learn.
    algorithm
        Name of the learner.
    has_critic
        Whether it estimates the advantages that value errors are taken from.

    Raises
    ------
    ConfigError
        If the teacher is finished, or needs a critic that the learner has not.
    InputError
        If the environments take no distribution, or have other task parameters than the teacher.
    """
    require_unfinished(teacher)
    if getattr(teacher, "needs_value_errors", False) and not has_critic:
        raise ConfigError(
            f"The teacher, {teacher.status().label}, needs a critic's value errors, and "
            f"{algorithm} estimates none.",
            remedy="Train by PPO, A2C or another algorithm with roll-outs, or choose another "
            "teacher.",
        )
    if not env.has_attr("set_task_distribution"):
        raise InputError(
            "The environments take no task distribution.",
            remedy="Wrap each in `surmount.TaskEnv` before it goes into the vector environment.",
        )
    for space in task_spaces(env):
        space.require_same(teacher.distribution())


def task_spaces(env: VecEnv) -> list[TaskSpace]:
    """Return the task spaces of environments, in this process; none where they do not tell."""
    told = env.get_attr("space") if env.has_attr("space") else []
    return [space for space in told if isinstance(space, TaskSpace)]


def warn_of_few_steps(status: TeacherStatus, steps: int, rollout_steps: int) -> None:
    """Warn where a level cannot be followed by the next within the steps given to ``learn``.

    Parameters
    ----------
    status
        Of the teacher.
    steps
        Given to ``learn``.
    rollout_steps
        Of one roll-out, over all environments: ``learn`` takes whole ones.
    """
    taken = -(-steps // rollout_steps) * rollout_steps
    needed = status.steps_to_next_level
    if needed is not None and taken < needed:
        warnings.warn(
            f"`learn` was given {steps:,} steps; level {status.level} is tested first after "
            f"{status.steps_to_test:,} and passes at the earliest after {needed:,}: it will not "
            "change in these. Give AdvancementConfig(iteration_steps=…), or more steps.",
            stacklevel=2,
        )
