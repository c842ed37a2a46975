"""The stage that compares both arms by the statistics of the paper (III-E) and over networks."""

from __future__ import annotations

from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.records import write_record
from surmount.experiment.learning_speed import steps_to_95
from surmount.experiment.stages import pooled_trials
from surmount.learn.training_episodes import read_episodes
from surmount.report.outcomes import PATHS
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.differences import network_difference
from surmount.stats.evidence import (
    bootstrap_interval,
    difference_interval,
    probability_of_improvement,
)
from surmount.stats.logrank import log_rank
from surmount.stats.mixed.model import mixed_model
from surmount.stats.proportions import proportion_intervals, proportion_test
from surmount.stats.survival import kaplan_meier
from surmount.tasks.curriculum import Curriculum
from surmount.trials.trials import Trials, success_rates
from surmount.workflow.graph import StageContext
from surmount.workflow.run_layout import ARMS, CURRICULUM_FILE, INITIATION, SCHEMA, STATISTICS_FILE

TIME = "time_s"

Record = dict[str, Any]


def compare(context: StageContext) -> None:
    """Write ``statistics.json``: success, times, path lengths and speed of both arms."""
    (analysis,) = context.inputs["analysis"]
    curriculum = Curriculum.load(analysis.path(CURRICULUM_FILE))
    initiation = pooled_trials(context.inputs[INITIATION])
    cap_s = float(context.config["cap_s"])
    arms = {arm: pooled_trials(context.inputs[arm]) for arm in ARMS}
    write_record(
        context.output / STATISTICS_FILE,
        {
            "schema": SCHEMA,
            "cap_s": cap_s,
            "groups": [group.name for group in curriculum.groups],
            "success_by_variant": {
                INITIATION: success_by_variant(initiation),
                **{arm: success_by_variant(trials) for arm, trials in arms.items()},
            },
            "initiation_by_group": [
                {"group": group.name, **success_of(in_group(initiation, curriculum, index))}
                for index, group in enumerate(curriculum.groups)
            ],
            "groups_compared": [
                {"group": group.name, **compare_group(arms, curriculum, index, cap_s)}
                for index, group in enumerate(curriculum.groups)
            ],
            "path_lengths": {
                path: compare_paths(arms, curriculum, path)
                for path in PATHS
                if path in initiation.feature_names
            },
            "networks": compare_networks(arms, context.seed),
            "steps_to_95": {
                arm: [
                    found.to_record()
                    for found in steps_to_95(
                        [
                            read_episodes(artefact, curriculum.parameters)
                            for artefact in context.inputs[f"training:{arm}"]
                        ],
                        curriculum,
                    )
                ]
                for arm in ARMS
            },
        },
    )


def in_group(trials: Trials, curriculum: Curriculum, group: int) -> Trials:
    """Return the trials on the variants of one group."""
    return trials.select(curriculum.groups_of(trials.variant) == group)


def success_of(trials: Trials) -> Record:
    """Return how many trials succeeded, and how many there are."""
    return {"successes": int(trials.success.sum()), "trials": trials.n_trials}


def success_by_variant(trials: Trials) -> list[Record]:
    """Return successes and trials of each variant with Wilson's interval, ascending."""
    variants, index = trials.variants()
    total = np.bincount(index, minlength=len(variants))
    successes = np.bincount(index[trials.success], minlength=len(variants))
    intervals = proportion_intervals(successes, total)
    return [
        {
            "variant": variant.tolist(),
            "successes": int(successes[row]),
            "trials": int(total[row]),
            "lower": intervals.lower[row],
            "upper": intervals.upper[row],
        }
        for row, variant in enumerate(variants)
    ]


def compare_group(
    arms: dict[str, Trials], curriculum: Curriculum, group: int, cap_s: float
) -> Record:
    """Compare success and completion time of both arms in one group.

    Failed trials are censored at the cap (III-E), also those that a fall ended earlier: censored
    at the fall they would count as if they might have gone on as well as any other.
    """
    chosen = {arm: in_group(trials, curriculum, group) for arm, trials in arms.items()}
    won = [int(chosen[arm].success.sum()) for arm in ARMS]
    totals = [chosen[arm].n_trials for arm in ARMS]
    times = {
        arm: np.where(trials.success, trials.final(TIME), cap_s) for arm, trials in chosen.items()
    }
    return {
        "arms": {arm: success_of(trials) for arm, trials in chosen.items()},
        "proportion_test": proportion_test(won, totals).to_record(),
        "survival": {
            arm: kaplan_meier(times[arm], chosen[arm].success).to_record() for arm in ARMS
        },
        "log_rank": log_rank(
            np.concatenate([times[arm] for arm in ARMS]),
            np.concatenate([chosen[arm].success for arm in ARMS]),
            np.repeat(ARMS, totals),
        ).to_record(),
    }


def compare_paths(arms: dict[str, Trials], curriculum: Curriculum, path: str) -> Record:
    """Compare the path length of a feature over successful trials (III-E).

    Without any successful trial the record holds a ``reason`` and no contrasts.
    """
    if not any(trials.success.any() for trials in arms.values()):
        return {
            "response": path,
            "means": [],
            "contrasts": [],
            "reason": "No trial of either arm succeeded, so there is no path to compare.",
        }
    columns: dict[str, list[Any]] = {path: [], "group": [], "method": [], "network": []}
    names = [group.name for group in curriculum.groups]
    for arm, trials in arms.items():
        won = trials.success
        columns[path].append(trials.path_length(path)[won])
        columns["group"].append(np.array(names)[curriculum.groups_of(trials.variant)[won]])
        columns["method"].append(np.full(int(won.sum()), arm))
        columns["network"].append(trials.network[won])
    return mixed_model(
        {name: np.concatenate(parts) for name, parts in columns.items()},
        response=path,
        group="group",
        method="method",
        subject="network",
        groups=names,
        methods=ARMS,
    ).to_record()


def compare_networks(arms: dict[str, Trials], seed: int) -> Record:
    """Return the evidence over networks, which the paper lacks: each network is one observation.

    With fewer than ten networks the bootstrap's intervals are too narrow; ``mean_difference``, a
    paired t-test on network means, is the one to trust (docs/adr/0031).
    """
    scores = {arm: success_matrix(trials) for arm, trials in arms.items()}
    first, second = scores[ARMS[0]], scores[ARMS[1]]
    bootstrap = Bootstrap(seed=seed)
    return {
        "interquartile_mean": {
            arm: bootstrap_interval(matrix, bootstrap).to_record() for arm, matrix in scores.items()
        },
        "mean_difference": network_difference(first, second, paired=True).to_record(),
        "difference": difference_interval(first, second, bootstrap, paired=True).to_record(),
        "probability_of_improvement": probability_of_improvement(
            first, second, bootstrap, paired=True
        ).to_record(),
    }


def success_matrix(trials: Trials) -> FloatArray:
    """Return the success rate of each network on each variant, shape ``(network, variant)``."""
    return success_rates(trials.variant, trials.network, trials.success)
