"""The check finds each broken clause, and says what to do."""

from __future__ import annotations

import time
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from own_point import PointEnv, make_env, make_point, set_task

from surmount.analysis.configuration import AnalysisConfig
from surmount.cli import check as cli_check
from surmount.cli.main import run
from surmount.envs import check, loading
from surmount.envs.check import check_contract
from surmount.experiment.presets import preset
from surmount.tasks.space import TaskSpace


def broken(make) -> dict[str, str]:
    return {f.clause: f"{f.sentence} {f.remedy}" for f in check_contract(make) if not f.holds}


def notes(make) -> dict[str, str]:
    return {f.clause: f.note for f in check_contract(make) if f.note}


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


class Noisy(Deaf):
    """Ignores the task, behind noise in its observations that no seed repeats."""

    def _observe(self):
        return super()._observe() + np.float32(0.01 * np.random.rand())  # noqa: NPY002


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
    assert len(clauses) == 17


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
        (lambda: make_point(success="is_success"), ["success is told"], "no `is_success`"),
        (
            lambda: make_point(success=lambda transition: transition.observation[0]),
            ["success is told"],
            "neither true nor false",
        ),
        (
            lambda: make_point(Noisy()),
            ["distance_m changes the task", "wind changes the task", "a seed repeats its episode"],
            "not shown: at 0.5 the same seed and actions do not give the same episode twice",
        ),
        (
            lambda: make_point(
                space=TaskSpace.grid(distance_m=[1.0]),
                set_task=lambda env, task: setattr(env, "goal", task["distance_m"]),
            ),
            ["distance_m changes the task"],
            "one variant, which is no family",
        ),
        (
            lambda: make_point(space=TaskSpace.grid(distance_m=[1.0, 2.0], wind=[0.5])),
            ["wind changes the task"],
            "it has one value, 0.5",
        ),
        (
            lambda: make_point(features={"one": lambda transition: 1.0}),
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


class Slipping(Fixed):
    """Begins always alike, and slips once in thirty steps or so."""

    def step(self, action):
        slips = self.np_random.random() < 0.03
        return super().step(-action if slips else action)


def test_chance_that_strikes_seldom_is_chance():
    assert "seeds matter" not in broken(lambda: make_point(Slipping()))


def test_an_environment_without_a_time_limit_is_found_before_any_episode_runs():
    env = make_point()
    env.env = Failing()
    found = broken(lambda: env)
    assert found.keys() == {"episodes end"}
    assert "has no time limit" in found["episodes end"]
    assert "gymnasium.wrappers.TimeLimit" in found["episodes end"]


def test_the_first_episode_without_end_is_the_last(monkeypatch):
    monkeypatch.setattr("surmount.envs.check.LONGEST_EPISODE", 10)  # of 12 steps
    findings = check_contract(lambda: make_point(success=lambda transition: False))
    assert findings[-1].clause == "episodes end"
    assert findings[-1].sentence == "one had not ended after 10 steps"
    assert findings[-2].sentence == "10 steps, on 1 of 12 variants"


@pytest.mark.parametrize(
    ("success", "words"),
    [(lambda transition: False, "never true"), (lambda transition: True, "always true")],
)
def test_success_that_random_actions_do_not_change_is_noted(success, words):
    make = lambda: make_point(success=success)  # noqa: E731
    assert broken(make) == {}
    assert words in notes(make)["success is told"]


def test_a_feature_that_is_the_task_is_noted():
    features = {
        "goal_m": lambda transition: transition.env.goal,
        "position_m": lambda transition: transition.observation[0],
    }
    assert "`goal_m`." in notes(lambda: make_point(features=features))["features vary"]
    assert "features vary" not in notes(make_env)


def test_a_task_that_only_rewards_tell_is_said_as_such():
    class Priced(PointEnv):
        price = 0.0

        def step(self, action):
            observation, reward, *rest = super().step(action)
            return observation, reward - self.price, *rest

    def set_price(env, task):
        env.goal, env.price = task["distance_m"], task["wind"]

    findings = check_contract(lambda: make_point(Priced(), set_task=set_price))
    (found,) = (f for f in findings if f.clause == "wind changes the task")
    assert found.holds
    assert found.sentence == "between 0 and 2 rewards or the end differ"


def test_what_stops_a_later_check_is_told_in_its_place():
    class Rare(PointEnv):
        """Fails on a task that is at the end of the range, and no variant."""

        def reset(self, *, seed=None, options=None):
            if self.goal >= 3.0:
                raise ValueError("too far")
            return super().reset(seed=seed, options=options)

    grid = TaskSpace.grid(distance_m=[0.5, 1.0], wind=[0.0, 1.0])
    space = replace(grid, upper=np.array([3.0, 1.0]))
    findings = check_contract(lambda: make_point(Rare(), space=space))
    told = [f.sentence for f in findings if f.clause == "episodes run"]
    assert len(told) == 1
    assert "fails in `reset` on task distance_m=3, wind=0, seed " in told[0]
    assert told[0].endswith("(ValueError: too far).")
    assert not findings[-1].holds


def test_observations_of_several_parts_keep_the_contract():
    class Parts(PointEnv):
        def __init__(self):
            super().__init__()
            box = self.observation_space
            self.observation_space = gymnasium.spaces.Dict({"first": box, "second": box})

        def _observe(self):
            both = super()._observe()
            return {"first": both, "second": both}

    features = {"position_m": lambda transition: transition.observation["first"][0]}
    found = broken(lambda: make_point(Parts(), features=features))
    assert found == {}


def test_the_command_prints_clauses_and_ends_with_its_code(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["check", "own_point:make_env"]) == 0
    assert "All 17 clauses hold." in capsys.readouterr().out
    (tmp_path / "deaf_env.py").write_text(
        "from own_point import make_point\n"
        "def make_env():\n    return make_point(set_task=lambda env, task: None)\n",
        encoding="utf-8",
    )
    assert run(["check", "deaf_env:make_env"]) == 3
    out = capsys.readouterr().out
    assert "BROKEN  distance_m changes the task" in out
    assert "2 of 17 clauses broken." in out


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("no_such_module:make_env", "There is no module `no_such_module`"),
        ("own_point:make_enf", "It has "),
        ("own_point:", "my_module:make_env"),
        ("broken_env:make_env", "fails while it is imported"),
        ("ended_env:make_env", "fails while it is imported (SystemExit: 2)"),
        ("own_point.py:make_env", "Write it as own_point:make_env.\n"),
        ("a/b/own_point.py:make_env", "own_point:make_env, and call Surmount in the folder a/b."),
    ],
)
def test_a_function_that_is_not_there_is_said(capsys, tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken_env.py").write_text("1 / 0\n", encoding="utf-8")
    (tmp_path / "ended_env.py").write_text("raise SystemExit(2)\n", encoding="utf-8")
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


class Global(PointEnv):
    """Keeps its wind in the class: every environment of the process blows alike."""

    shared = 0.0

    def step(self, action):
        self.wind = Global.shared
        return super().step(action)


def test_a_task_kept_in_a_global_is_found_by_two_environments_in_turn():
    def set_global(env, task):
        env.goal = task["distance_m"]
        Global.shared = task["wind"]

    found = broken(lambda: make_point(Global(), set_task=set_global))
    assert found.keys() == {"environments do not share their task"}
    assert "not in a module" in found["environments do not share their task"]


class Lidar(PointEnv):
    """Sees nothing where it is far from its goal."""

    def _observe(self):
        seen = super()._observe()
        seen[1] = np.inf if seen[1] > 0.8 else seen[1]
        return seen


def test_a_sensor_that_returns_infinity_is_to_be_clipped():
    found = broken(lambda: make_point(Lidar()))
    assert (
        "clip what may be infinite, as a range sensor"
        in found["observations and rewards are finite"]
    )


class Alike(PointEnv):
    def step(self, action):
        observation, _, ended, cut, info = super().step(action)
        return observation, -1.0, ended, cut, info


def test_a_constant_reward_is_a_note():
    assert "Eq. 5 sees no progress" in notes(lambda: make_point(Alike()))["rewards tell progress"]


class Spoken(PointEnv):
    def __init__(self):
        super().__init__()
        self.observation_space = gymnasium.spaces.Dict(
            place=self.observation_space, said=gymnasium.spaces.Text(5)
        )

    def _observe(self):
        return {"place": super()._observe(), "said": "go"}


def test_text_is_left_out_and_said():
    features = {"position_m": lambda transition: transition.observation["place"][0]}
    told = notes(lambda: make_point(Spoken(), features=features))
    assert "`said` is text" in told["a learner can take observations and actions"]
    env = make_point(Spoken(), features=features)
    assert env.reset(seed=0)[0].keys() == {"place"}


@pytest.mark.parametrize("kind", [np.uint8, np.int64])
def test_a_task_is_appended_to_integers_as_floats(kind):
    class Counted(PointEnv):
        def __init__(self):
            super().__init__()
            self.observation_space = gymnasium.spaces.Box(0, 9, (2,), kind)

        def _observe(self):
            return np.array([3, 4], kind)

    env = make_point(Counted(), observe_task=True)
    seen = [env.reset(seed=0, options={"variant": one})[0] for one in env.space.variants]
    np.testing.assert_allclose(
        np.unique([row[2] for row in seen]), [-1, -1 / 3, 1 / 3, 1], rtol=1e-6
    )
    assert all(env.observation_space.contains(row) for row in seen)


def test_the_check_knows_what_the_analysis_needs():
    assert AnalysisConfig().min_samples_per_component == check.SAMPLES_NEEDED
    assert preset("step", "smoke").trials.repetitions == check.USUAL_REPETITIONS


class Hanging(PointEnv):
    def step(self, action):
        time.sleep(30)
        return super().step(action)


def test_an_environment_that_hangs_is_told_in_time(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(loading, "load_make_env", lambda name: lambda: make_point(Hanging()))
    assert cli_check.check("hanging:make_env", time_limit_s=1) == cli_check.BROKEN
    assert "it answers in time: the check took longer than 1 s" in capsys.readouterr().out
