"""Discounted returns on a family's target tasks, to compare with those that were published."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.configuration import from_record
from surmount.core.errors import ConfigError, InputError
from surmount.core.reading import read_as
from surmount.core.records import read_record, write_record
from surmount.envs.vector_env import TaskVectorEnv
from surmount.experiment.stages import only
from surmount.experiment.task_part import family_and_settings
from surmount.learn.choice import make_actor
from surmount.learn.config import LearnerConfig
from surmount.learn.learner import TrialActor
from surmount.learn.snapshot import Snapshot
from surmount.workflow.graph import StageContext, StageKind
from surmount.workflow.monitor import Interrupted, Monitor
from surmount.workflow.run_layout import NETWORK_FILE
from surmount.workflow.store import Artefact

EPISODES = 100
"""Episodes on target tasks, as in CURROT's publication (P. Klink et al., ICML 2022)."""
RETURNS_FILE = "returns.json"


def discounted_returns(
    env: TaskVectorEnv,
    actor: TrialActor,
    tasks: FloatArray,
    *,
    discount: float,
    seed: int,
    monitor: Monitor,
) -> FloatArray:
    """Return Σ discountᵗ rₜ of one episode on each task, by the policy as it draws its actions.

    Parameters
    ----------
    env
        Environments without automatic reset, one per task.
    actor
        The network that acts.
    tasks
        Shape ``(task, parameter)``.
    discount
        γ per step.
    seed
        Of environments and actions.
    monitor
        Asked whether to stop.

    Returns
    -------
    FloatArray
        Shape ``(task,)``.

    Raises
    ------
    Interrupted
        If the monitor asked to stop.
    """
    act = actor.begin(len(tasks), np.random.default_rng(seed), deterministic=False)
    observations, _ = env.reset(seed=seed, options={"variant": tasks})
    running: BoolArray = np.ones(len(tasks), dtype=np.bool_)
    returns: FloatArray = np.zeros(len(tasks))
    weight = 1.0
    while running.any():
        if monitor.should_stop():
            raise Interrupted
        observations, rewards, terminated, truncated, _ = env.step(act(observations))
        returns += np.where(running, weight * rewards, 0.0)
        running &= ~(terminated | truncated)
        weight *= discount
    return returns


def measure_returns(context: StageContext) -> None:
    """Write the returns of a network on tasks drawn from its family's target."""
    family, settings = family_and_settings(context.config)
    target = family.target(settings)
    if target is None:
        raise ConfigError(
            f"`{family.name}` has no target tasks.", remedy='Let `towards` be "range".'
        )
    network = Snapshot.load(only(context, "network").path(NETWORK_FILE))
    learner = from_record(LearnerConfig, context.config["learner"])
    env = family.trial_env(settings, EPISODES)
    try:
        found = discounted_returns(
            env,
            make_actor(network, env.single_observation_space, env.single_action_space),
            target.sample(np.random.default_rng(context.seed), EPISODES),
            discount=learner.at_interval(env.step_s).discount,
            seed=context.seed,
            monitor=context.monitor,
        )
    finally:
        env.close()
    write_record(context.output / RETURNS_FILE, {"schema": 1, "returns": found.tolist()})


RETURNS = StageKind(name="study-returns", function=measure_returns)
"""Stages of the comparison that measure returns on target tasks."""


def mean_return(artefact: Artefact) -> float:
    """Return the mean return that a stage has measured."""
    return float(np.mean(_stored(artefact.path(RETURNS_FILE))))


def _stored(path: Path) -> list[float]:
    try:
        return read_as(list[float], read_record(path).get("returns"))
    except ValueError as error:
        raise InputError(
            f"{path} does not hold returns ({error}).", remedy="Delete the stage; it is run again."
        ) from error
