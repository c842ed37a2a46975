"""What a run's output folder holds, and what its stages and their files are called.

The experiment writes by these names and the report reads by them; neither imports the other.
Names of files end in ``_FILE``, those of a run's own records apart.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from surmount.core.errors import InputError
from surmount.core.records import read_record

SCHEMA = 1
"""Version of the records below; raised when one of them changes its form."""

RUN = "run.json"
"""Configuration, versions and machine."""
INDEX = "index.json"
"""Folder of each finished stage."""
TIMINGS = "timings.json"
"""Seconds that each stage took."""
FILM_FOLDER = "films"
FILMS = "films/films.json"
"""What the films show, with their hashes."""
RESTARTS = "restarts.json"
"""How often each stage lost its worker and was run again, over all calls; absent if none was."""

MOST_NETWORKS = 10_000
"""Networks of a run at the most: more are a mistyped number, or a damaged file."""

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
    """Return the names of all stages of a run with so many networks."""
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
    record = read_record(path)
    if record.get("schema") != SCHEMA:
        raise InputError(
            f"{path} has schema {record.get('schema')!r}; this version reads {SCHEMA}.",
            remedy="Use the version of Surmount that wrote it.",
        )
    return record
