"""Wording: what the tests allow and no more; the paper's numbers as its own tests give them."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.report.document.text import (
    SPACE,
    duration,
    listed,
    number,
    p_value,
    percent,
    variant_range,
)
from surmount.report.verdicts import because, path_verdict, success_verdict, time_verdict
from surmount.stats.logrank import log_rank
from surmount.stats.mixed import MethodContrast
from surmount.stats.proportions import proportion_test
from surmount.studies.paper.results import PAPER_RESULTS


@pytest.mark.parametrize(
    ("won", "verdict"),
    [
        ((29, 5), "more successes with the curriculum"),
        ((5, 29), "fewer successes with the curriculum"),
        ((20, 18), "no difference shown"),
        ((32, 32), "not testable"),
    ],
)
def test_success_is_called_different_only_where_the_test_shows_it(won, verdict):
    assert success_verdict(proportion_test(won, (32, 32))) == verdict


def test_an_undefined_test_gives_its_reason():
    test = proportion_test((0, 0), (5, 5))
    said = because(success_verdict(test), test.p_value, test.reason)
    assert said.startswith("not testable (every trial of both arms failed")
    assert not said.endswith(".)")


@pytest.mark.parametrize(
    ("shift_s", "verdict"),
    [
        (-5.0, "sooner with the curriculum"),
        (5.0, "later with the curriculum"),
        (0.0, "no difference shown"),
    ],
)
def test_completion_is_called_sooner_by_the_arm_that_finishes_sooner(shift_s, verdict):
    time = np.linspace(8, 12, 30)
    test = log_rank(
        np.concatenate([time, time + shift_s]),
        np.ones(60, dtype=bool),
        np.repeat(["control", "curriculum"], 30),
    )
    assert time_verdict(test) == verdict


def test_paths_are_called_shorter_only_below_five_percent():
    def contrast(estimate, p):
        return MethodContrast(
            group="g", method="curriculum", reference="control", estimate=estimate, std_error=1.0,
            degrees_of_freedom=9.0, t=1.0, p_value=p, lower=0.0, upper=0.0, reason=None,
        )  # fmt: skip

    assert path_verdict(contrast(-3.0, 0.049)) == "shorter with the curriculum"
    assert path_verdict(contrast(3.0, 0.049)) == "longer with the curriculum"
    assert path_verdict(contrast(-3.0, 0.05)) == "no difference shown"


def test_the_papers_counts_give_the_papers_chi_square():
    groups = [
        group
        for paper in PAPER_RESULTS.values()
        for group in paper.groups
        if group.chi_square is not None
    ]
    assert len(groups) == 3
    for group in groups:
        (won, tried), (lost_won, lost_tried) = group.curriculum, group.control
        test = proportion_test((won, lost_won), (tried, lost_tried))
        assert test.statistic == pytest.approx(group.chi_square, abs=0.005)  # printed to 2 digits
        assert success_verdict(test) == "more successes with the curriculum"


def test_numbers_are_written_without_losing_what_they_say():
    assert percent(0.999) == f">{SPACE}99{SPACE}%"
    assert percent(0.001) == f"<{SPACE}1{SPACE}%"
    assert percent(1.0) == f"100{SPACE}%"
    assert percent(None) == "—"
    assert p_value(0.0004).replace(SPACE, " ") == "p < 0.001"
    assert p_value(0.0496).replace(SPACE, " ") == "p = 0.0496"  # not 0.05: it is below the level
    assert p_value(0.0502).replace(SPACE, " ") == "p = 0.05"
    written = {
        -3.14159: "−3.14",
        0.0: "0",
        0.000123456: "0.000123",
        999.7: "1,000",
        1234.6: "1,235",
        -22.5: "−22.5",
        12e9: "1.20·10¹⁰",
        2e-7: "2.00·10⁻⁷",
    }
    assert {value: number(value) for value in written} == written
    assert number(809.764, 5) == "809.76"
    assert duration(3725) == "1 h 02 min"
    assert listed(["a", "b", "c"]) == "a, b and c"
    assert variant_range(("height_mm",), np.arange(21.0, 34.0)[:, None]) == f"21–33{SPACE}mm"
