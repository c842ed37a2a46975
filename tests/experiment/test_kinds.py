"""Stages are known by their kind, and what was finished before there were kinds is found."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import pytest
import toy_stages
from toy_runs import graph, run

from surmount.core.configuration import override
from surmount.core.errors import OutputError
from surmount.core.records import read_record, write_record
from surmount.experiment.config import config_from_record
from surmount.experiment.kinds import KINDS
from surmount.experiment.running import load_config, refuse_other
from surmount.experiment.teaching import comparison_graph
from surmount.teachers.catalogue import TeachersConfig
from surmount.workflow.earlier import up_to_date
from surmount.workflow.graph import Stage, StageKind
from surmount.workflow.run_layout import RUN
from surmount.workflow.store import MANIFEST, Artefact, LocalStore

BEFORE = read_record(Path(__file__).parent / "before_kinds.json")
"""A configuration and the keys of its stages, both written by the last version without kinds."""
SINCE_CHANGED = ("trials", "join-trials", "analysis")
"""Kinds whose results are others since (distance in three dimensions): they are made anew."""


def old_key(stage, function, inputs):
    """Return the key by the rule of that version: as ADR 1 has it."""
    record = {
        "function": function,
        "version": stage.kind.version,
        "config": stage.config,
        "seed": stage.seed,
        "inputs": inputs,
    }
    text = json.dumps(record, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def finish_by_the_old_rule(root):
    """Leave the parts of the toy graph as the last version did."""
    store = LocalStore(root)
    for stage in graph()[1:]:
        key = old_key(stage, "toys:number", {})
        workspace = store.workspace(stage.name, key)
        write_record(workspace / "n.json", {"n": stage.config["n"]})
        store.commit(workspace, stage.name, key, inputs={})


def test_stages_finished_before_there_were_kinds_are_taken_as_they_are(tmp_path):
    finish_by_the_old_rule(tmp_path)
    outcome, observer = run(tmp_path, graph())
    assert sorted(observer.reused) == ["part/0", "part/1", "part/2"]
    assert observer.started == ["total"]
    part = graph()[1]
    artefact = outcome.artefacts[part.name]
    assert read_record(artefact.folder / MANIFEST)["key"] == old_key(part, "toys:number", {})
    assert read_record(outcome.artefacts["total"].path("n.json"))["n"] == 0 + 1 + 2
    _, again = run(tmp_path, graph())
    assert again.started == []


def test_a_checkpoint_of_that_time_goes_on(tmp_path):
    stage = Stage(name="count", kind=toy_stages.KINDS["count_slowly"])
    old = old_key(stage, "toys:count_slowly", {})
    write_record(LocalStore(tmp_path).checkpoint_folder("count", old) / "count.json",
                 {"done": 48})  # fmt: skip
    _, observer = run(tmp_path, [stage])
    assert observer.sentences == [("count", "starts at 48")]
    assert not list((tmp_path / "checkpoints").rglob("*.json"))


def test_later_kinds_have_no_key_of_that_time():
    stage = Stage(name="new", kind=StageKind(name="new", function=toy_stages.number))
    assert stage.legacy_key({}) is None


def test_a_key_holds_the_kind_and_not_where_its_function_is():
    part = graph()[1]
    moved = replace(part, kind=replace(part.kind, function=toy_stages.total))
    assert moved.key({}) == part.key({})
    renamed = replace(part, kind=replace(part.kind, name="other"))
    assert renamed.key({}) != part.key({})


def test_kinds_are_what_they_are_for_ever():
    assert set(KINDS) == {
        "initiation", "trials", "join-trials", "analysis", "curriculum", "control", "statistics",
        "evidence", "teacher", "teacher-statistics",
    }  # fmt: skip
    assert all(name == kind.name for name, kind in KINDS.items())
    assert len({kind.function for kind in KINDS.values()}) == len(KINDS)


def test_every_stage_of_a_run_of_that_time_is_found():
    """A field added to a configuration must declare `absent`, or these keys change."""
    config = config_from_record(up_to_date(BEFORE["config"]))
    # The hash of the compiled model is MuJoCo's matter.
    stages = comparison_graph(replace(config, fingerprint="0" * 64), ("plr",), TeachersConfig())
    finished = {
        stage.name: Artefact(stage=stage.name, key="", folder=Path(), files={"result": stage.name})
        for stage in stages
    }
    keys = {stage.name: stage.legacy_key(finished) for stage in stages}
    changed = {stage.name for stage in stages if stage.kind.name in SINCE_CHANGED}
    assert keys.pop("evidence") is None  # there was none
    assert {name: key for name, key in keys.items() if name not in changed} == {
        name: key for name, key in BEFORE["keys"].items() if name not in changed
    }
    assert {stage.kind.name for stage in stages} == set(KINDS)


def test_a_folder_of_that_time_is_recognised_by_what_its_configuration_meant(tmp_path):
    record = {
        key: value
        for key, value in BEFORE["config"].items()
        if key not in {"own_sha256", "rollout_shards"}
    }
    write_record(tmp_path / RUN, {"schema": 1, "config": record})
    config = load_config(tmp_path)
    assert (config.task, config.fingerprint, config.rollout_shards) == ("rstar/step", "", 1)
    assert config.advancement.measure == "step"
    refuse_other(tmp_path, replace(config, fingerprint="0" * 64))
    with pytest.raises(OutputError, match="`rollout_shards` is 1 there and 2 here"):
        refuse_other(tmp_path, override(config, {"rollout_shards": 2}))
