"""What a run's output folder holds and what its stages are called.

The experiment writes by these names and the report reads by them; neither imports the other.
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

ARMS = ("curriculum", "control")
"""The two ways of going on from an initial network."""
TRAININGS = ("initiation", *ARMS)
"""Stages that train, one per network."""
TRIALS = {"initiation": "trials", "curriculum": "test-curriculum", "control": "test-control"}
"""Stages that roll out what was trained, one per network."""
ANALYSIS = "analysis"
STATISTICS = "statistics"


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
