"""Teachers compared on an environment of somebody: equal budgets, counted from what happened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from plain_run import run
from small import SMALL, Watcher, small_config

from surmount.core.configuration import override
from surmount.core.errors import OutputError
from surmount.core.records import read_record
from surmount.experiment.config import fingerprinted
from surmount.experiment.learning_speed import steps_to_95, success_in_training
from surmount.experiment.presets import preset
from surmount.experiment.running import begin, refuse_other
from surmount.experiment.teaching import comparison_graph, training_stage, with_earlier
from surmount.experiment.teaching import test_stage as stage_of_test
from surmount.learn.training_episodes import TrainingEpisodes
from surmount.report.teachers_page import write_teachers_report
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.evidence import bootstrap_interval
from surmount.tasks.curriculum import Box, Curriculum, Group
from surmount.teachers.catalogue import TEACHERS, TeachersConfig
from surmount.trials.table import read_trials
from surmount.workflow.executors import make_executor

OWN = {key: value for key, value in SMALL.items() if not key.startswith("env.")}
TEACHING = override(TeachersConfig(), {"alp_gmm.fit_episodes": 20})


def call(root, config, teachers):
    begin(root, config)
    watcher = Watcher()
    executor = make_executor(0, watcher.listen)
    graph = comparison_graph(config, teachers, TEACHING)
    return run(root, config, executor, watcher, stages=graph), watcher


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    root = tmp_path_factory.mktemp("compared")
    config = override(preset("own_point:make_env", "smoke"), OWN)
    outcome, watcher = call(root, config, ("plr",))
    return root, config, outcome, watcher


def record_of(outcome):
    return read_record(outcome.artefacts["teachers"].path("teachers.json"))


def test_the_whole_protocol_runs_on_somebodys_own_environment(compared):
    _, _, outcome, _ = compared
    trials = read_trials(outcome.artefacts["trials/network-0"].path("trials.parquet"))
    variants, index = trials.variants()
    assert trials.parameters == ("distance_m", "wind")
    assert len(variants) == 12
    assert np.bincount(index).tolist() == [2] * 12
    assert trials.feature_names == ("time_s", "position_m")
    statistics = read_record(outcome.artefacts["statistics"].path("statistics.json"))
    assert statistics["cap_s"] == pytest.approx(12 / 20)  # steps at 20 per second


def test_every_teacher_trains_as_long_as_the_papers_from_the_same_networks(compared):
    _, _, outcome, _ = compared
    record = record_of(outcome)
    assert [teacher["name"] for teacher in record["teachers"]] == ["paper", "uniform", "plr"]
    steps = [teacher["steps"] for teacher in record["teachers"]]
    assert steps[0] == steps[1] == steps[2]
    assert min(steps[0]) > 0


def test_scores_and_what_was_sampled_are_counted_from_the_files(compared):
    _, _, outcome, _ = compared
    record = record_of(outcome)
    for teacher in record["teachers"]:
        name = teacher["name"]
        for network in range(2):
            artefact = outcome.artefacts[stage_of_test(name, network)]
            trials = read_trials(artefact.path("trials.parquet"))
            assert trials.success.mean() == pytest.approx(np.mean(teacher["success"][network]))
        episodes = [
            pl.read_parquet(outcome.artefacts[training_stage(name, i)].path("episodes.parquet"))
            for i in range(2)
        ]
        assert np.sum(teacher["sampled"]) == sum(len(table) for table in episodes)
        scores = np.array(teacher["success"])
        whole = bootstrap_interval(scores, Bootstrap(seed=0))
        assert teacher["interquartile_mean"]["estimate"] == pytest.approx(whole.estimate)
    assert record["teachers"][2]["against"].keys() == {"paper", "uniform"}


def test_another_teacher_is_added_without_repeating_anything(compared):
    root, config, _, _ = compared
    outcome, watcher = call(root, config, ("plr", "alp-gmm"))
    assert set(watcher.started) == {
        *(training_stage("alp-gmm", network) for network in range(2)),
        *(stage_of_test("alp-gmm", network) for network in range(2)),
        "teachers",
    }
    page = write_teachers_report(record_of(outcome), root)
    text = page.read_text(encoding="utf-8")
    assert "prioritised level replay (Jiang et al. 2021)" in text
    assert "Too few networks" in text
    sure = [
        duel["mean_difference"]
        for teacher in record_of(outcome)["teachers"]
        for duel in teacher["against"].values()
        if duel["mean_difference"]["lower"] is not None
        and not duel["mean_difference"]["lower"] <= 0 <= duel["mean_difference"]["upper"]
    ]
    assert ("every paired interval includes zero" in text) == (not sure)
    assert (root / "figures" / "teachers-sampled.csv").is_file()


def test_fewer_teachers_keep_those_that_are_finished(compared):
    root, config, _, _ = compared
    call(root, config, ("plr", "alp-gmm"))
    names, teaching = with_earlier(root, ("plr",), TeachersConfig())
    assert names == ("plr", "alp-gmm")
    assert teaching.alp_gmm == TEACHING.alp_gmm  # as it was taught, or it would be taught again
    assert with_earlier(root / "nowhere", ("plr",), TEACHING) == (("plr",), TEACHING)


def test_a_changed_file_of_the_environment_is_another_experiment(tmp_path):
    config = fingerprinted(override(preset("own_point:make_env", "smoke"), OWN))
    begin(tmp_path, config)
    refuse_other(tmp_path, config)
    with pytest.raises(OutputError, match="has changed since the run"):
        refuse_other(tmp_path, replace(config, fingerprint="0" * 64))


def test_settings_of_one_teacher_repeat_no_other():
    config = small_config("step")
    other = override(TEACHING, {"plr.temperature": 0.5})
    graphs = [comparison_graph(config, ("plr", "alp-gmm"), each) for each in (TEACHING, other)]
    changed = [one.name for one, two in zip(*graphs, strict=True) if one.config != two.config]
    assert changed == ["teach/plr/network-0", "teach/plr/network-1", "teachers"]


def test_success_in_training_is_that_of_the_newest_episodes():
    steps = np.arange(1, 101)
    success = steps > 50
    rates = success_in_training(steps, success, np.array([5, 50, 60, 100]))
    np.testing.assert_allclose(rates, [0.0, 0.0, 10 / 30, 1.0])


def test_a_group_is_learnt_when_its_own_newest_episodes_succeed():
    curriculum = Curriculum(
        parameters=("height_mm",),
        groups=tuple(
            Group(
                name=name,
                variants=np.array([[low], [high]]),
                success_rate=0.5,
                boxes=(Box(lower=np.array([low]), upper=np.array([high]), weight=1.0),),
            )
            for name, low, high in (("easy", 20.0, 30.0), ("hard", 31.0, 40.0))
        ),
        levels=(),
        success_threshold=0.9,
    )

    def training(learnt: int) -> TrainingEpisodes:
        # Easy and hard by turns; easy succeeds always, hard from a learning step on.
        steps = np.arange(1, 4001)
        tasks = np.where(steps % 2, 25.0, 35.0)
        return TrainingEpisodes(
            budget=4000,
            steps=steps,
            tasks=tasks[:, None],
            success=(tasks < 30) | (steps > learnt),
            reward=np.zeros(steps.size),
            length=np.ones(steps.size, dtype=np.int64),
        )

    easy, hard = steps_to_95([training(1000), training(4000)], curriculum)
    # 40 moments, every 100 steps: of the first, 50 episodes are of either group.
    assert easy.first_steps == (100.0, 100.0)
    # The newest 30 of the hard group take 60 steps: at 1,100 all of them come after step 1,000.
    assert hard.first_steps == (1100.0, None)
    assert (hard.n_reached, hard.n_networks) == (1, 2)


@pytest.mark.slow
def test_every_teacher_of_the_catalogue_trains_on_the_step(tmp_path):
    outcome, _ = call(tmp_path, small_config("step"), tuple(TEACHERS))
    record = record_of(outcome)
    assert [teacher["name"] for teacher in record["teachers"]] == [*TEACHERS]
    assert len({tuple(teacher["steps"]) for teacher in record["teachers"]}) == 1
