"""What a run's page says of level tests, by either measure and of runs made by the earlier rule."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from types import SimpleNamespace

import numpy as np
import pytest
from run_builder import RunBuilder
from trainings import TEST, training

from surmount.core.records import read_record, sealed, write_record
from surmount.learn.training_episodes import TrainingEpisodes
from surmount.report.document.parts import Notice, Paragraph, Table
from surmount.report.figures.learning import learning_curves
from surmount.report.results import read_run
from surmount.report.sections.level_tests import level_tests
from surmount.teachers.teacher import LevelTest

NAMES = ("measure", "first_episodes", "last_episodes", "rule")
PUBLISHED = {
    "level": 1, "iteration": 0, "steps": 1_115_136, "first_window": 22.91, "last_window": 19.17,
    "first_gain": -3.738, "newest_gain": -3.738, "ratio": None, "threshold": 0.1,
    "decision": "advance", "sentence": "so the newest gain decides; passed",
}  # fmt: skip
"""Network 0's second level of root seed 2028, as it was recorded."""


def shown(*tests, reward=None, length=1):
    """Return text, warnings and the first table of one network's tests."""
    taught = training(np.zeros(20), tests)
    if reward is not None:
        count = reward.size
        record = TrainingEpisodes(
            budget=count, steps=np.arange(1, count + 1), tasks=np.zeros((count, 1)),
            success=reward > 0, reward=reward, length=np.full(count, length),
        )  # fmt: skip
        taught = dataclasses.replace(taught, record=record)
    results = SimpleNamespace(
        trainings={"curriculum": {0: taught}},
        folder=SimpleNamespace(
            config={"advancement": {"window_steps": 5_000}, "learner": {"num_envs": 9}}
        ),
    )
    blocks = level_tests(results)
    (intro,) = (block.text for block in blocks if isinstance(block, Paragraph))
    notices = [block for block in blocks if isinstance(block, Notice)]
    table = next(block for block in blocks if isinstance(block, Table))
    headings = [column.heading for column in table.columns]
    return intro, notices, [dict(zip(headings, row, strict=True)) for row in table.rows]


def test_a_test_by_episodes_shows_how_many_which_rule_and_its_noise():
    first = dataclasses.replace(
        TEST, first_window=1.0, last_window=3.0, first_gain=2.0, newest_gain=2.0, ratio=1.0,
        decision="extend", measure="episode", first_episodes=4, last_episodes=6, rule="first test",
    )  # fmt: skip
    second = dataclasses.replace(
        first, iteration=1, first_window=None, last_window=None, newest_gain=None, ratio=None,
        first_episodes=0, last_episodes=0, rule="no gain",
    )  # fmt: skip
    # Rewards of 0 and 6 by turns: each difference is 6, so one episode has a deviation of √18.
    intro, notices, rows = shown(first, second, reward=np.tile([0.0, 6.0], 20))
    assert "mean rewards of the episodes that ended within" in intro
    assert "never passes" in intro
    assert [(row["rF"], row["rL"], row["decided by"]) for row in rows] == [
        ("1 (4)", "3 (6)", "first test"),
        ("— (0)", "— (0)", "no gain"),
    ]
    assert float(rows[0]["by chance"].removeprefix("± ")) == pytest.approx(
        np.sqrt(18 * (1 / 4 + 1 / 6)), rel=0.005
    )
    assert rows[1]["by chance"] == rows[1]["newest gain"] == "—"
    (notice,) = notices
    assert "In 1 of 1 level" in notice.sentences[0]
    assert "held 2 episodes (median)" in notice.sentences[1]  # of 4, 6, 0 and 0


def test_a_first_window_that_long_episodes_cannot_end_in_is_warned_of():
    first = dataclasses.replace(
        TEST, level=0, first_gain=-2.0, newest_gain=-2.0, decision="extend", measure="episode",
        first_episodes=4, last_episodes=6, rule="first test",
    )  # fmt: skip
    reward = np.tile([0.0, 6.0], 20)
    fits, too_long = (shown(first, reward=reward, length=steps)[1] for steps in (555, 2_000))
    assert [notice.title for notice in fits] == ["Level tests decided by chance"]
    notice = too_long[0]
    assert "the quickest episodes alone" in notice.title
    assert "555 steps in each of 9 environments" in notice.sentences[0]
    assert "zero or less in 1 of 1 network" in notice.sentences[0]
    assert "18,000 learning steps" in notice.sentences[1].replace("\u202f", ",")


def test_a_record_of_the_earlier_rule_is_read_and_told_as_what_it_was():
    old = LevelTest(**PUBLISHED)
    assert (old.measure, old.rule, old.first_episodes) == ("step", None, None)
    intro, _, (row,) = shown(old)
    assert "sum the reward" in intro
    assert "eq. 5 as printed passes none there" in intro
    assert (row["rF"], row["ratio"], row["decided by"], row["decision"]) == (
        "22.91", "undefined", "—", "advance",
    )  # fmt: skip


def test_a_run_folder_with_records_of_the_earlier_rule_is_read_whole(tmp_path):
    RunBuilder(tmp_path).whole()
    for path in tmp_path.glob("stages/curriculum/**/training.json"):
        record = read_record(path)
        assert all(test.keys() >= set(NAMES) for test in record["level_tests"])
        tests = [
            {name: value for name, value in test.items() if name not in NAMES}
            for test in record["level_tests"]
        ]
        path.write_text(json.dumps(record | {"level_tests": tests}), encoding="utf-8")
        manifest = path.with_name("manifest.json")
        assert manifest.exists()
        _reseal(manifest, path)
    found = read_run(tmp_path).trainings
    tests = [test for one in found["curriculum"].values() for test in one.level_tests]
    assert {test.measure for test in tests} == {"step"}
    assert {test.rule for test in tests} == {None}
    assert not any("mean rewards of episodes" in line for line in _caption(found))


def test_the_figure_of_rewards_says_that_eq_5_compares_those_of_episodes(reported):
    found = read_run(reported.root).trainings
    assert any("eq. 5 compares mean rewards of episodes" in line for line in _caption(found))


def _caption(trainings) -> tuple[str, ...]:
    figure = learning_curves(trainings, "reward")
    assert figure is not None
    return figure.caption


def _reseal(manifest, path) -> None:
    record = json.loads(manifest.read_text(encoding="utf-8"))
    assert path.name in record["files"]
    record["files"][path.name] = hashlib.sha256(path.read_bytes()).hexdigest()
    write_record(manifest, sealed(record))
