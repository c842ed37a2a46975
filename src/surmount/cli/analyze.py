"""``surmount analyze``: logged trials of any robot into a curriculum."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.core.printing import say


def analyze(
    trials: Annotated[Path, tyro.conf.Positional],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
) -> int:
    """Turn logged trials into a curriculum, with every reason kept.

    Writes curriculum.json (to read, edit and train by), analysis.json (the evidence; see `surmount
    show --why`), report.html (the same as a page) and its figures.

    Args:
        trials: Long table, Parquet or CSV: variant, network, trial, success, then one column per
            feature, one row per time step.
        out: Folder for the results.
        config: TOML or JSON file of analysis options to change, such as linkage = "complete".
        set: Analysis option to change, as key=value; may be repeated; overrides the file.
    """
    from surmount.analysis.configuration import AnalysisConfig
    from surmount.analysis.description import describe_curriculum
    from surmount.analysis.determination import determine_curriculum
    from surmount.analysis.trust import describe_trust
    from surmount.core.configuration import override
    from surmount.report.pages import write_analysis_report
    from surmount.trials.table import read_trials
    from surmount.workflow.run_layout import ANALYSIS_FILE, CURRICULUM_FILE
    from surmount.workflow.store import output_errors, sole_user

    chosen = override(AnalysisConfig(), overrides(config, set))
    table = read_trials(
        trials, minimum_variants=2, minimum_samples=chosen.min_samples_per_component
    )
    with sole_user(out), output_errors(out):
        analysis = determine_curriculum(table, chosen)
        analysis.save(out / ANALYSIS_FILE)
        analysis.curriculum.save(out / CURRICULUM_FILE)
        page = write_analysis_report(analysis.to_record(), out)
    say("\n".join(describe_curriculum(analysis.curriculum)))
    say("\nHow far to trust it")
    for sentence in (*describe_trust(analysis), *analysis.warnings):
        say(f"  {sentence}")
    say(f"\nWritten to {out}: {CURRICULUM_FILE}, {ANALYSIS_FILE}, figures/")
    say(f"To read: {page}")
    return 0
