"""What was practised, level by level, counted by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
from trainings import training
from two_levels import CURRICULUM, taught

from surmount.report.sections.exposure import exposure, exposure_blocks
from surmount.tasks.regions import Regions

REGIONS = Regions.of(CURRICULUM)
# The first level is left at 2,000 steps, the second ends at 4,000.
EASY = [(100, True)] * 6 + [(2_500, True)] * 1
DIFFICULT = [(1_500, False)] * 2 + [(3_000, False)] * 3


def with_lengths(network, easy_length, difficult_length):
    lengths = np.where(network.record.tasks[:, 0] < 10.2, easy_length, difficult_length)
    record = dataclasses.replace(network.record, length=lengths.astype(np.int64))
    return dataclasses.replace(network, record=record)


def plain(cells):
    return [cell.replace("\u202f", " ").replace("\xa0", " ") for cell in cells]


def test_episodes_and_their_steps_are_counted_by_level_and_group():
    network = with_lengths(taught(EASY, DIFFICULT), 10, 100)
    episodes, steps = exposure([network, network], REGIONS, 2)
    assert episodes.tolist() == [[12, 4], [2, 6]]
    assert steps.tolist() == [[120, 400], [20, 600]]


def test_tasks_between_groups_and_trainings_without_a_record_are_left_out():
    network = taught(EASY, DIFFICULT)
    record = dataclasses.replace(network.record, tasks=np.full_like(network.record.tasks, 10.2))
    between = dataclasses.replace(network, record=record)
    episodes, _ = exposure([between, training(np.zeros(9))], REGIONS, 2)
    assert not episodes.any()


def test_the_table_has_the_levels_all_of_them_and_the_control():
    network = with_lengths(taught(EASY, DIFFICULT), 10, 100)
    control = dataclasses.replace(network, level_tests=())
    (table,) = exposure_blocks({0: network}, {0: control}, CURRICULUM)
    assert [plain(row) for row in table.rows] == [
        ["level 1, easy", "75 % (23 %)", "25 % (77 %)"],
        ["level 2, difficult", "25 % (3 %)", "75 % (97 %)"],
        ["all levels", "58 % (12 %)", "42 % (88 %)"],
        ["control, uniform", "58 % (12 %)", "42 % (88 %)"],
    ]


def test_before_a_level_has_been_practised_there_is_no_table():
    assert exposure_blocks({}, {}, CURRICULUM) == []
    without = dataclasses.replace(CURRICULUM, levels=())
    assert exposure_blocks({0: taught(EASY, DIFFICULT)}, {}, without) == []
