"""Roll-outs of one network as stages: one, or several shards that may run side by side."""

from __future__ import annotations

from surmount.core.configuration import Record
from surmount.experiment import kinds
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.stages import FIRST
from surmount.experiment.task_part import stage_seed, task_part
from surmount.workflow.graph import Stage
from surmount.workflow.run_layout import shard


def trial_stages(
    config: ExperimentConfig, name: str, trials: Record, network: int, trained: str
) -> list[Stage]:
    """Return the stages that try a network on every variant; the last one has the trials.

    With ``rollout_shards`` above one, each shard takes its part of the repetitions, with a seed of
    its own.

    Parameters
    ----------
    config
        The experiment.
    name
        Name of the stage that has the trials in the end.
    trials
        Record of the roll-outs' configuration.
    network
        Index of the network, kept in the trials.
    trained
        Name of the stage that trained it.
    """
    part = task_part(config) | {"trials": trials, "network": network}
    if config.rollout_shards == 1:
        return [
            Stage(
                name=name,
                kind=kinds.TRIALS,
                config=part,
                seed=stage_seed(config, name),
                inputs={"network": (trained,)},
            )
        ]
    shards: list[Stage] = []
    first = 0
    for index in range(config.rollout_shards):
        count = len(range(index, int(trials["repetitions"]), config.rollout_shards))
        part_name = shard(name, index)
        shards.append(
            Stage(
                name=part_name,
                kind=kinds.TRIALS,
                config=part | {"trials": trials | {"repetitions": count}, FIRST: first},
                seed=stage_seed(config, part_name),
                inputs={"network": (trained,)},
            )
        )
        first += count
    whole = Stage(
        name=name,
        kind=kinds.JOIN_TRIALS,
        seed=stage_seed(config, name),
        inputs={"shards": tuple(one.name for one in shards)},
    )
    return [*shards, whole]
