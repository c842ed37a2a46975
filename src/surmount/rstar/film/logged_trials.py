"""Logged trials as motions: simulated again where their run is at hand, else drawn from the log."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.configuration import from_record
from surmount.core.errors import InputError
from surmount.experiment import kinds
from surmount.experiment.config import config_from_record
from surmount.experiment.protocol import protocol
from surmount.experiment.stages import FIRST
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.snapshot import Snapshot
from surmount.rstar.configured import obstacle_of
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.measures import FEATURE_NAMES
from surmount.rstar.course.obstacles import Obstacle
from surmount.rstar.film.motion import Motion, record_motion
from surmount.rstar.film.policy_pilot import PolicyPilot
from surmount.rstar.film.replay import CAPTION, logged_features, replay_log
from surmount.trials.trials import Trials
from surmount.workflow.graph import Stage
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import NETWORK_FILE


@dataclass(frozen=True, kw_only=True, eq=False)
class Log:
    """A table of trials on one of RSTAR's obstacles.

    Attributes
    ----------
    source
        How errors name the table.
    trials
        The trials.
    obstacle, config
        Family and configuration.
    run, stage
        The run and the name of its stage that wrote the table, where known.
    """

    source: str
    trials: Trials
    obstacle: Obstacle
    config: EnvConfig
    run: RunFolder | None = None
    stage: str = ""

    @property
    def sizes_mm(self) -> FloatArray:
        """Sizes with trials, ascending, shape ``(variant,)``."""
        return self.trials.variants()[0][:, 0]

    def find(self, size_mm: float, repetition: int, network: int | None) -> int:
        """Return the index of a trial; of the first network if none is named.

        Raises
        ------
        InputError
            If there is no such trial.
        """
        trials = self.trials
        wanted = int(trials.network.min()) if network is None else network
        found = np.isclose(trials.variant[:, 0], size_mm, rtol=0.0, atol=1e-9)
        found &= (trials.repetition == repetition) & (trials.network == wanted)
        if not found.any():
            sizes, numbers = self.sizes_mm, np.unique(trials.repetition)
            raise InputError(
                f"{self.source} has no trial {repetition} of network {wanted} on {size_mm:g} mm.",
                remedy=f"It holds {sizes.size} sizes from {sizes[0]:g} to {sizes[-1]:g} mm, trials "
                f"{numbers[0]} to {numbers[-1]}, networks "
                f"{', '.join(map(str, np.unique(trials.network).tolist()))}.",
            )
        return int(found.argmax())


def logged_motion(log: Log, trial: int) -> Motion:
    """Return the motion of a logged trial.

    A trial of a run is simulated again, with the same network, seed and noise. It is shown if its
    features equal the log to the last bit; older logs hold the distance in the horizontal plane,
    and theirs is compared with that. Other trials are drawn from the log, and the caption says so.

    Parameters
    ----------
    log
        The table.
    trial
        Index of a trial in it.
    """
    features = logged_features(log.trials, trial)
    size_mm = float(log.trials.variant[trial, 0])
    name = f"trial {log.trials.repetition[trial]} of {log.stage or log.source}"
    again = _simulated(log, trial, size_mm)
    if again is not None and np.array_equal(again.features, features):
        return replace(again, caption=f"{name}, simulated again: equal to its log")
    if again is not None and np.array_equal(_in_the_plane(again), features):
        equal = "equal to its log, whose distance leaves out the height"
        return replace(again, caption=f"{name}, simulated again: {equal}")
    success = bool(log.trials.success[trial])
    drawn = replay_log(log.obstacle, log.config, size_mm, features, success=success)
    reason = "" if again is None else f"; simulated again, it departs {_departure(again, features)}"
    return replace(drawn, caption=f"{name}, {CAPTION}{reason}")


def _in_the_plane(motion: Motion) -> FloatArray:
    """Return a motion's features with the distance in the horizontal plane, shape ``(step, 4)``."""
    at_steps = motion.qpos[:: motion.config.physics_steps_per_step, :2]
    if len(at_steps) < len(motion.features):  # the last step diverged and was undone
        at_steps = np.concatenate([at_steps, at_steps[-1:]])
    x_m, y_m = at_steps.T
    square = motion.config.course.target_m - x_m
    square *= square
    square += y_m * y_m
    features = motion.features.copy()
    features[:, FEATURE_NAMES.index("distance_m")] = np.sqrt(square)
    return features


def _simulated(log: Log, trial: int, size_mm: float) -> Motion | None:
    """Return a trial simulated again, or None where what it was made with is not at hand."""
    run = log.run
    stage = None if run is None else _definition(run, log.stage, int(log.trials.repetition[trial]))
    if run is None or stage is None:
        return None
    made = run.stages.get(stage.inputs["network"][0])
    rollout = from_record(RolloutConfig, stage.config["trials"])
    first, sizes = int(stage.config.get(FIRST, 0)), log.sizes_mm.size
    shard = (log.trials.repetition >= first) & (log.trials.repetition < first + rollout.repetitions)
    if made is None or int(shard.sum()) != sizes * rollout.repetitions:
        return None
    index = trial - int(shard.argmax())  # a shard's rows follow one another
    pilot = PolicyPilot(
        Snapshot.load(made.path(NETWORK_FILE)),
        log.obstacle,
        log.config,
        seed=stage.seed,
        deterministic=rollout.deterministic,
        trials=int(shard.sum()),
        trial=index,
    )
    return record_motion(
        log.obstacle, log.config, size_mm, pilot, caption="", seed=stage.seed, stream=index
    )


def _definition(run: RunFolder, name: str, repetition: int) -> Stage | None:
    """Return the stage that rolled a repetition out, as the run's protocol defines it."""
    stages = {stage.name: stage for stage in protocol(config_from_record(run.config))}
    stage = stages.get(name)
    if stage is not None and stage.kind is kinds.JOIN_TRIALS:
        shards = [stages[shard] for shard in stage.inputs["shards"]]
        stage = max(
            (shard for shard in shards if shard.config[FIRST] <= repetition),
            key=lambda shard: shard.config[FIRST],
        )
    return stage if stage is not None and stage.kind is kinds.TRIALS else None


def _departure(motion: Motion, features: FloatArray) -> str:
    """Return when a motion departs from a log."""
    common = min(len(features), len(motion.features))
    differs = (motion.features[:common] != features[:common]).any(axis=1)
    row = int(differs.argmax()) if differs.any() else common - 1
    return f"after {features[row, 0]:.2f} s"


def run_log(run: RunFolder, stage: str, trials: Trials, source: str) -> Log:
    """Return the trials that a stage of a run logged."""
    config = config_from_record(run.config)
    return Log(
        source=source,
        trials=trials,
        obstacle=obstacle_of(config),
        config=config.env,
        run=run,
        stage=stage,
    )
