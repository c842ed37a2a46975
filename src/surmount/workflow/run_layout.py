"""What a run's output folder holds, and what its stages and their files are called.

The experiment writes by these names and the report reads by them; neither imports the other.
Names of files end in ``_FILE``, those of a run's own records apart.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from surmount.core.errors import InputError, IntegrityError
from surmount.core.records import read_record, read_sealed

SCHEMA = 1
"""Version of the records below; raised when one of them changes its form."""

RUN = "run.json"
"""Configuration, versions and machine."""
RUN_KEYS = ("schema", "config", "versions", "machine")
INDEX = "index.json"
"""Folder of each finished stage."""
INDEX_KEYS = ("schema", "stages")
TIMINGS = "timings.json"
"""Seconds that each stage took."""
FILM_FOLDER = "films"
FILMS = "films/films.json"
"""What the films show, with their hashes."""
RESTARTS = "restarts.json"
"""How often each stage lost its worker and was run again, over all calls; absent if none was."""

_OWN_NAMES = {
    *(INDEX, TIMINGS, RESTARTS, FILM_FOLDER),
    *("stages", "checkpoints", "logs", "figures", "report.html", "report.md"),
}
"""What lies in a run's output folder beside its own record."""

MOST_NETWORKS = 10_000
"""Networks of a run at the most: more are a mistyped number, or a damaged file."""

MOST_SECONDS = 1e10
"""Three hundred years: a stage that took longer is a damaged file."""

INITIATION = "initiation"
CURRICULUM = "curriculum"
CONTROL = "control"
ARMS = (CURRICULUM, CONTROL)
"""The two ways of going on from an initial network."""
TRAININGS = (INITIATION, *ARMS)
"""Stages that train, one per network."""
TRIALS = {INITIATION: "trials", **{arm: f"test-{arm}" for arm in ARMS}}
"""Stages that roll out what was trained, one per network."""
ANALYSIS = "analysis"
STATISTICS = "statistics"
EVIDENCE = "evidence"
COMPARISON = "teachers"
"""Stage that compares teachers."""

NETWORK_FILE = "network.safetensors"
"""Of a training: the network."""
EXPERIENCE_FILE = "experience.safetensors"
"""Of an initiation whose learner has a replay buffer: what the next training begins with."""
HISTORY_FILE = "history.parquet"
"""Of a training: one row per roll-out."""
EPISODES_FILE = "episodes.parquet"
"""Of a training: one row per episode."""
TRAINING_FILE = "training.json"
"""Of a training: its length, and what its teacher tested."""
TRIALS_FILE = "trials.parquet"
"""Of roll-outs: the logged trials."""
ANALYSIS_FILE = "analysis.json"
"""Of the analysis: all evidence."""
CURRICULUM_FILE = "curriculum.json"
"""Of the analysis: the curriculum alone."""
STATISTICS_FILE = "statistics.json"
"""Of the statistics over both arms."""
EVIDENCE_FILE = "evidence.json"
"""Of the evidence: profiles over networks, and claims with their verdicts."""
COMPARISON_FILE = "teachers.json"
"""Of the comparison of teachers."""


def taught(teacher: str) -> str:
    """Return the kind of the stages in which a teacher other than the protocol's trains."""
    return f"teach/{teacher}"


def taught_trials(teacher: str) -> str:
    """Return the kind of the stages that roll out what such a teacher trained."""
    return f"test-teach/{teacher}"


def shard(stage: str, index: int) -> str:
    """Return the name of the stage that does a part of another's roll-outs."""
    return f"shard/{stage}/{index}"


def per_network(kind: str, network: int) -> str:
    """Return the name of a stage that exists once per network."""
    return f"{kind}/network-{network}"


def expected_stages(networks: int) -> list[str]:
    """Return the names of the stages without which a run of so many networks is unfinished.

    The evidence is none of them: runs of before it was kept have none, and it can be found anew
    from the others whenever it is asked for.
    """
    kinds = [*TRAININGS, *TRIALS.values()]
    return [
        *(per_network(kind, network) for kind in kinds for network in range(networks)),
        ANALYSIS,
        STATISTICS,
    ]


def read_run_record(path: Path) -> dict[str, Any]:
    """Read one of a run's JSON records.

    Raises
    ------
    InputError
        If it cannot be read, or is of another version.
    """
    return _of_this_version(read_record(path), path)


def read_run(root: Path) -> dict[str, Any]:
    """Read ``run.json`` of an output folder.

    Raises
    ------
    IntegrityError
        If it was changed or damaged after it was written.
    InputError
        If it is of another version.
    """
    path = root / RUN
    remedy = (
        f"Delete {path} and give the command that began the run again, with all its options and "
        "without --resume: what is finished is kept."
    )
    return _of_this_version(read_sealed(path, RUN_KEYS, remedy=remedy), path)


def _of_this_version(record: dict[str, Any], path: Path) -> dict[str, Any]:
    if record.get("schema") != SCHEMA:
        raise InputError(
            f"{path} has schema {record.get('schema')!r}; this version reads {SCHEMA}.",
            remedy="Use the version of Surmount that wrote it.",
        )
    return record


def has_lost_its_record(root: Path) -> bool:
    """Whether a folder holds what a run leaves and nothing else, without ``run.json``."""
    names = {path.name for path in root.iterdir() if not path.name.startswith(".")}
    return RUN not in names and names <= _OWN_NAMES and bool(names & {"stages", "logs"})


def read_index(root: Path) -> dict[str, str] | None:
    """Return the folder of each finished stage, relative to the output folder.

    ``None`` where the index is missing or damaged: it is only a help, and can be told from the
    folders themselves.
    """
    try:
        record = read_sealed(root / INDEX, INDEX_KEYS, remedy="")
        stages = _of_this_version(record, root / INDEX)["stages"]
        return {str(name): str(folder) for name, folder in stages.items()}
    except (IntegrityError, InputError, KeyError, AttributeError):
        return None


def read_numbers(path: Path) -> dict[str, float]:
    """Return the numbers of a run's journal, by stage; what is damaged is left out.

    They are shown and nothing depends on them.
    """
    try:
        record = read_record(path)
    except InputError:
        return {}
    return {
        name: value
        for name, value in record.items()
        if isinstance(value, int | float)
        and not isinstance(value, bool)
        and 0 <= value <= MOST_SECONDS
    }
