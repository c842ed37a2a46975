"""The protocol of the paper as a graph (II, fig. 1).

For every network: initiation → trials; all trials → analysis; then for every network: curriculum
→ control of the same length, and tests of both; then the statistics over all of it, and last what
they say to the paper's claims.
"""

from __future__ import annotations

from collections.abc import Iterator

from surmount.core.configuration import Record, key_record
from surmount.experiment import kinds
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.task_part import stage_seed, task_part
from surmount.experiment.trial_stages import trial_stages
from surmount.workflow.graph import Stage, StageKind
from surmount.workflow.run_layout import (
    ANALYSIS,
    ARMS,
    EVIDENCE,
    INITIATION,
    STATISTICS,
    TRAININGS,
    TRIALS,
    per_network,
)


def protocol(config: ExperimentConfig) -> list[Stage]:
    """Return the stages of one experiment."""
    return list(_stages(config))


def _stages(config: ExperimentConfig) -> Iterator[Stage]:
    record = key_record(config)
    networks = range(config.networks)
    family, settings = config.family, config.env
    # The direction of difficulty says on which variant K is chosen, unless the user says so.
    harder = config.analysis.harder or family.space(settings).harder or ()
    train = task_part(config) | _part(record, "learner", "checkpoint_steps")
    for network in networks:
        initial = per_network(INITIATION, network)
        yield _stage(config, initial, kinds.INITIATION, train | _part(record, "initial_steps"))
        yield from _trials(config, INITIATION, record["trials"], network)
    yield _stage(
        config,
        ANALYSIS,
        kinds.ANALYSIS,
        {"analysis": record["analysis"] | {"harder": list(harder)}},
        trials=_all_trials(INITIATION, config),
    )
    for network in networks:
        initial = per_network(INITIATION, network)
        curriculum, control = (per_network(arm, network) for arm in ARMS)
        yield _stage(
            config,
            curriculum,
            kinds.CURRICULUM,
            train | _part(record, "advancement"),
            network=(initial,),
            analysis=(ANALYSIS,),
        )
        yield _stage(
            config,
            control,
            kinds.CONTROL,
            train,
            network=(initial,),
            curriculum=(curriculum,),
        )
        for arm in ARMS:
            yield from _trials(config, arm, record["tests"], network)
    yield _stage(
        config,
        STATISTICS,
        kinds.STATISTICS,
        {"cap_s": family.cap_s(settings)},
        analysis=(ANALYSIS,),
        **{training: _all_trials(training, config) for training in TRAININGS},
        **{
            f"training:{arm}": tuple(
                per_network(arm, network) for network in range(config.networks)
            )
            for arm in ARMS
        },
    )
    yield _stage(
        config,
        EVIDENCE,
        kinds.EVIDENCE,
        task_part(config),
        analysis=(ANALYSIS,),
        statistics=(STATISTICS,),
        **{training: _all_trials(training, config) for training in TRAININGS},
    )


def _all_trials(training: str, config: ExperimentConfig) -> tuple[str, ...]:
    return tuple(per_network(TRIALS[training], network) for network in range(config.networks))


def _trials(config: ExperimentConfig, training: str, trials: Record, network: int) -> list[Stage]:
    name, trained = per_network(TRIALS[training], network), per_network(training, network)
    return trial_stages(config, name, trials, network, trained)


def _stage(
    config: ExperimentConfig,
    name: str,
    kind: StageKind,
    part: Record,
    **inputs: tuple[str, ...],
) -> Stage:
    return Stage(
        name=name,
        kind=kind,
        config=part,
        seed=stage_seed(config, name),
        inputs=inputs,
    )


def _part(record: Record, *keys: str) -> Record:
    return {key: record[key] for key in keys}
