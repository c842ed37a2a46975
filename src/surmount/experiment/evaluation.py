"""A trained network tried on variants of its task, outside of any run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.experiment.origin import NO_CHANGES, config_of, home
from surmount.learn.choice import make_actor
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import roll_out
from surmount.learn.snapshot import Snapshot
from surmount.tasks.space import TaskSpace
from surmount.trials.trials import Trials
from surmount.workflow.monitor import Monitor


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """What a network was tried on, and how it went.

    Attributes
    ----------
    task
        Name of the family.
    space
        Its task parameters.
    cap_s
        Time after which a trial ends as failed, in s.
    trials
        Every trial, with its features at every step.
    """

    task: str
    space: TaskSpace
    cap_s: float
    trials: Trials


def evaluate_network(
    path: Path,
    config: RolloutConfig,
    *,
    task: str | None = None,
    variants: Sequence[float | str] = (),
    changes: Mapping[str, Any] = NO_CHANGES,
    seed: int,
    monitor: Monitor,
) -> Evaluation:
    """Roll a network out as trials are (III-D).

    Parameters
    ----------
    path
        A ``network.safetensors``.
    config
        Repetitions and kind of action.
    task
        Family of tasks of a network that does not tell what it was trained on.
    variants
        Tasks in the parameters' units, categories by their names; with several parameters one
        value for each in turn; all variants of the family if none are given.
    changes
        Overrides of the configuration, by dotted keys.
    seed
        Seed of environments and actions.
    monitor
        Shown how many trials have ended.

    Raises
    ------
    ConfigError
        If the task is not known.
    InputError
        If the file is no network, does not fit the environment, or a variant cannot be built.
    Interrupted
        If the monitor asked to stop.
    """
    run, _ = home(path)
    network = Snapshot.load(path)
    chosen = config_of(str(path), run=run, network=network, task=task, changes=changes)
    family, settings = chosen.family, chosen.env
    space = family.space(settings)
    tried = np.unique(tasks_within(space, variants), axis=0) if variants else space.variants
    env = family.trial_env(settings, len(tried) * config.repetitions)
    try:
        actor = make_actor(network, env.single_observation_space, env.single_action_space)
        trials = roll_out(env, actor, tried, config, network=0, seed=seed, monitor=monitor)
    finally:
        env.close()
    return Evaluation(task=family.name, space=space, cap_s=family.cap_s(settings), trials=trials)


def tasks_within(space: TaskSpace, values: Sequence[float | str]) -> FloatArray:
    """Return tasks, ``(task, parameter)``, as a user writes them one value after the other.

    Raises
    ------
    InputError
        If a value is missing, is none of a parameter's names, or lies outside the range.
    """
    count = len(space.parameters)
    if len(values) % count:
        raise InputError(
            f"A variant has one value for each of {', '.join(space.parameters)}.",
            remedy=f"Give a multiple of {count} values.",
        )
    rows = [values[start : start + count] for start in range(0, len(values), count)]
    tasks = np.stack([space.task(row) for row in rows])
    outside = ~((tasks >= space.lower) & (tasks <= space.upper))
    if outside.any():
        task, parameter = np.argwhere(outside)[0]
        raise InputError(
            f"{tasks[task, parameter]:g} is no {space.parameters[parameter]} of this task.",
            remedy=f"Give values from {space.lower[parameter]:g} to {space.upper[parameter]:g}.",
        )
    return tasks
