"""How far a level's own group was at its end, counted by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from trainings import training
from two_levels import CURRICULUM, FIRST, taught

from surmount.report.document.parts import Notice, Table
from surmount.report.sections.levels_left import levels_left, levels_left_blocks


def test_only_the_newest_episodes_of_the_own_group_within_the_level_count():
    easy = [(step, step > 500) for step in range(1, 2_001, 10)]  # the newest 50 succeed
    easy += [(3_000, False)] * 60  # after the level
    difficult = [(1_500, True)] * 60  # before its level
    difficult += [(2_500, index < 5) for index in range(20)]
    ends = levels_left(taught(easy, difficult), CURRICULUM)
    assert [(end.level, end.success) for end in ends] == [(0, 1.0), (1, pytest.approx(0.25))]


def test_levels_left_unmastered_are_warned_of_and_too_few_episodes_say_nothing():
    mastered = taught([(100, True)] * 20, [(3_000, True)] * 20)
    (table,) = levels_left_blocks({0: mastered}, CURRICULUM)
    assert isinstance(table, Table)
    assert [cell.replace("\u202f", " ").replace("\xa0", " ") for cell in table.rows[0]] == [
        "0", "100 %", "100 %",
    ]  # fmt: skip
    short = taught([(100, False)] * 20, [(3_000, True)] * 9)
    notice, table = levels_left_blocks({0: mastered, 1: short}, CURRICULUM)
    assert isinstance(notice, Notice)
    assert notice.sentences[0].startswith("1 of 3 levels ended before 95")
    assert levels_left(short, CURRICULUM)[1].success is None


def test_without_a_record_of_episodes_nothing_is_shown():
    unknown = dataclasses.replace(training(np.zeros(9)), level_tests=(FIRST,))
    assert levels_left_blocks({0: unknown}, CURRICULUM) == []
