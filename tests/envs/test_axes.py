"""Environments of one's own over whole numbers, categories and logarithmic axes."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from own_point import PointEnv, make_point

from surmount.core.axis import CONTINUOUS, Axis
from surmount.core.errors import ConfigError, InputError
from surmount.envs.batch import TaskBatch
from surmount.envs.check import check_contract
from surmount.envs.own_family import OwnFamily
from surmount.envs.own_settings import OwnSettings
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace

WINDS = {"calm": 0.0, "breeze": 1.0, "storm": 2.0}


def set_mixed(env, task):
    env.seen = task
    env.goal = 0.5 * len(range(task["n_halves"])) * task["scale"]
    env.wind = WINDS[task["weather"]]


def make_mixed(**changes):
    space = TaskSpace.grid(
        n_halves=[1, 2, 3],
        scale=[0.5, 1.0, 2.0],
        weather=list(WINDS),
        axes={"scale": "logarithmic"},
    )
    return make_point(**({"space": space, "set_task": set_mixed} | changes))


class Lidar(PointEnv):
    """A range sensor is infinite where nothing is near (REP 117)."""

    def __init__(self):
        super().__init__()
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (3,), np.float32)

    def _observe(self):
        echo = self.goal - self.position
        return np.array([self.position, echo, echo if echo < 1.0 else np.inf], dtype=np.float32)


class Fading(Lidar):
    """Its echo is lost on the way."""

    def _observe(self):
        seen = super()._observe()
        seen[2] = 1.0 if abs(self.position) < 0.15 else np.inf
        return seen


class Exploding(PointEnv):
    """All numbers overflow at once, some way from the start."""

    def _observe(self):
        return super()._observe() * np.float32(1.0 if abs(self.position) < 0.6 else np.inf)


def test_a_whole_number_arrives_as_an_int_and_a_category_as_its_name():
    env = make_mixed()
    env.reset(seed=0)
    for _ in range(50):
        _, info = env.reset()
        task = env.unwrapped.seen
        assert [type(value) for value in task.values()] == [int, float, str]
        assert env.space.task(list(task.values())).tolist() == info["variant"].tolist()


def test_a_variant_can_be_set_by_names_or_by_what_stands_for_them():
    env = make_mixed()
    env.reset(options={"variant": [2, 0.7, "storm"]})
    assert env.unwrapped.seen == {"n_halves": 2, "scale": 0.7, "weather": "storm"}
    env.reset(options={"variant": np.array([2, 0.7, 2.0])})
    assert env.unwrapped.seen["weather"] == "storm"
    with pytest.raises(InputError, match="'fog' as `weather`"):
        env.reset(options={"variant": [2, 0.7, "fog"]})


def test_the_contract_holds_with_axes_of_every_kind():
    findings = check_contract(make_mixed)
    assert [finding.sentence for finding in findings if not finding.holds] == []
    (axes,) = (finding for finding in findings if finding.clause == "task parameters have axes")
    assert axes.sentence == (
        "n_halves: 1 to 3, whole numbers; scale: 0.5 to 2, logarithmic; "
        "weather: one of calm, breeze, storm"
    )


def test_a_category_that_changes_nothing_is_found_and_one_in_the_middle_counts():
    def only_breeze(env, task):
        env.goal = task["n_halves"] * task["scale"]
        env.wind = float(task["weather"] == "breeze")

    broken = [
        f.clause for f in check_contract(lambda: make_mixed(set_task=only_breeze)) if not f.holds
    ]
    assert broken == []

    def deaf(env, task):
        env.goal = task["n_halves"] * task["scale"]

    broken = [f for f in check_contract(lambda: make_mixed(set_task=deaf)) if not f.holds]
    assert [finding.clause for finding in broken] == ["weather changes the task"]
    assert "at calm and storm" in broken[0].sentence


def test_values_that_are_even_in_their_logarithm_are_noted_where_draws_are_not():
    def make(**kinds):
        space = TaskSpace.grid(distance_m=np.logspace(-1, 1, 5), axes=kinds)
        return make_point(space=space, set_task=lambda e, t: setattr(e, "goal", t["distance_m"]))

    (note,) = (f.note for f in check_contract(make) if f.clause == "task parameters have axes")
    assert 'declare axes={"distance_m": "logarithmic"} in TaskSpace.grid' in note
    declared = check_contract(lambda: make(distance_m="logarithmic"))
    assert [f.note for f in declared if f.clause == "task parameters have axes"] == [""]


def test_an_infinite_sensor_is_to_be_clipped_and_a_simulation_that_explodes_to_be_ended():
    lidar, fading = finite(Lidar()), finite(Fading())
    assert not lidar.holds
    assert not fading.holds
    assert "After `reset`, observation 2 is inf on task distance_m=1, wind=0." in lidar.sentence
    assert "to its range" in lidar.remedy
    assert fading.sentence == "not finite: observation 2"
    assert "These are infinite while the others are finite" in fading.remedy
    found = finite(Exploding())
    assert found.holds
    assert found.note.startswith(
        "6 of 15 episodes ended because the simulation diverged (not finite: observation 0, 1)"
    )


def finite(env):
    findings = check_contract(lambda: make_point(env))
    (found,) = (f for f in findings if f.clause == "observations and rewards are finite")
    return found


def test_an_environment_most_of_whose_episodes_diverge_breaks_the_contract():
    class Unrewarded(PointEnv):
        def step(self, action):
            observation, _, *rest = super().step(action)
            return observation, np.nan, *rest

    found = finite(Unrewarded())
    assert not found.holds
    assert found.sentence == (
        "not finite: rewards; 15 of 15 episodes ended because the simulation diverged"
    )


def test_a_distribution_over_other_axes_is_refused():
    env = make_mixed()
    whole = env.space.whole_range
    env.set_task_distribution(whole)
    other = TaskDistribution.uniform(env.space.parameters, env.space.lower, env.space.upper)
    with pytest.raises(InputError, match=r"logarithmic and categorical \(calm, breeze, storm\)"):
        env.set_task_distribution(other)


def test_an_observed_category_has_one_number_for_each_name():
    env = make_mixed(observe_task=True)
    observation, _ = env.reset(options={"variant": [3, 0.5, "breeze"]})
    assert env.observation_space.shape == (2 + 1 + 1 + 3,)
    np.testing.assert_allclose(observation[2:], [1.0, -1.0, -1.0, 1.0, -1.0], atol=1e-6)
    middle, _ = env.reset(options={"variant": [2, 1.0, "calm"]})
    np.testing.assert_allclose(middle[2:4], [0.0, 0.0], atol=1e-6)


def test_a_saved_moment_keeps_its_axes():
    env = make_mixed()
    env.reset(seed=3)
    for _ in range(4):
        env.step(np.array([1.0]))
    again = make_mixed()
    assert again.load_state_dict(env.state_dict())
    assert again.reset()[1]["variant"].tolist() == env.reset()[1]["variant"].tolist()


def test_a_configuration_declares_axes_that_the_environment_does_not():
    def make():
        space = TaskSpace.grid(distance_m=[0.5, 1.0, 2.0], wind=[0.0, 1.0])
        return make_point(
            space=space,
            set_task=lambda e, t: setattr(e, "seen", t) or setattr(e, "goal", t["distance_m"]),
        )

    family = OwnFamily("mine:make", make)
    settings = OwnSettings(logarithmic=("distance_m",), integer=("wind",))
    assert [axis.kind for axis in family.space(settings).axes] == ["logarithmic", "integer"]
    batch = family.training_env(settings, 2)
    assert isinstance(batch, TaskBatch)
    assert batch.task_axes == (Axis(kind="logarithmic"), Axis(kind="integer"))
    batch.reset(seed=0)
    assert isinstance(batch.envs[0].unwrapped.seen["wind"], int)
    assert family.space(OwnSettings()).axes == (CONTINUOUS, CONTINUOUS)
    with pytest.raises(InputError, match="no parameter `mass`"):
        family.space(OwnSettings(integer=("mass",)))
    with pytest.raises(ConfigError, match="`wind` is named twice"):
        OwnSettings(integer=("wind",), categorical=("wind",))
