"""Every wrong call ends in one sentence, a remedy and its exit code, never in a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from example_trials import two_behaviours
from small import SMALL, small_config

from surmount import __version__
from surmount.cli.main import VERBS, run
from surmount.core.configuration import dotted_keys, override, read_overrides
from surmount.core.records import read_record, write_record
from surmount.experiment.config import config_class
from surmount.experiment.presets import preset
from surmount.experiment.running import begin
from surmount.rstar.course.config import EnvConfig
from surmount.trials.table import write_trials

STILLS = ["render", "step", "--stand", "--out", "x.png"]


def call(capsys, *arguments) -> tuple[int, str, str]:
    code = run([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def reproduce(capsys, out, *arguments):
    return call(capsys, "reproduce", *arguments, "--out", out, "--processes", 0)


@pytest.mark.parametrize(
    ("arguments", "sentence", "remedy"),
    [
        (["stepp"], "There is no task `stepp`.", "Did you mean `step`?"),
        (["step", "--preset", "papper"], "Unknown preset `papper`.", "Did you mean `paper`?"),
        ([], "No task was given.", "surmount tasks"),
        (["step", "--set", "learner.lr=1"], "Unknown configuration key `learner.lr`.", "Did you"),
        (["step", "--set", "seed"], "`--set seed` is not an assignment.", "key=value"),
        (["step", "--networks", "0"], "`networks` is 0.", "at least 1"),
        (["step", "--config", "no.toml"], "no.toml cannot be read", "readable"),
        (["step", "--set", "learner.batch_size=77"], "not a multiple of", "learner.batch_size"),
        (["step", "--set", "env.robot.friction=-1"], "friction", "Give a value"),
    ],
)
def test_wrong_options_end_with_code_2(capsys, tmp_path, arguments, sentence, remedy):
    code, _, err = reproduce(capsys, tmp_path / "out", *arguments)
    assert code == 2
    assert sentence in err
    assert remedy in err
    assert not (tmp_path / "out").exists()


def test_an_unwritable_folder_ends_with_code_4(capsys, tmp_path):
    (tmp_path / "file").write_text("x", encoding="utf-8")
    code, _, err = reproduce(capsys, tmp_path / "file" / "out", "step")
    assert code == 4
    assert "is not a folder" in err


def test_a_foreign_folder_ends_with_code_4(capsys, tmp_path):
    (tmp_path / "thesis.tex").write_text("x", encoding="utf-8")
    code, _, err = reproduce(capsys, tmp_path, "step")
    assert code == 4
    assert "not of an experiment" in err


def test_a_folder_of_another_configuration_ends_with_code_4(capsys, tmp_path):
    begin(tmp_path, small_config())
    code, _, err = reproduce(capsys, tmp_path, "narrow-channel", "--preset", "smoke")
    assert code == 4
    assert "made by another configuration" in err


def test_resuming_where_nothing_is_ends_with_code_4(capsys, tmp_path):
    code, _, err = reproduce(capsys, tmp_path, "--resume")
    assert code == 4
    assert "There is no experiment" in err


def test_resuming_another_obstacle_is_refused(capsys, tmp_path):
    begin(tmp_path, small_config())
    code, _, err = reproduce(capsys, tmp_path, "step", "--resume")
    assert code == 2
    assert "holds a run on rstar/narrow-channel, not on step" in err


def test_a_missing_extra_ends_with_code_6(tmp_path):
    program = (
        "import sys; sys.modules['mujoco'] = None\n"
        f"from surmount.cli.main import run; sys.exit(run({STILLS}))"
    )
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.returncode == 6
    assert "pip install 'surmount[robot]'" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_way_to_draw_that_is_not_there_ends_with_code_2(tmp_path):
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "surmount", *STILLS],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"MUJOCO_GL": "crayons"},
    )
    assert done.returncode == 2
    assert "MUJOCO_GL=crayons" in done.stderr
    assert "Unset MUJOCO_GL" in done.stderr
    assert "Traceback" not in done.stderr


def test_analyze_needs_none_of_the_laboratory(tmp_path):
    write_trials(tmp_path / "trials.csv", two_behaviours())
    program = """
import sys
from surmount.cli.main import run

class Laboratory:  # as if it were not installed
    def find_spec(name, path, target=None):
        if name in ("mujoco", "gymnasium", "torch", "stable_baselines3", "safetensors", "av"):
            raise ModuleNotFoundError(name, name=name)

sys.meta_path.insert(0, Laboratory)
sys.exit(run(sys.argv[1:]))
"""
    call = ["analyze", str(tmp_path / "trials.csv"), "--out", str(tmp_path / "out")]
    call += ["--set", "components=2", "--set", "bootstrap=0"]
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program, *call], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "curriculum.json").is_file()
    other = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program, *STILLS],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert other.returncode == 6
    assert "pip install 'surmount[" in other.stderr


def test_a_printed_configuration_is_read_back_unchanged(capsys, tmp_path):
    code, out, _ = call(capsys, "config", "step", "--preset", "paper")
    path = tmp_path / "c.toml"
    path.write_text(out, encoding="utf-8")
    changes = read_overrides(path)
    assert code == 0
    assert list(changes) == dotted_keys(config_class(EnvConfig))
    assert override(preset("low-entrance", "smoke"), changes) == preset("step", "paper")


def test_every_repeated_assignment_counts(capsys):
    code, out, _ = call(capsys, "config", "step", "--set", "seed=7", "--set", "networks=3")
    assert code == 0
    assert "seed = 7\nnetworks = 3\n" in out


def test_help_names_every_verb(capsys):
    code, out, _ = call(capsys, "--help")
    assert code == 0
    for verb in VERBS:
        assert f"  {verb} " in out


def test_without_a_verb_all_are_listed(capsys):
    assert call(capsys) == call(capsys, "--help")


def test_the_version_is_told(capsys):
    assert call(capsys, "--version") == (0, f"surmount {__version__}\n", "")


def test_of_a_mistyped_verb_the_nearest_is_named(capsys):
    code, _, err = call(capsys, "reprodcue", "step")
    assert code == 2
    assert "There is no verb `reprodcue`." in err
    assert "Did you mean `reproduce`?" in err


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    root = tmp_path_factory.mktemp("cli") / "run"
    options = [f"--set={key}={json.dumps(value)}" for key, value in SMALL.items()]
    options += ["--set=networks=1", "--processes=0", f"--out={root}"]
    code = run(["reproduce", "narrow-channel", "--preset", "smoke", *options])
    return root, code


def test_reproduce_runs_to_the_report(finished):
    root, code = finished
    assert code == 0
    page = (root / "report.html").read_text(encoding="utf-8")
    assert "<html" in page
    log = (root / "logs" / "run.log").read_text(encoding="utf-8")
    assert "threshold 0.1" in log


def test_resume_alone_goes_on_with_the_stored_configuration(finished, capsys):
    root, _ = finished
    code, out, _ = reproduce(capsys, root, "--resume")
    assert code == 0
    assert "kept from an earlier call" in out
    assert str(root / "report.html") in out


def test_show_prints_the_curriculum_of_a_run_and_why(finished, capsys):
    root, _ = finished
    code, out, _ = call(capsys, "show", root)
    assert code == 0
    assert "Curriculum over width_mm" in out
    code, out, _ = call(capsys, "show", root, "--why")
    assert code == 0
    assert "Links of the dendrogram" in out


def test_a_damaged_artefact_ends_with_code_5(finished, capsys, tmp_path):
    root, _ = finished
    (path,) = root.glob("stages/statistics/*/statistics.json")
    whole = path.read_bytes()
    try:
        write_record(path, read_record(path) | {"cap_s": 1.0})
        code, _, err = call(capsys, "report", root)
    finally:
        path.write_bytes(whole)
    assert code == 5
    assert str(path) in err
    assert "Delete" in err


@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_analyze_turns_any_trials_into_a_curriculum(capsys, tmp_path, suffix):
    path = tmp_path / f"trials.{suffix}"
    write_trials(path, two_behaviours())
    out = tmp_path / "out"
    code, printed, _ = call(capsys, "analyze", path, "--out", out, "--set", "components=2")
    assert code == 0
    groups = read_record(out / "curriculum.json")["groups"]
    assert [len(group["variants"]) for group in groups] == [4, 4]
    assert [group["success_rate"] for group in groups] == [1.0, 0.0]
    assert "1 level" in printed
    assert list((out / "figures").glob("*.svg"))
    code, printed, _ = call(capsys, "show", out, "--why")
    assert code == 0
    assert "components" in printed


def test_analyze_refuses_what_is_no_table(capsys, tmp_path):
    path = tmp_path / "trials.csv"
    path.write_text("a,b\n1,2\n", encoding="utf-8")
    code, _, err = call(capsys, "analyze", path, "--out", tmp_path / "out")
    assert code == 3
    assert "variant" in err
