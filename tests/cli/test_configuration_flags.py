"""A key of the configuration is changed by a file, by --set and by its flag, which comes last."""

from __future__ import annotations

import pytest

from surmount.cli.main import run


def printed(capsys, *arguments) -> dict[str, str]:
    """Return the configuration that `surmount config` prints, values as they are printed."""
    assert run(["config", *map(str, arguments)]) == 0
    lines = capsys.readouterr().out.splitlines()
    return dict(line.split(" = ", maxsplit=1) for line in lines)


@pytest.mark.parametrize(
    ("key", "flag", "values"),
    [
        ("env.robot.gear", "--env.robot.gear", ["both"]),
        ("networks", "--networks", ["7"]),
        ("learner.learning_rate", "--learner.learning-rate", ["0.0001"]),
        ("learner.time_horizon", "--learner.time-horizon", ["128"]),
    ],
)
def test_a_flag_does_what_set_does(capsys, key, flag, values):
    by_flag = printed(capsys, "step", flag, *values)
    assert by_flag == printed(capsys, "step", "--set", f"{key}={' '.join(values)}")
    before = printed(capsys, "step")
    assert {name for name in before if before[name] != by_flag[name]} == {key}


def test_a_flag_that_takes_several_values_takes_them(capsys):
    assert (
        printed(capsys, "step", "--learner.hidden-layers", 64, 32)["learner.hidden_layers"]
        == "[64, 32]"
    )


def test_set_comes_over_the_file_and_the_flag_over_both(capsys, tmp_path):
    file = tmp_path / "c.toml"
    file.write_text("seed = 1\nnetworks = 1\nenv.robot.friction = 0.1\n", encoding="utf-8")
    changed = ("step", "--config", file, "--set", "networks=2", "--set", "env.robot.friction=0.2")
    found = printed(capsys, *changed, "--env.robot.friction", 0.3)
    assert (found["seed"], found["networks"], found["env.robot.friction"]) == ("1", "2", "0.3")


def test_a_file_says_the_task_and_the_preset_and_none_contradicts_it(capsys, tmp_path):
    whole = printed(capsys, "step", "--preset", "paper")
    file = tmp_path / "step.toml"
    file.write_text("".join(f"{key} = {value}\n" for key, value in whole.items()), "utf-8")
    assert printed(capsys, "--config", file) == whole
    assert printed(capsys, "step", "--preset", "paper", "--config", file) == whole
    for other in (("low-entrance",), ("step", "--preset=smoke")):
        assert run(["config", *other, "--config", str(file)]) == 2
        assert "on the command line and" in capsys.readouterr().err
    # A file that says the preset alone has the preset's values, and not only its name.
    file.write_text('preset = "paper"\n', "utf-8")
    assert printed(capsys, "step", "--config", file) == whole


def test_flags_may_stand_before_the_options_and_change_the_preset(capsys):
    found = printed(capsys, "step", "--networks", 3, "--preset", "paper")
    smoke = printed(capsys, "step", "--preset", "smoke")
    assert found["networks"] == "3"
    assert found["initial_steps"] == "1000000" != smoke["initial_steps"]


def test_an_environment_of_ones_own_has_no_flags_of_a_robot(capsys):
    with pytest.raises(SystemExit) as ended:
        run(["reproduce", "own_point:make_env", "--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert "--learner.learning-rate" in said
    assert "--env.robot" not in said
    assert "--env.logarithmic" in said  # what may be said of any task parameters


@pytest.mark.parametrize(
    ("mistyped", "meant"),
    [("--env.robot.gaer", "--env.robot.gear"), ("--networkss", "--networks"),
     ("--env.robot.friktion", "--env.robot.friction")],
)  # fmt: skip
def test_of_a_mistyped_flag_the_nearest_is_named(capsys, mistyped, meant):
    with pytest.raises(SystemExit) as ended:
        run(["config", "step", mistyped, "3"])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert mistyped in said
    assert f"{meant} " in said


def test_a_value_of_the_wrong_type_is_refused(capsys):
    with pytest.raises(SystemExit) as ended:
        run(["config", "step", "--env.robot.friction", "slippery"])
    assert ended.value.code == 2
    assert "slippery" in capsys.readouterr().err


def test_help_shows_the_defaults_of_the_preset(capsys):
    with pytest.raises(SystemExit):
        run(["reproduce", "step", "--preset", "paper", "--help"])
    said = capsys.readouterr().out
    assert "1000000" in said
