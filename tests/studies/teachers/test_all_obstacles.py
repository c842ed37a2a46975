"""A comparison on all three obstacles runs with the teachers of the plan, and goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from surmount.cli.main import run
from surmount.core.records import read_record
from surmount.studies.teachers.graph import comparison_stages
from surmount.studies.teachers.plan import read_plan

PUBLISHED = (
    Path(__file__).parents[3] / "docs" / "results" / "teachers" / "plans" / "comparison.toml"
)
PLAN = """
[[task]]
name = "rstar/all"
role = "held out"
teachers = {teachers}
networks = 2
pilot = 2
budget_steps = 4500
[task.common]
initial_steps = 512
checkpoint_steps = 1000
"env.episode_s" = 0.2
"learner.num_envs" = 8
"learner.rollout_steps" = 64
"learner.batch_size" = 256
"learner.epochs" = 1
"learner.hidden_layers" = [8]
"trials.repetitions" = 2
"tests.repetitions" = 1
"analysis.max_components" = 2
"advancement.iteration_steps" = 1024
"advancement.extension_steps" = 512
"advancement.window_steps" = 512
"""


def published():
    return {plan.label: plan for plan in read_plan(PUBLISHED)}["rstar/all"]


def test_the_plan_holds_the_task_with_teachers_that_do_without_distances():
    plan = published()
    assert plan.teachers == (
        "uniform", "paper", "mastery", "frontier", "frontier-cells", "frontier-parameters", "plr",
    )  # fmt: skip
    assert comparison_stages([plan])  # none is refused


@pytest.mark.slow
def test_a_toy_comparison_runs_and_goes_on_where_it_stopped(tmp_path):
    file, out = tmp_path / "plan.toml", tmp_path / "out"
    teachers = list(published().teachers[1:])
    file.write_text(PLAN.format(teachers=teachers), encoding="utf-8")
    command = ["teachers", str(file), "--out", str(out), "--processes", "0"]
    assert run([*command, "--headroom"]) == 0
    assert run(command) == 0
    (task,) = read_record(out / "comparison.json")["tasks"]
    assert len(task["variants"]) == 63
    assert [teacher["name"] for teacher in task["teachers"]] == ["uniform", *teachers]
    assert all(len(teacher["success"]) == 2 for teacher in task["teachers"])
    assert task["headroom"]["networks"] == 2
    logged = (out / "logs" / "run.log").read_text(encoding="utf-8")
    assert logged.count("rstar/all/initiation/network-0: finished") == 1
    assert logged.count("rstar/all/teach/plr/network-1: finished") == 1
    # On another machine, with what this one has measured: nothing is run, and all is judged alike.
    elsewhere = ["teachers", str(file), "--out", str(tmp_path / "elsewhere"), "--processes", "0"]
    assert run([*elsewhere, "--measured", str(out / "comparison.json")]) == 0
    (taken,) = read_record(tmp_path / "elsewhere" / "comparison.json")["tasks"]
    for here, there in zip(task["teachers"], taken["teachers"], strict=True):
        assert there == here | {"elsewhere": [0, 1]}
    assert not (tmp_path / "elsewhere" / "stages").exists()
