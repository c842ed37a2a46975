"""The first line answers by networks; tests over trials speak only where networks agree."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from run_builder import RunBuilder

from surmount.cli.main import run
from surmount.report.answer import OPENING, answer, network_differences, time_differences
from surmount.report.document.text import interval
from surmount.report.results import read_run
from surmount.report.sections.summary import summary
from surmount.report.sections.testing import path_table
from surmount.report.verdicts import group_sentence
from surmount.stats.detectable import detectable_difference
from surmount.stats.differences import network_difference
from surmount.workflow.run_layout import ARMS


@pytest.fixture(scope="module")
def results(reported):
    return read_run(reported.root)


def _with(results, first, second):
    """Return the results with other means of networks, as the statistics would have them."""
    mean = network_difference(first, second, paired=True)
    return dataclasses.replace(
        results, comparison=dataclasses.replace(results.comparison, mean_difference=mean)
    )


def test_the_first_line_gives_the_paired_interval_and_how_many_networks_are_ahead(results):
    found = answer(results)
    first, second = (results.tests[arm].scores().mean(axis=1) for arm in ARMS)
    mean = network_difference(first, second, paired=True)
    assert found.verdict == ("helps" if mean.lower > 0 else "not shown")
    assert f"{100 * mean.estimate:+.1f}".rstrip("0").rstrip(".") in found.effect
    ahead = int((first > second).sum())
    assert found.networks.startswith(f"{ahead} of {first.size} networks")
    assert summary(results)[0] == found.sentences[0]


@pytest.mark.parametrize(
    ("first", "second", "verdict"),
    [
        ([0.9, 0.8, 0.85], [0.1, 0.1, 0.1], "helps"),
        ([0.1, 0.1, 0.15], [0.9, 0.8, 0.85], "harms"),
        ([0.9, 0.1, 0.6], [0.1, 0.5, 0.4], "not shown"),
        ([0.9], [0.1], "not shown"),
    ],
)
def test_the_interval_over_networks_decides(results, first, second, verdict):
    found = answer(_with(results, first, second))
    assert found.verdict == verdict
    assert found.sentences[0].startswith(OPENING[verdict])


def test_what_would_have_been_found_stands_beside_what_is_not_shown(results):
    found = answer(_with(results, [0.9, 0.1, 0.6], [0.1, 0.5, 0.4]))
    differences = network_differences(results)
    least = detectable_difference(differences.std(ddof=1), differences.size).difference
    assert f"A difference of {100 * least:.0f} points would" in found.sentences[0].replace(
        "\xa0", " "
    )


def test_contrasts_of_path_lengths_stand_beside_their_spread_over_networks(results):
    curriculum = results.analysis.curriculum
    (table,) = path_table(results.comparison, curriculum, results.tests)
    shown = {row[:2]: row[4] for row in table.rows}
    arms = [results.tests[arm] for arm in ARMS]
    differences = []
    for network in np.unique(arms[0].network):
        own = [
            t.success & (t.network == network) & (curriculum.groups_of(t.variant) == 0)
            for t in arms
        ]
        means = [t.path_lengths["sprawl_deg"][m].mean() for t, m in zip(arms, own, strict=True)]
        differences.append(means[0] - means[1])
    expected = interval(min(differences), max(differences))
    assert shown["sprawl", curriculum.groups[0].name] == expected


def test_where_every_trial_succeeds_there_was_nothing_to_add(results):
    tests = {
        name: dataclasses.replace(test, success=np.ones_like(test.success))
        for name, test in results.tests.items()
    }
    found = answer(
        dataclasses.replace(results, tests={**results.tests, **{a: tests[a] for a in ARMS}})
    )
    assert found.verdict == "nothing to add"
    assert found.sentences[0].startswith("The curriculum had nothing to add: in the end every")
    one = {**tests, ARMS[1]: results.tests[ARMS[1]]}
    assert answer(dataclasses.replace(results, tests=one)).verdict != "nothing to add"


def test_what_it_rests_on_is_said_with_it(results):
    _, stability, levels = answer(results).sentences
    assert stability.startswith("The grouping is ")
    ends = [test for training in results.trainings["curriculum"].values()
            for test in training.level_tests if test.decision != "extend"]  # fmt: skip
    assert levels.startswith(f"Of {len(ends)} levels that ended")


def test_no_p_value_is_told_where_networks_disagree(results):
    entry = results.comparison.groups[-1]
    alike, times = np.array([0.9, 0.7]), np.array([-1.0, -2.0])
    assert "p < 0.001" in group_sentence(entry, alike, times).replace("\xa0", " ")
    sentence = group_sentence(entry, alike, np.array([-1.0, 2.0]))
    assert "completion time: networks disagree, 1 of 2 sooner and 1 later with it." in sentence
    sentence = group_sentence(entry, np.array([0.9, 0.0]), times)
    assert "success: 1 of 2 networks ahead, 0 behind, 1 alike; completion" in sentence
    apart = group_sentence(entry, np.array([0.9, -0.1]), times)
    assert "networks disagree, 1 of 2 ahead and 1 behind" in apart
    assert "p" not in apart.split(": ", 1)[1].replace("points", "").split()


def test_differences_of_time_count_a_failed_trial_as_the_longest(results):
    first, second = (results.tests[arm] for arm in ARMS)
    longest = max(first.end_s.max(), second.end_s.max())
    own = results.analysis.curriculum.groups_of(first.variant) == 0
    means = [
        [np.mean(np.where(t.success, t.end_s, longest)[own & (t.network == n)]) for n in (0, 1)]
        for t in (first, second)
    ]
    assert np.allclose(time_differences(results, 0), np.subtract(*means))


def test_a_run_that_is_not_finished_leaves_the_question_open(tmp_path):
    builder = RunBuilder(tmp_path)
    builder.initiate()
    assert answer(read_run(tmp_path)).verdict == "open"


def test_show_on_a_finished_run_tells_what_testing_gave(reported, results, capsys):
    assert run(["show", str(reported.root)]) == 0
    told = capsys.readouterr().out
    assert "What testing gave" in told
    assert answer(results).sentences[0] in told


def test_following_a_finished_run_draws_its_page_and_ends(reported, tmp_path, capsys):
    assert run(["report", str(reported.root), "--follow"]) == 0
    assert "Report: " in capsys.readouterr().out
    assert run(["report", str(reported.root), "--follow", "--out", str(tmp_path)]) == 2
