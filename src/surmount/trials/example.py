"""Trials that come with the package, to try the analysis on."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from surmount.trials.table import read_trials
from surmount.trials.trials import Trials


def example_path() -> Path:
    """Return the file of :func:`load_example`."""
    return Path(str(files("surmount"))) / "trials" / "data" / "step.parquet"


def load_example() -> Trials:
    """Return 720 trials of the robot RSTAR before steps of 21 to 50 mm.

    Three networks, each after a million learning steps on all heights, tried eight times on each
    height from the same start (settings *P, friction 1.3* of ``docs/results/calibration``). Of each
    trial every tenth step of 10 ms and the last one are kept, with time, sprawl, FBEM and distance
    to the target.
    """
    return read_trials(example_path())
