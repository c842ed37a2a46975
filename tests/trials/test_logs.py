"""Logs with columns of other names: said which is which, read as the table is."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from surmount.cli.main import run
from surmount.core.errors import InputError
from surmount.trials.columns import Columns
from surmount.trials.table import read_trials, write_trials

CASES = Path(__file__).parent / "cases"

LOG = """StepHeight,Episode,Run,Time,X,Reached
21,7,a,0.0,1.0,0
21,7,a,0.1,0.5,1
21,8,a,0.0,1.0,0
35,9,a,0.0,1.0,0
35,9,a,0.1,0.9,0
35,9,b,0.0,1.1,false
35,9,b,0.1,0.2,true
"""


def test_a_log_with_names_of_its_own_becomes_trials(capsys, tmp_path):
    (tmp_path / "log.csv").write_text(LOG, encoding="utf-8")
    out = tmp_path / "trials.csv"
    options = ["--variant", "height_mm=StepHeight", "--feature", "time_s=Time", "--feature",
               "distance_m=X", "--trial", "Episode", "--success", "Reached", "--network",
               "Run"]  # fmt: skip
    code = run(["convert", str(tmp_path / "log.csv"), "--out", str(out), *options])
    assert code == 0
    assert "4 trials on 2 variants, 2 succeeded, 7 rows" in capsys.readouterr().out
    trials = read_trials(out)
    assert trials.parameters == ("height_mm",)
    assert trials.feature_names == ("time_s", "distance_m")
    assert trials.variant[:, 0].tolist() == [21, 21, 35, 35]
    assert trials.success.tolist() == [True, False, False, True]
    assert trials.network.tolist() == [0, 0, 0, 1]
    assert trials.final("distance_m").tolist() == [0.5, 1.0, 0.9, 0.2]


@pytest.mark.parametrize(
    ("text", "columns", "words"),
    [
        (LOG, {"trial": "Episodes"}, "column `Episodes` is missing"),
        (LOG.replace("35,9,a,0.1", "36,9,a,0.1"), {}, "row 5: `height_mm` changes within a trial"),
        (
            LOG.replace("true", "perhaps"),
            {},
            r"neither 0 nor 1 but a word \(perhaps\)",
        ),
        (LOG.splitlines()[0] + "\n", {}, "the table has no rows"),
        ("", {}, "the table has no rows"),
        (
            LOG.replace("b,0.1", "b,-0.5"),
            {"features": {"time_s": "Time"}},
            "row 7: `time_s` runs backwards within a trial",
        ),
    ],
)
def test_a_log_that_cannot_be_read_says_why(tmp_path, text, columns, words):
    path = tmp_path / "log.csv"
    path.write_text(text, encoding="utf-8")
    chosen = {"variant": {"height_mm": "StepHeight"}, "trial": "Episode", "success": "Reached",
              "features": {"x": "X"}, "network": "Run"} | columns  # fmt: skip
    with pytest.raises(InputError, match=words):
        read_trials(path, columns=Columns(**chosen))


@pytest.mark.parametrize(
    "name", ["success", "network", "trial", "variant", "variant.width", "height_mm"]
)
def test_no_feature_replaces_another_column(capsys, tmp_path, name):
    (tmp_path / "log.csv").write_text(LOG, encoding="utf-8")
    out = tmp_path / "trials.csv"
    options = ["--variant", "height_mm=StepHeight", "--feature", "distance_m=X", "--feature",
               f"{name}=Time", "--trial", "Episode", "--success", "Reached"]  # fmt: skip
    assert run(["convert", str(tmp_path / "log.csv"), "--out", str(out), *options]) == 2
    said = capsys.readouterr().err
    assert f"A feature cannot be named `{name}`" in said
    assert "another name" in said
    assert not out.exists()


@pytest.mark.parametrize("option", ["--variant", "--feature"])
def test_a_name_given_twice_is_refused(capsys, tmp_path, option):
    (tmp_path / "log.csv").write_text(LOG, encoding="utf-8")
    options = ["--variant", "h=StepHeight", "--feature", "x=X", option, "y=X", option, "y=Time"]
    code = run(["convert", str(tmp_path / "log.csv"), "--out", str(tmp_path / "t.csv"), *options])
    assert code == 2
    assert f"`{option} y` is given twice, as `X` and as `Time`" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("times", "row"),
    [([0.0, 0.1, 0.2, 0.0, 0.1], 4), ([0.0, 3.2, 0.1, 3.3], 3), ([1, 100, -100], 3)],
)
def test_two_areas_merged_into_one_trial_are_told_by_their_times(tmp_path, times, row):
    path = tmp_path / "log.csv"
    path.write_text("h,e,t,s\n" + "".join(f"30,1,{t},0\n" for t in times), encoding="utf-8")
    columns = Columns(variant={"h": "h"}, trial="e", success="s", features={"time_s": "t"})
    with pytest.raises(InputError, match=f"row {row}: `time_s` runs backwards") as caught:
        read_trials(path, columns=columns)
    assert "several agents" in caught.value.remedy


def test_trials_that_are_interleaved_each_have_their_own_time(tmp_path):
    path = tmp_path / "log.csv"
    rows = [("a:0", 5.0), ("b:0", 0.0), ("a:0", 5.1), ("b:0", 0.1)]
    path.write_text("h,e,t,s\n" + "".join(f"30,{e},{t},0\n" for e, t in rows), encoding="utf-8")
    columns = Columns(variant={"h": "h"}, trial="e", success="s", features={"time_s": "t"})
    trials = read_trials(path, columns=columns)
    assert trials.features[:, 0].tolist() == [5.0, 5.1, 0.0, 0.1]


def test_numbers_that_begin_anew_for_each_variant_are_read_as_other_trials(tmp_path):
    rows = [f"{h},{e},{t},{e}" for h in (30, 40) for e in (0, 1) for t in (0.0, 0.1)]
    (tmp_path / "log.csv").write_text("h,e,t,s\n" + "\n".join(rows), encoding="utf-8")
    for features in ({"time_s": "t"}, {"x": "t"}):
        columns = Columns(variant={"h": "h"}, trial="e", success="s", features=features)
        trials = read_trials(tmp_path / "log.csv", columns=columns)
        assert trials.variant[:, 0].tolist() == [30, 30, 40, 40]
        assert any("come again on other variants" in note for note in trials.notes)


def test_a_variant_that_changes_while_time_goes_on_is_told(tmp_path):
    rows = ["30,0,0.0,0", "30,0,0.1,0", "40,0,0.2,0", "40,0,0.3,1"]
    (tmp_path / "log.csv").write_text("h,e,t,s\n" + "\n".join(rows), encoding="utf-8")
    columns = Columns(variant={"h": "h"}, trial="e", success="s", features={"time_s": "t"})
    with pytest.raises(InputError, match="row 3: `h` changes within a trial"):
        read_trials(tmp_path / "log.csv", columns=columns)


def test_a_variant_that_changes_while_time_goes_on_is_told_under_standard_names_too(tmp_path):
    path, names = tmp_path / "t.csv", "variant,network,trial,time_s,success\n"
    path.write_text(names + "30,0,0,0.0,0\n30,0,0,0.1,0\n40,0,0,0.2,0\n40,0,0,0.3,1\n")
    with pytest.raises(InputError, match="row 3: `variant` changes within a trial"):
        read_trials(path)
    path.write_text(names + "30,0,0,0.0,0\n30,0,0,0.1,0\n40,0,0,0.0,0\n40,0,0,0.1,1\n")
    trials = read_trials(path)
    assert trials.success.tolist() == [False, True]
    assert trials.notes == ()
    path.write_text(names + "30,0,0,0.0,0\n30,0,1,0.1,0\n40,0,0,0.2,0\n40,1,0,0.3,1\n")
    assert read_trials(path).n_trials == 4  # other trials stand between


LEFT_OVER = (
    "variant,variant.a,w,network,run,trial,ep,success,reached,x\n"
    "20,1,1,0,a,0,0,0,0,0\n20,1,1,0,b,0,1,0,1,1\n21,1,2,0,a,0,2,0,1,2\n21,1,2,0,b,0,3,0,0,3\n"
)


def test_no_column_that_was_replaced_stays_as_a_feature_and_turns_the_outcomes(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(LEFT_OVER, encoding="utf-8")
    columns = Columns(variant={"w": "w"}, network="run", trial="ep", success="reached")
    trials = read_trials(path, columns=columns)
    assert trials.feature_names == ("x",)
    assert trials.notes == (
        "`variant` was left out: the task parameter is `w`.",
        "`variant.a` was left out: the task parameter is `w`.",
        "`network` was left out: the network is `run`.",
        "`trial` was left out: the trial is `ep`.",
        "`success` was left out: the outcome is `reached`.",
    )
    write_trials(tmp_path / "t.csv", trials)
    again = read_trials(tmp_path / "t.csv")
    for found in (trials, again):
        assert found.success.tolist() == [False, True, True, False]
        assert found.repetition.tolist() == [0, 1, 2, 3]
        assert found.network_names == ("a", "b")
        assert found.variant[:, 0].tolist() == [1, 1, 2, 2]
        assert found.column("x").tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize("name", ["success", "network", "trial", "variant", "x"])
def test_a_feature_by_the_name_of_another_column_is_not_written(tmp_path, name):
    trials = read_trials(CASES / "small.csv.gz")
    twice = dataclasses.replace(
        trials,
        feature_names=("x", name),
        features=np.column_stack([trials.features[:, 0]] * 2),
    )
    with pytest.raises(InputError, match=f"The feature `{name}` has the name of another column"):
        write_trials(tmp_path / "t.csv", twice)
    assert not (tmp_path / "t.csv").exists()
