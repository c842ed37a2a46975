"""``surmount reproduce``: the whole protocol of the paper on one family of tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from surmount.cli.configuration_flags import RunOptions, opened_console, run_configured
from surmount.cli.main import INTERRUPTED
from surmount.experiment.config import ExperimentConfig


def reproduce(arguments: Sequence[str]) -> int:
    """Run the paper's protocol on one family of tasks, from the first learning step to the report.

    Calling it again with the same options goes on where it stopped: finished stages are kept, and
    training goes on from its last checkpoint to the same result. Ctrl-C stops cleanly.
    """
    return run_configured(
        RunOptions, _run, arguments, verb="reproduce", description=str(reproduce.__doc__)
    )


def _run(options: RunOptions, chosen: ExperimentConfig, _beside: Mapping[str, Any]) -> int:
    console = opened_console(options.out)
    # After the first line: what learns takes seconds to import.
    from surmount.cli.summary import print_summary
    from surmount.experiment.experiment import Experiment

    experiment = Experiment(chosen, options.out)
    if experiment.run(
        **options.workers.checked(), console=console, amend=options.resume
    ).interrupted:
        console.print(f"Stopped. Go on with: surmount reproduce --resume --out {options.out}")
        return INTERRUPTED
    page = experiment.report(say=lambda text: console.print(text, soft_wrap=True, markup=False))
    print_summary(console, options.out)
    console.print(f"Report: {page.resolve()}", soft_wrap=True)
    return 0
