"""``surmount evaluate``: a trained network tried on every size of its obstacle."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import torch
import tyro
from rich.console import Console
from rich.table import Table

from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.experiment.evaluation import Evaluation, evaluate_network
from surmount.learn.rollout_config import RolloutConfig
from surmount.stats.proportions import proportion_intervals
from surmount.trials.table import write_trials
from surmount.workflow.monitor import SilentMonitor
from surmount.workflow.store import output_errors


def evaluate(
    network: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="NETWORK.safetensors")],
    *,
    task: Annotated[str | None, tyro.conf.arg(metavar="TASK")] = None,
    variant: Annotated[tuple[float, ...], tyro.conf.arg(metavar="VALUE ...")] = (),
    repetitions: int = 30,
    seed: int = 0,
    deterministic: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False,
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None,
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
) -> int:
    """Try a trained network as trials do, and show its success by variant.

    Args:
        network: The network of a run, or a published one.
        task: Task of a network that does not tell what it was trained on.
        variant: Values of the task parameter, one variant each; with several parameters, one value
            for each in turn. All variants of the task if left out.
        repetitions: Trials of each variant.
        seed: Seed of the actions that the policy draws.
        deterministic: Act by the policy's mean instead of drawing actions.
        out: Table of the trials to write, .parquet or .csv.
        config: TOML or JSON file of configuration keys to change; see `surmount config`.
        set: Configuration key to change, as key=value; may be repeated; overrides the file.
    """
    torch.set_num_threads(1)  # as in a run: sums would differ in their last bits
    evaluation = evaluate_network(
        network,
        RolloutConfig(repetitions=repetitions, deterministic=deterministic),
        task=task,
        variants=variant,
        changes=overrides(config, set),
        seed=seed,
        monitor=SilentMonitor(),
    )
    Console().print(_table(evaluation), highlight=False)
    if out is not None:
        with output_errors(out.parent):
            out.parent.mkdir(parents=True, exist_ok=True)
            write_trials(out, evaluation.trials)
        print(f"Written to {out}: {evaluation.trials.n_trials:,} trials")
    return 0


def _table(evaluation: Evaluation) -> Table:
    trials = evaluation.trials
    variants, which = trials.variants()
    tried = np.bincount(which, minlength=len(variants))
    won = np.bincount(which, weights=trials.success, minlength=len(variants)).astype(np.int64)
    interval = proportion_intervals(won, tried)
    times_s = np.where(trials.success, trials.final("time_s"), evaluation.cap_s)
    table = Table(title=f"{evaluation.task}: {trials.success.mean():.1%} of {trials.n_trials:,}")
    for heading in (
        *evaluation.space.parameters,
        "successes",
        "rate",
        "95 % (Wilson)",
        "median time, s",
    ):
        table.add_column(heading, justify="right")
    for index, variant in enumerate(variants):
        table.add_row(
            *(f"{value:g}" for value in variant),
            f"{won[index]} / {tried[index]}",
            f"{interval.proportions[index]:.2f}",
            f"{interval.lower[index]:.2f} to {interval.upper[index]:.2f}",
            f"{np.median(times_s[which == index]):.2f}",
        )
    return table
