"""``surmount analyze``: logged trials of any robot into a curriculum."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.cli.columns import ColumnOptions
from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.cli.part_progress import PartProgress
from surmount.core.printing import say

EXAMPLE = Path("example")


def analyze(
    trials: Annotated[Path, tyro.conf.Positional],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    columns: tyro.conf.OmitArgPrefixes[ColumnOptions] = ColumnOptions(),  # noqa: B008 - frozen
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
) -> int:
    """Turn logged trials into a curriculum, with every reason kept.

    Writes curriculum.json (to read, edit and train by), analysis.json (the evidence; see `surmount
    show --why`), report.html (the same as a page) and its figures.

    Args:
        trials: Table with one row per time step, in CSV, Parquet or Arrow: variant, network,
            trial, success, then one column per feature; or a folder of tables; or the word example,
            for 720 trials of a robot before steps that come with Surmount.
        out: Folder for the results.
        columns: Which column holds what.
        config: TOML or JSON file of analysis options to change, such as linkage = "complete".
        set: Analysis option to change, as key=value; may be repeated; overrides the file.
    """
    if trials == EXAMPLE and not trials.exists():
        from surmount.trials.example import example_path

        trials = example_path()
    with PartProgress() as progress:
        progress(f"reading {trials}")  # before what takes long to import
        analysis, page = _analysed(trials, out, columns, overrides(config, set), progress)

    from surmount.analysis.description import describe_curriculum
    from surmount.analysis.trust import describe_trust
    from surmount.workflow.run_layout import ANALYSIS_FILE, CURRICULUM_FILE

    say("\n".join(describe_curriculum(analysis.curriculum)))
    say("\nHow far to trust it")
    for sentence in (*describe_trust(analysis), *analysis.warnings):
        say(f"  {sentence}")
    say(f"\nWritten to {out}: {CURRICULUM_FILE}, {ANALYSIS_FILE}, figures/")
    say(f"To read: {page}")
    return 0


def _analysed(
    trials: Path,
    out: Path,
    columns: ColumnOptions,
    changes: dict[str, Any],
    progress: PartProgress,
) -> tuple[Any, Path]:
    """Read, analyse and write; return the analysis and where its page is."""
    from surmount.analysis.configuration import AnalysisConfig
    from surmount.analysis.determination import determine_curriculum
    from surmount.core.configuration import override
    from surmount.report.pages import write_analysis_report
    from surmount.trials.table import read_trials
    from surmount.workflow.run_layout import ANALYSIS_FILE, CURRICULUM_FILE
    from surmount.workflow.store import output_errors, sole_user

    chosen = override(AnalysisConfig(), changes)
    table = read_trials(
        trials,
        columns=columns.columns(),
        minimum_variants=2,
        minimum_samples=chosen.min_samples_per_component,
    )
    with sole_user(out), output_errors(out):
        analysis = determine_curriculum(table, chosen, progress=progress)
        progress("page and figures")
        analysis.save(out / ANALYSIS_FILE)
        analysis.curriculum.save(out / CURRICULUM_FILE)
        page = write_analysis_report(analysis.to_record(), out)
    return analysis, page
