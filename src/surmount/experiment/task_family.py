"""A family of tasks: what the protocol needs to know of environments and their parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from gymnasium.vector import AutoresetMode

from surmount.core.arrays import FloatArray
from surmount.core.configuration import Record, key_record
from surmount.core.errors import ConfigError
from surmount.core.tasks import TaskDistribution
from surmount.envs import EnvConfig, ObstacleVectorEnv, find_obstacle
from surmount.envs.scene import model_hash
from surmount.experiment.config import ExperimentConfig
from surmount.learn import TaskVectorEnv
from surmount.own import (
    TaskBatch,
    TaskEnv,
    is_own,
    load_make_env,
    make_task_env,
    source_hash,
    time_limit,
)


@dataclass(frozen=True, kw_only=True)
class TaskFamily:
    """Environments that differ in one or more task parameters.

    Attributes
    ----------
    whole_range
        Uniform over the continuous range of the parameters: initiation and control draw from it.
    variants
        The grid of variants for trials and tests, shape ``(variant, parameter)``.
    training_env
        Builds so many environments that reset themselves when an episode ends.
    trial_env
        Builds so many environments that stay as they are when an episode ends.
    cap_s
        Longest time an episode may take.
    harder
        For each parameter 1 where larger values are harder, −1 where smaller ones are; ``None``
        where nobody knows.
    """

    whole_range: TaskDistribution
    variants: FloatArray
    training_env: Callable[[int], TaskVectorEnv]
    trial_env: Callable[[int], TaskVectorEnv]
    cap_s: float
    harder: tuple[int, ...] | None


def obstacle_family(obstacle: str, config: EnvConfig) -> TaskFamily:
    """Return the variants of one of RSTAR's obstacles (paper III-C)."""
    course = find_obstacle(obstacle)
    parameters = (course.parameter,)

    def build(num_envs: int, mode: AutoresetMode) -> TaskVectorEnv:
        return ObstacleVectorEnv(
            obstacle, num_envs, config=config, n_threads=1, autoreset_mode=mode
        )  # stages run side by side (ADR 3)

    return TaskFamily(
        whole_range=TaskDistribution.uniform(
            parameters, np.array([course.lower]), np.array([course.upper])
        ),
        variants=course.variants[:, None],
        training_env=lambda num_envs: build(num_envs, AutoresetMode.SAME_STEP),
        trial_env=lambda num_envs: build(num_envs, AutoresetMode.DISABLED),
        cap_s=config.episode_s,
        harder=(course.harder,),
    )


def own_family(name: str, sha256: str) -> TaskFamily:
    """Return the task family of somebody's own environment.

    Parameters
    ----------
    name
        ``module:function``.
    sha256
        Hash of the module's file when the experiment was begun.

    Raises
    ------
    ConfigError
        If the file has changed since, or there is no time limit.
    InputError
        If the function needs arguments, fails, or returns no :class:`surmount.own.TaskEnv`.
    """
    make_env = load_make_env(name)
    if source_hash(name) != sha256:
        raise ConfigError(
            f"The file of `{name}` has changed since this run began.",
            remedy="Choose another --out folder: results of two versions must not be mixed.",
        )

    def made() -> TaskEnv:
        return make_task_env(make_env)

    env = made()
    space, cap_s = env.space, time_limit(env) * env.decision_s
    env.close()
    return TaskFamily(
        whole_range=space.whole_range,
        variants=space.variants,
        training_env=lambda num_envs: TaskBatch(made, num_envs),
        trial_env=lambda num_envs: TaskBatch(made, num_envs, autoreset=False),
        cap_s=cap_s,
        harder=space.harder,
    )


def task_family(task: str, config: EnvConfig, own_sha256: str = "") -> TaskFamily:
    """Return the family of one of RSTAR's obstacles, or of somebody's own environment."""
    return own_family(task, own_sha256) if is_own(task) else obstacle_family(task, config)


def task_part(config: ExperimentConfig) -> Record:
    """Return what the environments of an experiment depend on: settings, and model or source."""
    record = key_record(config)
    source = (
        {"own_sha256": config.own_sha256}
        if is_own(config.obstacle)
        else {"model_sha256": model_hash(find_obstacle(config.obstacle), config.env)}
    )
    return {"obstacle": record["obstacle"], "env": record["env"], **source}
