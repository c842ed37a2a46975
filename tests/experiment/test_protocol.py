"""The protocol runs from end to end, and gives the same bytes however it is run."""

from __future__ import annotations

import random
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from small import content, run_small, small_config

from surmount.core.errors import ConfigError, OutputError
from surmount.core.records import read_record
from surmount.experiment.protocol import protocol
from surmount.experiment.running import begin, load_config
from surmount.rstar.course import scene
from surmount.studies.initiation_map import Setting, initiation_stages
from surmount.tasks.curriculum import Curriculum
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials
from surmount.workflow.graph import check_graph

SUPPORT = Path(__file__).parents[1] / "support"


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    root = tmp_path_factory.mktemp("run")
    outcome, watcher = run_small(root, small_config())
    assert not outcome.interrupted
    return root, outcome, watcher


def stage_file(outcome, stage: str, name: str) -> Path:
    return outcome.artefacts[stage].path(name)


def trials_of_arm(outcome, arm: str) -> Trials:
    return Trials.concatenate(
        [read_trials(stage_file(outcome, f"test-{arm}/network-{i}", "trials.parquet"))
         for i in range(2)]
    )  # fmt: skip


def test_every_stage_of_the_method_is_run(finished):
    _, outcome, _ = finished
    per_network = ["initiation", "trials", "curriculum", "control", "test-curriculum",
                   "test-control"]  # fmt: skip
    expected = {f"{kind}/network-{i}" for kind in per_network for i in range(2)}
    assert outcome.artefacts.keys() == expected | {"analysis", "statistics", "evidence"}


def test_trials_cover_every_variant_and_repetition_of_every_network(finished):
    _, outcome, _ = finished
    for network in range(2):
        trials = read_trials(stage_file(outcome, f"trials/network-{network}", "trials.parquet"))
        variants, index = trials.variants()
        assert variants[:, 0].tolist() == list(range(180, 321, 10))  # method 2: 15 widths
        assert np.bincount(index).tolist() == [2] * 15
        assert (trials.network == network).all()
        assert (trials.final("time_s") <= 2.0 + 1e-9).all()


def test_control_trains_exactly_as_long_as_the_curriculum(finished):
    _, outcome, _ = finished
    for network in range(2):
        steps = {
            arm: read_record(stage_file(outcome, f"{arm}/network-{network}", "training.json"))
            for arm in ("curriculum", "control")
        }
        assert steps["control"]["steps"] == steps["curriculum"]["steps"] > 0
        assert steps["curriculum"]["level_tests"]
        assert not steps["control"]["level_tests"]


def test_statistics_count_what_the_trials_hold(finished):
    _, outcome, _ = finished
    statistics = read_record(stage_file(outcome, "statistics", "statistics.json"))
    curriculum = Curriculum.load(stage_file(outcome, "analysis", "curriculum.json"))
    for arm in ("curriculum", "control"):
        trials = trials_of_arm(outcome, arm)
        rows = statistics["success_by_variant"][arm]
        for row in rows:
            chosen = trials.variant[:, 0] == row["variant"][0]
            assert row["trials"] == chosen.sum()
            assert row["successes"] == trials.success[chosen].sum()
        for group, compared in zip(curriculum.groups, statistics["groups_compared"], strict=True):
            chosen = np.isin(trials.variant[:, 0], group.variants[:, 0])
            assert compared["arms"][arm] == {
                "successes": trials.success[chosen].sum(),
                "trials": chosen.sum(),
            }
            assert compared["survival"][arm]["n_events"] == trials.success[chosen].sum()


def test_a_second_call_runs_nothing(finished):
    root, outcome, _ = finished
    again, watcher = run_small(root, small_config())
    assert watcher.started == []
    assert again.artefacts == outcome.artefacts


def test_a_deleted_stage_is_made_again_and_the_rest_kept(finished, tmp_path):
    root, _, _ = finished
    copy = tmp_path / "copy"
    shutil.copytree(root, copy)
    shutil.rmtree(copy / "stages" / "test-control" / "network-1")
    _, watcher = run_small(copy, small_config())
    assert watcher.started == ["test-control/network-1"]
    assert content(copy) == content(root)


HANGING_S = 1800.0
"""Whoever waits longer waits in vain: far more than the slowest machine takes."""


def killed_run(root: Path, moment: Callable[[], bool]) -> bool:
    """Kill the run, in a process of its own, when the moment has come; false if it ended first."""
    program = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from pathlib import Path\n"
        "from small import run_small, small_config\n"
        "if __name__ == '__main__':\n"
        "    run_small(Path(sys.argv[2]), small_config(), processes=2)\n"
    )
    script = root.parent / "small_run.py"
    script.write_text(program, encoding="utf-8")
    process = subprocess.Popen(  # noqa: S603
        [sys.executable, str(script), str(SUPPORT), str(root)], stdout=subprocess.PIPE
    )
    given_up = time.monotonic() + HANGING_S
    while process.poll() is None and not moment() and time.monotonic() < given_up:
        time.sleep(0.005)
    killed = process.poll() is None
    process.kill()
    # Its output ends when the last worker, which has it too, has noticed that its parent is gone.
    process.communicate(timeout=HANGING_S)
    return killed


def test_two_processes_killed_while_they_train_resume_to_the_same_bytes_as_none(finished, tmp_path):
    root, _, _ = finished
    killed = tmp_path / "killed"
    assert killed_run(killed, lambda: any(killed.glob("checkpoints/**/*.safetensors")))
    assert len(content(killed)) < 4  # both networks were being trained
    outcome, _ = run_small(killed, small_config(), processes=2)
    assert not outcome.interrupted
    assert content(killed) == content(root)


@pytest.mark.slow
def test_a_run_killed_again_between_stages_resumes_to_the_same_bytes(finished, tmp_path):
    root, _, _ = finished
    killed = tmp_path / "killed"
    assert killed_run(killed, lambda: any(killed.glob("checkpoints/**/*.safetensors")))
    assert len(content(killed)) < 4
    assert killed_run(killed, lambda: len([*killed.glob("stages/**/manifest.json")]) >= 4)
    assert len(content(killed)) < len(content(root))
    outcome, _ = run_small(killed, small_config())
    assert not outcome.interrupted
    assert content(killed) == content(root)


@pytest.mark.slow
def test_ten_kills_at_random_moments_change_nothing(finished, tmp_path):
    root, _, _ = finished
    killed = tmp_path / "killed"
    rng = random.Random(0)  # noqa: S311
    for _ in range(10):
        moment_s = time.monotonic() + rng.uniform(3.0, 12.0)
        killed_run(killed, lambda moment_s=moment_s: time.monotonic() > moment_s)
    run_small(killed, small_config())
    assert content(killed) == content(root)


def test_another_configuration_in_the_folder_is_refused_with_the_difference(finished):
    root, _, _ = finished
    with pytest.raises(OutputError, match=r"`initial_steps` is 600 there and 900 here") as caught:
        begin(root, small_config(initial_steps=900))
    assert "--resume" in caught.value.remedy


def test_a_folder_with_other_files_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work", encoding="utf-8")
    with pytest.raises(OutputError, match="not of an experiment"):
        begin(tmp_path, small_config())
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_the_configuration_is_read_back_from_the_folder(finished):
    root, _, _ = finished
    assert load_config(root) == small_config()


def test_shards_of_trials_have_seeds_of_their_own_and_together_every_repetition():
    config = small_config(rollout_shards=3, **{"trials.repetitions": 5, "tests.repetitions": 3})
    graph = {stage.name: stage for stage in protocol(config)}
    assert check_graph(graph.values())
    (analysis,) = (stage for stage in graph.values() if stage.name == "analysis")
    for name in analysis.inputs["trials"]:
        shards = [graph[shard] for shard in graph[name].inputs["shards"]]
        counts = [shard.config["trials"]["repetitions"] for shard in shards]
        firsts = [shard.config["first_repetition"] for shard in shards]
        assert (counts, firsts) == ([2, 2, 1], [0, 2, 4])
    seeds = [stage.seed for stage in graph.values()]
    assert len(set(seeds)) == len(seeds)


@pytest.mark.parametrize(
    ("obstacle", "changes", "harder"),
    [
        ("step", {}, [1]),
        ("narrow-channel", {}, [-1]),
        ("step", {"analysis.harder": [-1]}, [-1]),
    ],
)
def test_the_analysis_is_told_the_direction_of_difficulty(obstacle, changes, harder):
    graph = protocol(small_config(obstacle, **changes))
    (analysis,) = (stage for stage in graph if stage.name == "analysis")
    assert analysis.config["analysis"]["harder"] == harder


def test_one_shard_leaves_every_stage_as_it_was():
    config = small_config()
    assert config.rollout_shards == 1
    assert not any(stage.name.startswith("shard/") for stage in protocol(config))


ONE_SETTING = Setting(name="plain", changes={}, obstacles=("step",), networks=(0,))


@pytest.mark.parametrize(
    "graph",
    [lambda: protocol(small_config()), lambda: initiation_stages([ONE_SETTING], "smoke")],
    ids=["protocol", "initiations"],
)
def test_another_model_of_the_robot_is_another_experiment(monkeypatch, graph):
    # No setting says how contacts give way: results of two versions must not be mixed.
    before = graph()
    monkeypatch.setattr(scene, "CONTACT_IMPEDANCE", (0.9, 0.95, 0.001, 0.5, 2.0))
    scene.model_hash.cache_clear()
    after = graph()
    scene.model_hash.cache_clear()
    changed = {a.name for a, b in zip(before, after, strict=True) if a.config != b.config}
    assert changed == {stage.name for stage in before if "env" in stage.config}
    assert {name.partition("/")[0] for name in changed} >= {"initiation", "trials"}


@pytest.mark.parametrize("shards", [0, 2, 31])
def test_more_shards_than_repetitions_are_refused(shards):
    with pytest.raises(ConfigError, match="rollout_shards"):
        small_config(rollout_shards=shards)  # one repetition in tests


@pytest.mark.parametrize("obstacle", ["low-entrance", "step"])
@pytest.mark.slow
def test_the_protocol_runs_on_the_other_obstacles(tmp_path, obstacle):
    outcome, _ = run_small(tmp_path, small_config(obstacle), processes=2)
    assert not outcome.interrupted
