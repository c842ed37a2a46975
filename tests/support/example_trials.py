"""Trials of a made-up robot, for tests that need any table of trials."""

from __future__ import annotations

import numpy as np

from surmount.trials.trials import Trials


def two_behaviours() -> Trials:
    """Return trials in which narrow variants are passed slowly and wide ones fast."""
    rng = np.random.default_rng(0)
    variants, repetitions, steps = np.arange(8.0), 4, 40
    trials = len(variants) * repetitions
    variant = np.repeat(variants, repetitions)
    speed = np.where(variant < 4, 1.0, 5.0)
    time = np.tile(np.arange(steps) * 0.1, trials)
    place = np.repeat(speed, steps) * time + rng.normal(0, 0.1, trials * steps)
    return Trials(
        parameters=("width_mm",),
        feature_names=("time_s", "place_m"),
        variant=variant[:, None],
        network=np.zeros(trials, dtype=np.int64),
        repetition=np.tile(np.arange(repetitions), len(variants)),
        success=variant >= 4,
        starts=np.arange(trials + 1) * steps,
        features=np.stack([time, place], axis=1),
    )
