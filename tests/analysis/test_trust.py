"""What is said about how far to trust a grouping, against the numbers it rests on."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from synthetic_trials import SyntheticFamily

from surmount import Analysis, AnalysisConfig, determine_curriculum
from surmount.analysis.explanation import explain_analysis
from surmount.analysis.reference import check_hellinger
from surmount.analysis.trust import describe_trust, is_stable, unstable_parts

FAMILY = SyntheticFamily(sizes=(4, 4), behaviours=(0, 1), separation=10.0, trials=10, steps=50)
CONFIG = AnalysisConfig(
    components=3, restarts=1, bootstrap=10, bootstrap_samples=200, check_distances=True
)


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return determine_curriculum(FAMILY.generate(), CONFIG)


def shaken(analysis: Analysis, **changes) -> Analysis:
    """The analysis with another outcome of its bootstrap."""
    stability = dataclasses.replace(analysis.stability, **changes)
    return dataclasses.replace(analysis, stability=stability)


def test_clear_groups_are_called_stable_with_their_numbers(analysis: Analysis):
    assert is_stable(analysis)
    text = " ".join(describe_trust(analysis))
    assert "is stable" in text
    assert "10 times, the number of groups was 2 in 100%" in text
    same = sum(row.agreement > 1 - 1e-9 for row in analysis.sensitivity if row.choice != "networks")
    choices = sum(row.choice != "networks" for row in analysis.sensitivity)
    assert f"{same} of {choices} times the groups are the same" in text
    assert "these groups: 0 2 groups (1.00), 1 2 groups (1.00)" in text


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"same_count": 0.5, "group_counts": ((2, 0.5), (3, 0.5))}, "number of groups"),
        ({"boundaries": np.array([0, 0, 0, 0.6, 0, 0, 0])}, "boundary between 130 and 140"),
        ({"co_membership": np.full((8, 8), 0.5)}, "does not hold together"),
        ({"co_membership": np.ones((8, 8))}, "is not held apart"),
    ],
)
def test_whatever_too_few_replicates_confirm_is_called_not_stable(analysis, changes, part):
    doubtful = shaken(analysis, **changes)
    assert is_stable(doubtful) is False
    assert "NOT stable" in describe_trust(doubtful)[0]
    explained = "\n".join(explain_analysis(doubtful))
    assert "NOT stable" in explained
    assert any(part in sentence for sentence in unstable_parts(doubtful, doubtful.stability))


def test_without_a_bootstrap_nothing_is_claimed(analysis: Analysis):
    unknown = dataclasses.replace(analysis, stability=None, sensitivity=())
    assert is_stable(unknown) is None
    assert "not assessed" in describe_trust(unknown)[0]


def test_trials_of_one_network_are_warned_of():
    trials = FAMILY.generate()
    found = determine_curriculum(trials.select(trials.network == 0), CONFIG)
    assert found.n_networks == 1
    assert any("one network" in warning for warning in found.warnings)


def test_one_group_left_by_merging_is_not_called_a_lack_of_change():
    family = dataclasses.replace(FAMILY, sizes=(2, 6))
    quick = dataclasses.replace(CONFIG, bootstrap=0, sensitivity=False, check_distances=False)
    found = determine_curriculum(family.generate(), quick)
    assert len(found.groups) == 1
    text = " ".join(found.warnings)
    assert "around groups of at most 2 variants (100, 110), which were merged" in text
    assert "No abrupt change" not in text
    kept = determine_curriculum(family.generate(), dataclasses.replace(quick, small_group_size=1))
    assert len(kept.groups) == 2
    alike = dataclasses.replace(FAMILY, sizes=(8,), behaviours=(0,), grading=0.5)
    assert any(
        "No abrupt change" in warning
        for warning in determine_curriculum(alike.generate(), quick).warnings
    )


def ordered(successes: dict[int, int]) -> tuple[list[str], list[str]]:
    """Names of the groups by rank, and warnings, where so many trials of each variant succeed."""
    trials = FAMILY.generate()
    won = np.zeros(trials.n_trials, dtype=bool)
    for variant, count in successes.items():
        won[np.flatnonzero(trials.variant[:, 0] == variant)[:count]] = True
    quick = dataclasses.replace(CONFIG, bootstrap=0, sensitivity=False, check_distances=False)
    found = determine_curriculum(dataclasses.replace(trials, success=won), quick)
    first = [f"{group.name} {group.variants[0, 0]:g}" for group in found.groups]
    return first, [text for text in found.warnings if "easier" in text]


def test_an_order_of_groups_that_success_does_not_tell_is_warned_of():
    names, warnings = ordered({})
    assert names == ["easy 100", "difficult 140"]
    assert len(warnings) == 1
    assert "No trial succeeded in the groups easy and difficult" in warnings[0]
    names, warnings = ordered({170: 1})  # one trial turns the curriculum round
    assert names == ["easy 140", "difficult 100"]
    assert len(warnings) == 1
    assert "1 of 40 and 0 of 40 trials succeeded" in warnings[0]
    assert "p = 1.00" in warnings[0]


def test_an_order_that_success_tells_or_that_has_no_level_is_not_warned_of():
    # Of 40 and 40 trials: 2 C(40, 6) / C(80, 6) = 0.026, and 2 C(40, 5) / C(80, 5) = 0.055.
    assert ordered({100: 6})[1] == []
    assert len(ordered({100: 5})[1]) == 1
    everything = dict.fromkeys(range(100, 180, 10), 20)
    assert ordered(everything | {170: 19})[1] == []


def test_checked_distances_are_those_of_pairs_and_their_errors_are_told(analysis: Analysis):
    check = analysis.check
    pair = check_hellinger(analysis.mixtures[5], analysis.mixtures[2], seed=CONFIG.seed)
    assert check.reference[5, 2] == check.reference[2, 5] == pair.reference
    assert check.standard_error[5, 2] == pair.standard_error
    error = np.abs(analysis.distances - check.reference)
    assert error.max() < 0.1  # docs/results/unscented-hellinger.md: K = 3 is between 1 and 4
    text = "\n".join(explain_analysis(analysis))
    assert f"by {error.max():.4f} at most" in text
    assert ("distances", "reference") in {(row.choice, row.value) for row in analysis.sensitivity}
    again = Analysis.from_record(json.loads(json.dumps(analysis.to_record())))
    np.testing.assert_array_equal(again.check.reference, check.reference)
