"""Beside the hardest variant a run shows the one on which its arms differ most."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.report.film_choice import ArmsApart, arms_apart, most_apart
from surmount.report.films import FilmedTrial
from surmount.report.sections.film import film_section
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import open_run


@pytest.mark.parametrize(
    ("differences", "difficulty", "chosen"),
    [
        ([0.1, 0.4, 0.2], [1, 2, 3], 1),
        ([0.1, -0.5, 0.2], [1, 2, 3], 1),  # whichever arm is ahead
        ([0.4, 0.0, -0.4], [1, 2, 3], 2),  # of equals the hardest
        ([0.4, 0.0, -0.4], [3, 2, 1], 0),
        ([0.1 + 0.2, 0.3], [2, 1], 0),  # equal but for the last bit
        ([0.4, 0.4, 0.0], [1, 1, 2], 1),  # of equally hard ones the last
        ([0.0, 0.0, 0.0], [1, 2, 3], None),
    ],
)
def test_chosen_is_the_largest_difference_of_equals_the_hardest(differences, difficulty, chosen):
    assert most_apart(np.array(differences), np.array(difficulty, dtype=float)) == chosen


def test_success_is_taken_over_all_networks_and_not_before_all_are_tested(reported):
    run = open_run(reported.root)
    found = arms_apart(run, 2, lambda variants: variants[:, 0])
    means = {}
    for arm in ("curriculum", "control"):
        tables = [
            read_trials(run.stages[f"test-{arm}/network-{network}"].path("trials.parquet"))
            for network in range(2)
        ]
        sizes = np.unique(tables[0].variant)
        means[arm] = np.array(
            [
                np.mean([table.success[table.variant[:, 0] == size].mean() for table in tables])
                for size in sizes
            ]
        )
    gaps = np.abs(means["curriculum"] - means["control"])
    (size,) = found.variant
    (index,) = np.flatnonzero(sizes == size)
    assert gaps[index] == pytest.approx(gaps.max())
    assert not (np.isclose(gaps, gaps.max()) & (sizes > size)).any()
    assert found.curriculum == pytest.approx(means["curriculum"][index])
    assert found.control == pytest.approx(means["control"][index])
    assert arms_apart(run, 3, lambda variants: variants[:, 0]) is None


def test_the_page_says_by_which_rule_each_variant_is_shown():
    apart = ArmsApart(variant=np.array([150.0]), curriculum=0.9, control=0.25)
    films = [
        FilmedTrial(
            kind=kind, variant=variant, rule="the first trial", choice=choice, caption="trial 0",
            outcome="failed", successes=1, trials=2, speed=2.0, mp4=b"", png=b"",
        )
        for variant, choice, kinds in (
            ("The hardest variant, 180 mm", "", ("initiation", "curriculum", "control")),
            ("The variant on which the arms differ most, 150 mm", apart.rule,
             ("curriculum", "control")),
        )
        for kind in kinds
    ]  # fmt: skip
    first, shown, second, beside = film_section(tuple(films)).blocks
    assert (len(shown.films), len(beside.films)) == (3, 2)
    assert first.text.startswith("The hardest variant, 180 mm, after the initiation")
    assert second.text.startswith("The variant on which the arms differ most, 150 mm, with the")
    assert (
        "90\N{NO-BREAK SPACE}% with the curriculum, 25\N{NO-BREAK SPACE}% without it" in second.text
    )
    assert second.text.endswith("of equals the hardest.")
