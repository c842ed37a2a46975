"""The score of settings by the likelihood of the paper's printed success."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.rstar.course.obstacles import find_obstacle
from surmount.studies.calibration import SCORED, printed_count, reason_out, score, total_score
from surmount.studies.initiation_map import group_success

SIZES = find_obstacle("step").variants
TRIALS = 4


@pytest.mark.parametrize(
    ("rate", "variants"), [(0.94, 13), (0.19, 13), (0.0, 4), (0.99, 9), (0.76, 9)]
)
def test_printed_shares_stand_for_exactly_the_counts_that_round_to_them(rate, variants):
    total = 2 * 30 * variants
    percent = round(100 * rate)
    printed = {percent} if percent else {0, 1}
    fits = [count for count in range(total + 1) if round(100 * count / total) in printed]
    found = printed_count(rate, variants, networks=2)
    assert (found.low, found.high) == (fits[0], fits[-1])
    assert found.trials == 30 * variants


def test_a_printed_share_of_another_number_of_networks_is_refused():
    with pytest.raises(ValueError, match="two networks"):
        printed_count(0.5, 4, networks=3)


def test_the_channel_is_not_scored_because_its_groups_are_assumed():
    assert SCORED == ("low-entrance", "step")


def test_a_score_tells_group_by_group_what_it_is_made_of():
    rates = np.array([[1.0, 0.25, 0.0], [0.75, 0.0, 0.0]])
    of_size = rates[:, [0] * 13 + [1] * 13 + [2] * 4]
    found = score("step", SIZES, np.rint(of_size * TRIALS).astype(np.int64), TRIALS)
    easy, medium, difficult = found["groups"]
    assert easy["mean"] == pytest.approx(0.875)
    assert easy["spread"] == pytest.approx(np.std([1.0, 0.75], ddof=1))
    assert (medium["paper_counts"], medium["paper_trials"]) == ([145, 152], 780)
    assert (difficult["paper_counts"], difficult["paper_trials"]) == ([0, 3], 240)
    least = min(group["probability"] for group in found["groups"])
    assert found["log_likelihood"] < np.log(least)
    assert score("step", SIZES, np.zeros((1, 30), np.int64), TRIALS)["groups"][0]["spread"] is None


def test_the_total_is_the_sum_over_the_obstacles_with_a_score():
    step, entrance = ({"score": {"log_likelihood": value}} for value in (-7.0, -4.0))
    assert total_score({"step": step, "low-entrance": entrance, "narrow-channel": {}}) == -11.0
    assert total_score({"narrow-channel": {}}) is None


def test_one_network_below_half_of_the_easy_step_puts_a_setting_out():
    success = np.where(SIZES <= 33, 1.0, 0.0) * np.array([[1.0], [6.4 / 13], [0.5]])

    def found(rows):
        groups = group_success("step", SIZES, success[rows])
        return {"step": {"networks": rows, "groups": groups}}

    assert reason_out(found([0, 2])) is None
    assert reason_out(found([0, 1])) == "network 1 succeeds in 49 % on 21–33 mm, below 50 %"
    assert reason_out({"low-entrance": {}}) is None
