"""What a function fails to return is said in a sentence, and so is a time limit that is missing."""

from __future__ import annotations

import functools
import sys

import gymnasium
import pytest
from own_point import PointEnv, make_env, make_point

from surmount.cli.main import run
from surmount.core.errors import ConfigError, InputError, MissingExtraError
from surmount.envs.check import check_contract
from surmount.envs.family import NoSettings
from surmount.envs.making import make_task_env, time_limit
from surmount.envs.registry import find_family

POINT = "from own_point import PointEnv, make_point\n"
BAD = {
    "none": ("def make_env():\n    pass\n", "`make_env` returned NoneType, not a TaskEnv."),
    "bare": ("def make_env():\n    return PointEnv()\n", "`make_env` returned PointEnv"),
    "failing": ("def make_env():\n    return 1 / 0\n", "(ZeroDivisionError: division by zero)"),
    "silent": ("def make_env():\n    assert False\n", "`make_env` fails (AssertionError)."),
    "ending": ("def make_env():\n    raise SystemExit(2)\n", "`make_env` fails (SystemExit: 2)."),
    "asking": ("def make_env(size, *, goal):\n    pass\n", "needs arguments: size, goal."),
    "own": (
        "def make_env():\n    return make_point(features={})\n",
        "`features` is empty, or holds `time_s`, which is added by itself.",
    ),
    "endless": (
        "def make_env():\n    env = make_point()\n    env.env = PointEnv()\n    return env\n",
        "The environment has no time limit.",
    ),
}


@pytest.mark.parametrize("name", BAD)
@pytest.mark.parametrize("verb", ["reproduce", "compare", "check"])
def test_each_verb_says_the_same_of_a_function_that_makes_nothing(
    name, verb, capsys, tmp_path, monkeypatch
):
    text, sentence = BAD[name]
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    module = f"env_that_is_{name}"
    monkeypatch.delitem(sys.modules, module, raising=False)
    (tmp_path / f"{module}.py").write_text(POINT + text, encoding="utf-8")
    out = [] if verb == "check" else ["--out", str(tmp_path / "run"), "--processes", "0"]
    assert run([verb, f"{module}:make_env", *out]) in (2, 3)
    said = capsys.readouterr()
    assert sentence in said.out + said.err
    assert "Traceback" not in said.out + said.err
    assert not (tmp_path / "run").exists()  # once corrected, the same command works


def test_an_error_with_its_own_remedy_keeps_both():
    def make():
        raise MissingExtraError("There is no sand.", remedy="Bring some.")

    with pytest.raises(MissingExtraError, match=r"There is no sand\. Bring some\."):
        make_task_env(make)
    (finding,) = check_contract(make)
    assert (finding.sentence, finding.remedy) == ("There is no sand.", "Bring some.")


def test_arguments_with_defaults_need_not_be_given():
    assert make_task_env(lambda env=None, *rest, **more: make_point(env)).step_s == 0.05
    assert make_task_env(functools.partial(make_point, PointEnv())).step_s == 0.05


def test_the_shortest_limit_around_an_environment_counts():
    wrapped = gymnasium.wrappers.TimeLimit(gymnasium.wrappers.TimeLimit(PointEnv(), 30), 40)
    env = make_point(gymnasium.wrappers.RecordEpisodeStatistics(wrapped))  # and 12 around them
    assert time_limit(env) == 12
    env.env = wrapped
    assert time_limit(env) == 30
    assert time_limit(make_env()) == 12  # by its registration


def registered(steps):
    env = make_point()
    env.env = PointEnv()
    env.env.spec = gymnasium.envs.registration.EnvSpec("Point-v0", max_episode_steps=steps)
    return env


def test_a_registration_with_a_limit_counts_where_there_is_no_wrapper():
    assert time_limit(registered(7)) == 7
    for none in (None, -1):
        with pytest.raises(ConfigError, match="no time limit"):
            time_limit(registered(none))


def test_a_registered_limit_that_nothing_keeps_is_found():
    finding = check_contract(lambda: registered(7))[-1]
    assert (finding.clause, finding.holds) == ("episodes end", False)
    assert finding.sentence == "one had not ended after 7 steps"


def test_a_family_takes_the_limit_of_a_wrapper(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "wrapped_env.py").write_text(
        "from own_point import make_point\ndef make_env():\n    return make_point()\n",
        encoding="utf-8",
    )
    family = find_family("wrapped_env:make_env")
    assert family.cap_s(NoSettings()) == pytest.approx(12 * 0.05)
    assert family.trial_env(NoSettings(), 2).num_envs == 2


def test_a_partial_function_is_hashed_by_the_file_that_names_it(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    file = tmp_path / "partial_env.py"
    file.write_text(
        "from functools import partial\nfrom own_point import make_point\n"
        "make_env = partial(make_point)\n",
        encoding="utf-8",
    )
    before = find_family("partial_env:make_env").fingerprint(NoSettings())
    file.write_text(file.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    assert len(before) == 64
    assert find_family("partial_env:make_env").fingerprint(NoSettings()) != before


def test_an_episode_that_ends_without_the_key_of_success_is_an_error():
    env = make_point(success="done_well")
    env.reset(seed=0)
    for _ in range(11):
        assert not env.step([0.0])[4]["is_success"]
    with pytest.raises(InputError, match="no `done_well` when an episode ends"):
        env.step([0.0])  # the last before the limit
