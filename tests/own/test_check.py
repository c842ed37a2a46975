"""The check finds each broken clause, and says what to do."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from own_point import PointEnv, make_env, make_point, set_task

from surmount.cli.main import run
from surmount.own import check_contract


def broken(make) -> dict[str, str]:
    return {f.clause: f"{f.sentence} {f.remedy}" for f in check_contract(make) if not f.holds}


class Deaf(PointEnv):
    """Copies the task when it is made, and never looks at it again."""

    def __init__(self):
        super().__init__()
        self._goal = self.goal

    def step(self, action):
        self.goal, self.wind = self._goal, 0.0
        return super().step(action)

    def _observe(self):
        return np.array([self.position, self._goal - self.position], dtype=np.float32)


class Unseeded(PointEnv):
    def reset(self, *, seed=None, options=None):
        _, info = super().reset(seed=seed, options=options)
        self.position += np.random.rand()  # noqa: NPY002
        return self._observe(), info


class Fixed(PointEnv):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed, options=options)
        self.position = 0.0
        return self._observe(), {"reached": False}


class Failing(PointEnv):
    def step(self, action):
        raise ZeroDivisionError("no floor")


def test_an_environment_that_keeps_the_contract_passes():
    findings = check_contract(make_env)
    assert [f for f in findings if not f.holds] == []
    clauses = [f.clause for f in findings]
    assert "distance_m changes the task" in clauses
    assert "wind changes the task" in clauses
    assert len(clauses) == 13


@pytest.mark.parametrize(
    ("make", "clauses", "words"),
    [
        (lambda: 1 / 0, ["it can be made"], "ZeroDivisionError"),
        (PointEnv, ["it can be made"], "not a TaskEnv"),
        (lambda: make_point(Failing()), ["episodes run"], "no floor"),
        (
            lambda: make_point(features={"x": "nowhere"}),
            ["episodes run"],
            "Let `info` hold it after every reset",
        ),
        (
            lambda: make_point(Deaf()),
            ["distance_m changes the task", "wind changes the task"],
            "the same seed and actions give the same episode",
        ),
        (
            lambda: make_point(set_task=lambda env, task: setattr(env, "goal", task["distance_m"])),
            ["wind changes the task"],
            "a later change is ignored",
        ),
        (lambda: make_point(success="done_well"), ["success is told"], "no `done_well`"),
        (
            lambda: make_point(features={"one": lambda moment: 1.0}),
            ["features vary"],
            "constant: one",
        ),
        (
            lambda: make_point(features={"bad": lambda m: np.nan if m.reward else 1.0}),
            ["features are finite"],
            "not finite: bad",
        ),
        (lambda: make_point(Unseeded()), ["a seed repeats its episode"], "np_random"),
        (lambda: make_point(Fixed()), ["seeds matter"], "Let `reset` draw the start"),
    ],
)
def test_a_broken_clause_is_named_with_a_remedy(make, clauses, words):
    found = broken(make)
    assert set(clauses) <= found.keys()
    assert words in found[clauses[0]]
    unexpected = found.keys() - set(clauses)
    assert unexpected <= {"features vary", "wind changes the task", "distance_m changes the task"}


def test_episodes_without_end_are_found(monkeypatch):
    monkeypatch.setattr("surmount.own.check.LONGEST_EPISODE", 60)
    endless = make_point
    monkeypatch.setattr(gymnasium.wrappers, "TimeLimit", lambda env, _: env)
    assert "TimeLimit" in broken(endless)["episodes end"]


def test_the_command_prints_clauses_and_ends_with_its_code(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["check", "own_point:make_env"]) == 0
    assert "All 13 clauses hold." in capsys.readouterr().out
    (tmp_path / "deaf_env.py").write_text(
        "from own_point import make_point\n"
        "def make_env():\n    return make_point(set_task=lambda env, task: None)\n",
        encoding="utf-8",
    )
    assert run(["check", "deaf_env:make_env"]) == 3
    out = capsys.readouterr().out
    assert "BROKEN  distance_m changes the task" in out
    assert "2 of 13 clauses broken." in out


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("no_such_module:make_env", "There is no module `no_such_module`"),
        ("own_point:make_enf", "It has "),
        ("own_point:", "my_module:make_env"),
        ("broken_env:make_env", "fails while it is imported"),
    ],
)
def test_a_function_that_is_not_there_is_said(capsys, tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken_env.py").write_text("1 / 0\n", encoding="utf-8")
    assert run(["check", name]) in (2, 3)
    assert words in capsys.readouterr().err


def test_the_task_is_set_before_the_reset_of_the_wrapped_environment():
    env = make_point()
    seen = []

    def spy(inner, task):
        seen.append(task)
        set_task(inner, task)

    env = make_point(set_task=spy)
    observation, info = env.reset(seed=0, options={"variant": [1.5, 1.0]})
    assert seen == [{"distance_m": 1.5, "wind": 1.0}]
    assert observation.sum() == pytest.approx(1.5, abs=1e-5)
    assert info["variant"].tolist() == [1.5, 1.0]
