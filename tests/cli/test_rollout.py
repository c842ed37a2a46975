"""Policies that were trained elsewhere become a table of trials, as the initial networks do."""

from __future__ import annotations

import sys

import any_spaces
import numpy as np
import pytest
from stable_baselines3 import PPO

from surmount.cli.main import run
from surmount.core.errors import InputError
from surmount.envs.registry import find_family
from surmount.learn.brought_policy import BroughtActor, policy_trials
from surmount.learn.rollout_config import RolloutConfig
from surmount.trials.table import read_trials
from surmount.workflow.monitor import SilentMonitor

POLICIES = """
import numpy as np

def constant():
    return lambda observation: [1.0]

class Random:
    def predict(self, observation, state, episode_start, deterministic):
        drawn = np.zeros(len(observation)) if deterministic else np.random.rand(len(observation))
        return 2 * drawn[:, None] - 1, None

def random():
    return Random()

def asking(path):
    return constant()

def nothing():
    pass

def failing():
    return lambda observation: observation[7]

def wide():
    return lambda observation: [1.0, 1.0]

def endless():
    return lambda observation: [float("nan")]

class Bare:
    def predict(self, observation, state, episode_start, deterministic):
        return np.ones((len(observation), 1))

def bare():
    return Bare()
"""


@pytest.fixture(autouse=True)
def _policies(tmp_path, monkeypatch):
    (tmp_path / "policies.py").write_text(POLICIES, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "policies", raising=False)
    yield
    sys.modules.pop("policies", None)


def call(*names, out="trials.parquet", extra=()):
    given = [part for name in names for part in ("--policy", f"policies:{name}")]
    return run(
        ["rollout", "own_point:make_env", *given, "--out", out, "--repetitions", "3", *extra]
    )


def two(out, seed=0, *extra):
    names = ("--network", "drives", "--network", "dithers", "--seed", str(seed))
    assert call("constant", "random", out=out, extra=(*names, *extra)) == 0
    return read_trials(out)


def of(trials, name):
    return trials.select(trials.network == trials.network_names.index(name))


def test_each_policy_is_a_network_of_the_table_under_its_name(capsys):
    trials = two("trials.parquet")
    assert sorted(trials.network_names) == ["dithers", "drives"]
    assert trials.n_trials == 2 * 12 * 3
    assert trials.parameters == ("distance_m", "wind")
    assert trials.feature_names == ("time_s", "position_m")
    drives = of(trials, "drives")
    distance, wind = drives.variant.T
    # Full speed is 0.2 less 0.05 of the wind a step, for at most 12 steps.
    assert drives.success[wind == 0.0].all()
    assert not drives.success[(wind == 2.0) & (distance >= 1.5)].any()
    said = capsys.readouterr().out
    assert f"drives: {int(drives.success.sum())} of 36 succeeded\n" in said
    assert "72 trials" in said


def test_names_are_those_of_the_functions_where_none_are_given():
    assert call("constant", "random") == 0
    trials = read_trials("trials.parquet")
    assert sorted(trials.network_names) == ["policies:constant", "policies:random"]


def test_the_same_seed_gives_the_same_trials_and_another_gives_others():
    first, again, other = two("a.parquet"), two("b.parquet"), two("c.parquet", 1)
    np.testing.assert_array_equal(first.features, again.features)
    np.testing.assert_array_equal(first.starts, again.starts)
    dithers = of(first, "dithers"), of(other, "dithers")
    assert (
        dithers[0].features.shape != dithers[1].features.shape
        or (dithers[0].features != dithers[1].features).any()
    )


def test_deterministic_is_asked_of_predict():
    trials = of(two("trials.csv", 0, "--deterministic"), "dithers")
    steps = np.delete(np.diff(trials.column("position_m")), trials.starts[1:-1] - 1)
    wind = np.repeat(trials.variant[:, 1], trials.lengths - 1)
    np.testing.assert_allclose(steps, -0.2 - 0.05 * wind, atol=1e-6)


def test_a_state_is_handed_on_and_the_start_of_episodes_is_told():
    seen = []

    class Counts:
        def predict(self, observation, state, episode_start, deterministic):
            seen.append((state, episode_start.tolist(), deterministic))
            return np.full(len(observation), 5.0), (state or 0) + 1

    actor = BroughtActor("counts", Counts(), any_spaces.ACTIONS["box"])
    act = actor.begin(2, np.random.default_rng(0), deterministic=True)
    actions = [act(np.zeros((2, 2))) for _ in range(3)]
    assert seen == [
        (None, [True, True], True),
        (1, [False, False], True),
        (2, [False, False], True),
    ]
    assert actions[0].tolist() == [[1.0], [1.0]]  # clipped, in the shape of the space


def test_a_model_of_stable_baselines3_is_one_as_it_is():
    family = find_family("any_spaces:discrete")
    model = PPO("MlpPolicy", any_spaces.discrete(), n_steps=8, batch_size=8, seed=0)
    config = RolloutConfig(repetitions=2)
    tried = [
        policy_trials(family, family.settings(), "ppo", model, config, seed=0,
                      monitor=SilentMonitor())
        for _ in range(2)
    ]  # fmt: skip
    variants = len(family.space(family.settings()).variants)
    assert tried[0].n_trials == 2 * variants
    np.testing.assert_array_equal(tried[0].features, tried[1].features)


@pytest.mark.parametrize("given", [[3, 0], [0.5, 1.0], [-1, 2], ["a", "b"], [[0, 1], [1, 2]]])
def test_a_choice_that_there_is_not_is_refused(given):
    answers = iter(given)
    actor = BroughtActor("odd", lambda _: next(answers), any_spaces.ACTIONS["discrete"])
    act = actor.begin(2, np.random.default_rng(0), deterministic=False)
    with pytest.raises(InputError, match=r"The policy `odd` gave .*Discrete\(3\)"):
        act(np.zeros((2, 2)))


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("missing", "`policies` has no function `missing`."),
        ("asking", "`policies:asking` needs arguments: path."),
        ("nothing", "`policies:nothing` returned NoneType, not a policy."),
        ("failing", "The policy `policies:failing` fails (IndexError"),
        ("wide", "gave values of shape (36, 2) for 36 observations"),
        ("endless", "gave values that are not finite"),
        ("bare", "`predict` of the policy `policies:bare` returned ndarray."),
    ],
)
def test_what_is_no_policy_is_said_in_a_sentence(name, sentence, tmp_path, capsys):
    assert call(name) in (2, 3)
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "trials.parquet").exists()


@pytest.mark.parametrize(
    ("names", "out", "extra", "sentence"),
    [
        ((), "trials.parquet", (), "There is no policy to try."),
        (("constant",) * 2, "trials.parquet", (), "Two policies are called `policies:constant`."),
        (
            ("constant",),
            "trials.parquet",
            ("--network", "a", "--network", "b"),
            "2 names are given",
        ),
        (("constant",), "trials.txt", (), "is neither a .parquet nor a .csv file"),
        (
            ("constant",),
            "trials.parquet",
            ("--set", "learner.batch_size=3"),
            "`learner.batch_size` would do nothing here",
        ),
    ],
)
def test_what_is_asked_wrongly_is_said_before_anything_is_tried(
    names, out, extra, sentence, capsys
):
    assert call(*names, out=out, extra=extra) in (2, 3)
    assert sentence in capsys.readouterr().err
    assert "policies" not in sys.modules
