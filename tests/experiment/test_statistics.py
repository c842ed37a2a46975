"""Both arms are compared as the paper does: failed trials count as unfinished up to the cap."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.experiment.statistics import compare_group
from surmount.stats.logrank import log_rank
from surmount.tasks.curriculum import Box, Curriculum, Group
from surmount.trials.trials import Trials

CAP_S = 20.0
CURRICULUM = Curriculum(
    parameters=("height_mm",),
    groups=(
        Group(
            name="all",
            variants=np.array([[21.0]]),
            success_rate=0.5,
            boxes=(Box(lower=np.array([21.0]), upper=np.array([21.0]), weight=1.0),),
        ),
    ),
    levels=(),
    success_threshold=0.95,
)


def trials(ends_s, success) -> Trials:
    """Return trials of two steps each, which end at these times."""
    count = len(ends_s)
    time = np.stack([np.zeros(count), ends_s], axis=1).ravel()
    return Trials(
        parameters=("height_mm",),
        variant=np.full((count, 1), 21.0),
        network=np.zeros(count, dtype=np.int64),
        repetition=np.arange(count),
        success=np.array(success),
        feature_names=("time_s",),
        features=time[:, None],
        starts=2 * np.arange(count + 1),
    )


def test_a_fall_is_censored_at_the_cap_and_not_when_it_happened():
    won_s = [5.0, 6.0, 7.0, 8.0]
    falls = trials([*won_s, 3.0, 3.5, 4.0, 4.5], [True] * 4 + [False] * 4)
    waits = trials([*won_s, *[CAP_S] * 4], [True] * 4 + [False] * 4)
    found = compare_group({"curriculum": falls, "control": waits}, CURRICULUM, 0, CAP_S)
    # Neither failure says anything of how soon the others finish: the arms are alike.
    assert found["log_rank"]["statistic"] == pytest.approx(0.0, abs=1e-12)
    assert found["survival"]["curriculum"] == found["survival"]["control"]
    early = log_rank(
        [*won_s, 3.0, 3.5, 4.0, 4.5, *won_s, *[CAP_S] * 4],
        [*falls.success, *waits.success],
        np.repeat(["curriculum", "control"], 8),
    )
    assert early.statistic > 1.0  # what an arm that falls would gain by it
