"""``surmount show``: a curriculum, or the reasons for it, in words."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.core.errors import InputError
from surmount.core.printing import say
from surmount.workflow.opening import opened
from surmount.workflow.run_folder import open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    ANALYSIS_FILE,
    CURRICULUM_FILE,
    RUN,
    STATISTICS,
    TRAINING_FILE,
)


def show(file: Annotated[Path, tyro.conf.Positional], *, why: bool = False) -> int:
    """Print groups, ranges, success, levels and weights.

    Args:
        file: A curriculum.json or analysis.json, or a folder with one: of `surmount analyze`, or
            of a run; or the training.json of one training, which tells what its teacher did.
        why: Walk the evidence as well, link by link, and what a run's teachers practised, and why.
    """
    from surmount.analysis.description import describe_curriculum
    from surmount.analysis.explanation import explain_analysis
    from surmount.analysis.result import Analysis
    from surmount.analysis.result_reading import KIND
    from surmount.analysis.trust import describe_trust
    from surmount.core.records import read_record
    from surmount.tasks.curriculum import Curriculum

    path = opened(_resolve(file, why=why))
    record = read_record(path)
    if "level_tests" in record:
        say("\n".join(_reasons_of_training(path, record)))
        return 0
    if record.get("kind") == KIND:
        analysis = Analysis.from_record(record, source=str(path))
        if why:
            lines = [*explain_analysis(analysis), *_changes_in_run(file)]
        else:
            trust = [f"  {sentence}" for sentence in describe_trust(analysis)]
            lines = [*describe_curriculum(analysis.curriculum), "", "How far to trust it", *trust]
    elif why:
        raise InputError(
            f"{path} is a curriculum, and does not hold the reasons for it.",
            remedy="Give the analysis.json that was written beside it.",
        )
    else:
        lines = [*describe_curriculum(Curriculum.load(path)), *_tests_in_run(file)]
    say("\n".join(lines))
    return 0


def _reasons_of_training(path: Path, record: dict[str, Any]) -> list[str]:
    """Return what the teacher of one training decided, in its own words."""
    from surmount.teachers.changes import describe_changes

    try:
        told, steps = [*record["level_tests"], *record.get("changes", ())], f"{record['steps']:,}"
        if not told:
            return [f"{path}: its teacher made no decisions; it trained {steps} steps."]
        return describe_changes(f"What its teacher did in {steps} steps", told)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{path} is no record of a training ({type(error).__name__}: {error}).",
            remedy="Give the training.json of a run's stage.",
        ) from error


def _changes_in_run(folder: Path) -> list[str]:
    """Return the changes of all teachers of a run that tell of them."""
    from surmount.core.records import read_record
    from surmount.teachers.changes import describe_changes

    if not (folder / RUN).is_file():
        return []
    lines: list[str] = []
    for name, stage in open_run(folder).stages.items():
        if TRAINING_FILE not in stage.files:
            continue
        changes = read_record(stage.path(TRAINING_FILE)).get("changes", ())
        if changes:
            lines += ["", *describe_changes(f"What was practised in {name}, and why", changes)]
    return lines


def _tests_in_run(folder: Path) -> list[str]:
    """Return what the tests of a finished run tell: whether the curriculum helps."""
    if not (folder / RUN).is_file() or STATISTICS not in open_run(folder).stages:
        return []
    from surmount.report.answer import answer
    from surmount.report.results import read_run

    return ["", "What testing gave", *(f"  {line}" for line in answer(read_run(folder)).sentences)]


def _resolve(path: Path, *, why: bool) -> Path:
    """Return the file meant: itself, or the one in a folder of results or of a run."""
    if not path.is_dir():
        return path
    folder = path
    if (path / RUN).is_file():
        found = open_run(path).stages.get(ANALYSIS)
        folder = path if found is None else found.folder
    name = ANALYSIS_FILE if why else CURRICULUM_FILE
    if not (folder / name).is_file():
        raise InputError(
            f"There is no {name} in {path}.",
            remedy="Give a file, or the --out folder of `surmount analyze` or of a finished run.",
        )
    return folder / name
