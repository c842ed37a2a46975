"""The protocol of the paper as a graph (II, fig. 1).

For every network: initiation → trials; all trials → analysis; then for every network: curriculum
→ control of the same length, and tests of both; last the statistics over all of it.
"""

from __future__ import annotations

from collections.abc import Iterator

from surmount.core.configuration import Record, to_record
from surmount.experiment import stages
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.statistics import compare
from surmount.experiment.task_part import stage_seed, task_part
from surmount.experiment.trial_stages import trial_stages
from surmount.workflow.graph import Stage, StageFunction
from surmount.workflow.run_layout import ANALYSIS, ARMS, STATISTICS, TRAININGS, TRIALS, per_network


def protocol(config: ExperimentConfig) -> list[Stage]:
    """Return the stages of one experiment."""
    return list(_stages(config))


def _stages(config: ExperimentConfig) -> Iterator[Stage]:
    record = to_record(config)
    networks = range(config.networks)
    family, settings = config.family, config.env
    # The direction of difficulty says on which variant K is chosen, unless the user says so.
    harder = config.analysis.harder or family.space(settings).harder or ()
    train = task_part(config) | _part(record, "learner", "checkpoint_steps")
    for network in networks:
        initial = per_network("initiation", network)
        yield _stage(config, initial, stages.initiate, train | _part(record, "initial_steps"))
        yield from _trials(config, "initiation", record["trials"], network)
    yield _stage(
        config,
        ANALYSIS,
        stages.analyse,
        {"analysis": record["analysis"] | {"harder": list(harder)}},
        trials=_all_trials("initiation", config),
        version=2,
    )
    for network in networks:
        initial = per_network("initiation", network)
        curriculum, control = (per_network(arm, network) for arm in ARMS)
        yield _stage(
            config,
            curriculum,
            stages.learn_levels,
            train | _part(record, "advancement"),
            network=(initial,),
            analysis=(ANALYSIS,),
        )
        yield _stage(
            config,
            control,
            stages.learn_control,
            train,
            network=(initial,),
            curriculum=(curriculum,),
        )
        for arm in ARMS:
            yield from _trials(config, arm, record["tests"], network)
    yield _stage(
        config,
        STATISTICS,
        compare,
        {"cap_s": family.cap_s(settings)},
        analysis=(ANALYSIS,),
        **{kind: _all_trials(kind, config) for kind in TRAININGS},
        **{
            f"training:{arm}": tuple(
                per_network(arm, network) for network in range(config.networks)
            )
            for arm in ARMS
        },
        version=2,
    )


def _all_trials(kind: str, config: ExperimentConfig) -> tuple[str, ...]:
    return tuple(per_network(TRIALS[kind], network) for network in range(config.networks))


def _trials(config: ExperimentConfig, kind: str, trials: Record, network: int) -> list[Stage]:
    name, trained = per_network(TRIALS[kind], network), per_network(kind, network)
    return trial_stages(config, name, trials, network, trained)


def _stage(
    config: ExperimentConfig,
    name: str,
    function: StageFunction,
    part: Record,
    *,
    version: int = 1,
    **inputs: tuple[str, ...],
) -> Stage:
    return Stage(
        name=name,
        function=function,
        version=version,
        config=part,
        seed=stage_seed(config, name),
        inputs=inputs,
    )


def _part(record: Record, *keys: str) -> Record:
    return {key: record[key] for key in keys}
