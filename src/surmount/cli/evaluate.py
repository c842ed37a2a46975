"""``surmount evaluate``: a trained network tried on every size of its obstacle."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.options import Assignments, ConfigFile, environment_overrides
from surmount.cli.part_progress import PartMonitor, PartProgress
from surmount.core.printing import say


def evaluate(
    network: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="NETWORK.safetensors")],
    *,
    task: Annotated[str | None, tyro.conf.arg(metavar="TASK")] = None,
    variant: Annotated[tuple[str, ...], tyro.conf.arg(metavar="VALUE ...")] = (),
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
        variant: Values of the task parameter, or names, one variant each; with several parameters,
            one value for each in turn. All variants of the task if left out.
        repetitions: Trials of each variant.
        seed: Seed of the actions that the policy draws.
        deterministic: Act by the policy's mean instead of drawing actions.
        out: Table of the trials to write, .parquet or .csv.
        config: TOML or JSON file of configuration keys to change; see `surmount config`.
        set: Configuration key to change, as key=value; may be repeated; overrides the file.
    """
    telling = PartProgress()
    telling(f"loading {network}")  # before what takes seconds to import
    import torch

    from surmount.cli.success_table import success_table
    from surmount.experiment.evaluation import evaluate_network
    from surmount.learn.rollout_config import RolloutConfig
    from surmount.trials.table import write_trials
    from surmount.trials.table_file import require_writable_kind
    from surmount.workflow.console import SafeConsole
    from surmount.workflow.store import output_errors

    if out is not None:
        require_writable_kind(out)
    torch.set_num_threads(1)  # as in a run: sums would differ in their last bits
    with telling:
        evaluation = evaluate_network(
            network,
            RolloutConfig(repetitions=repetitions, deterministic=deterministic),
            task=task,
            variants=variant,
            changes=environment_overrides(config, set, whole_file=True),
            seed=seed,
            monitor=PartMonitor(telling),
        )
    SafeConsole().print(success_table(evaluation), highlight=False)
    if out is not None:
        with output_errors(out.parent):
            out.parent.mkdir(parents=True, exist_ok=True)
            write_trials(out, evaluation.trials)
        say(f"Written to {out}: {evaluation.trials.n_trials:,} trials")
    return 0
