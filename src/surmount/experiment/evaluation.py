"""A trained network tried on sizes of its obstacle, outside of any run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.experiment.origin import NO_CHANGES, course, home
from surmount.experiment.task_family import obstacle_family
from surmount.learn import Actor, RolloutConfig, Snapshot, roll_out
from surmount.rstar.course import Obstacle
from surmount.trials.trials import Trials
from surmount.workflow.monitor import Monitor


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """What a network was tried on, and how it went.

    Attributes
    ----------
    obstacle
        The family.
    cap_s
        Time after which a trial ends as failed, in s.
    trials
        Every trial, with its features at every decision.
    """

    obstacle: Obstacle
    cap_s: float
    trials: Trials


def evaluate_network(
    path: Path,
    config: RolloutConfig,
    *,
    obstacle: str | None = None,
    sizes_mm: Sequence[float] = (),
    changes: Mapping[str, Any] = NO_CHANGES,
    seed: int,
    monitor: Monitor,
) -> Evaluation:
    """Roll a network out from the fixed start pose (III-D).

    Parameters
    ----------
    path
        A ``network.safetensors``.
    config
        Repetitions and kind of action.
    obstacle
        Obstacle of a network that does not tell what it was trained on.
    sizes_mm
        Sizes in mm; all of the paper's variants if none are given.
    changes
        Overrides of the configuration, by dotted keys.
    seed
        Seed of environments and actions.
    monitor
        Shown how many trials have ended.

    Raises
    ------
    ConfigError
        If the obstacle is not known.
    InputError
        If the file is no network, does not fit the obstacle, or a size cannot be built.
    Interrupted
        If the monitor asked to stop.
    """
    run, _ = home(path)
    network = Snapshot.load(path)
    family, env_config = course(str(path), run=run, network=network, name=obstacle, changes=changes)
    tasks = obstacle_family(family.name, env_config)
    variants = _variants(family, sizes_mm) if sizes_mm else tasks.variants
    env = tasks.trial_env(len(variants) * config.repetitions)
    try:
        actor = Actor(network, env.single_observation_space, env.single_action_space)
        trials = roll_out(env, actor, variants, config, network=0, seed=seed, monitor=monitor)
    finally:
        env.close()
    return Evaluation(obstacle=family, cap_s=env_config.episode_s, trials=trials)


def _variants(obstacle: Obstacle, sizes_mm: Sequence[float]) -> FloatArray:
    sizes = np.asarray(sizes_mm, dtype=np.float64)
    outside = ~((sizes >= obstacle.lower) & (sizes <= obstacle.upper))
    if outside.any():
        raise InputError(
            f"{sizes[outside][0]:g} mm is no size of the {obstacle.name}.",
            remedy=f"Give sizes from {obstacle.lower:g} to {obstacle.upper:g} mm.",
        )
    return np.unique(sizes)[:, None]
