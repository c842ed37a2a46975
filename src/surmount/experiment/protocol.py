"""The protocol of the paper as a graph (II, fig. 1).

For every network: initiation → trials; all trials → analysis; then for every network: curriculum
→ control of the same length, and tests of both; last the statistics over all of it.
"""

from __future__ import annotations

from collections.abc import Iterator

from surmount.core.configuration import Record, to_record
from surmount.core.seeds import derive_seed
from surmount.experiment import stages
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.graph import Stage, StageFunction
from surmount.experiment.statistics import ARMS, compare


def protocol(config: ExperimentConfig) -> list[Stage]:
    """Return the stages of one experiment."""
    return list(_stages(config))


def _stages(config: ExperimentConfig) -> Iterator[Stage]:
    record = to_record(config)
    networks = range(config.networks)
    train = _part(record, "obstacle", "env", "learner", "checkpoint_steps")
    for network in networks:
        yield _stage(
            config,
            f"initiation/network-{network}",
            stages.initiate,
            train | _part(record, "initial_steps"),
        )
        yield _trials_stage(config, record, "trials", network, source="initiation", key="trials")
    yield _stage(
        config,
        "analysis",
        stages.analyse,
        _part(record, "analysis"),
        trials=tuple(f"trials/network-{network}" for network in networks),
    )
    for network in networks:
        initial = (f"initiation/network-{network}",)
        yield _stage(
            config,
            f"curriculum/network-{network}",
            stages.learn_levels,
            train | _part(record, "advancement"),
            network=initial,
            analysis=("analysis",),
        )
        yield _stage(
            config,
            f"control/network-{network}",
            stages.learn_control,
            train,
            network=initial,
            curriculum=(f"curriculum/network-{network}",),
        )
        for arm in ARMS:
            yield _trials_stage(config, record, f"test-{arm}", network, source=arm, key="tests")
    yield _stage(
        config,
        "statistics",
        compare,
        {"cap_s": config.env.episode_s},
        analysis=("analysis",),
        initiation=tuple(f"trials/network-{network}" for network in networks),
        **{arm: tuple(f"test-{arm}/network-{network}" for network in networks) for arm in ARMS},
    )


def _trials_stage(
    config: ExperimentConfig, record: Record, kind: str, network: int, *, source: str, key: str
) -> Stage:
    return _stage(
        config,
        f"{kind}/network-{network}",
        stages.run_trials,
        _part(record, "obstacle", "env") | {"trials": record[key], "network": network},
        network=(f"{source}/network-{network}",),
    )


def _stage(
    config: ExperimentConfig,
    name: str,
    function: StageFunction,
    part: Record,
    **inputs: tuple[str, ...],
) -> Stage:
    return Stage(
        name=name,
        function=function,
        config=part,
        seed=derive_seed(config.seed, config.obstacle, name),
        inputs=inputs,
    )


def _part(record: Record, *keys: str) -> Record:
    return {key: record[key] for key in keys}
