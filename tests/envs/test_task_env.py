"""Tasks hold across automatic resets everywhere, and a saved episode is come back to."""

from __future__ import annotations

import gymnasium
import numpy as np
import own_point
import pytest
from own_point import PointEnv, make_env, make_point, set_task
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv

from surmount.core.errors import InputError
from surmount.envs.batch import TaskBatch
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace, harder_by_success

NARROW = TaskDistribution.uniform(
    ("distance_m", "wind"), np.array([1.2, 0.5]), np.array([1.4, 0.6])
)


def within(tasks) -> bool:
    tasks = np.asarray(tasks)
    return bool(((tasks >= [1.2, 0.5]) & (tasks <= [1.4, 0.6])).all())


@pytest.mark.parametrize("kind", [DummyVecEnv, SubprocVecEnv])
def test_a_distribution_holds_in_the_vector_envs_of_stable_baselines(kind):
    options = {"start_method": "spawn"} if kind is SubprocVecEnv else {}
    env = kind([make_env, make_env], **options)
    try:
        env.env_method("set_task_distribution", NARROW)
        env.seed(0)
        env.reset()
        tasks, goals, ended = [], [], 0
        for _ in range(40):
            observation, _, dones, infos = env.step(np.full((2, 1), -1.0))
            ended += int(dones.sum())
            tasks += [info["variant"] for info in infos]
            goals += (observation.sum(axis=1)[~dones]).tolist()
        assert ended == 6  # three episodes of 12 steps in each of two environments
        assert within(tasks)
        assert len({tuple(task) for task in tasks}) == 8
        assert all(1.2 - 1e-5 <= goal <= 1.4 + 1e-5 for goal in goals)  # what is simulated
    finally:
        env.close()


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_a_distribution_holds_in_the_vector_envs_of_gymnasium(mode):
    if mode == "sync":
        env = gymnasium.vector.SyncVectorEnv([make_env, make_env])
    else:
        env = gymnasium.vector.AsyncVectorEnv([make_env, make_env], context="spawn")
    try:
        env.call("set_task_distribution", NARROW)
        _, infos = env.reset(seed=0)
        tasks, ended = [infos["variant"]], 0
        for _ in range(40):
            _, _, terminated, truncated, infos = env.step(np.full((2, 1), -1.0, np.float32))
            ended += int((terminated | truncated).sum())
            tasks.append(infos["variant"])
        assert ended >= 4
        assert within(np.concatenate(tasks))
    finally:
        env.close()


def test_the_batch_resets_in_the_same_step_and_tells_the_last_infos():
    batch = TaskBatch(make_env, 3)
    assert batch.step_s == batch.envs[0].step_s
    batch.set_task_distribution(NARROW)
    _, infos = batch.reset(seed=1)
    before = infos["variant"].copy()
    for _ in range(12):
        observation, _, _, truncated, infos = batch.step(np.full((3, 1), -1.0))
    assert truncated.all()
    np.testing.assert_array_equal(infos["final_info"]["variant"], before)
    assert infos["final_info"]["features"][:, 0] == pytest.approx(12 * 0.05)
    assert (infos["variant"] != before).any(axis=1).all()
    assert (infos["features"][:, 0] == 0.0).all()
    assert (np.abs(observation[:, 0]) <= 0.1).all()
    assert (infos["final_obs"][:, 0] < -2.0).all()


def test_without_autoreset_an_ended_episode_stays_as_it_is():
    batch = TaskBatch(make_env, 2, autoreset=False)
    batch.reset(seed=0, options={"variant": np.array([[0.5, 0.0], [2.0, 0.0]])})
    for _ in range(5):
        _, _, _, _, infos = batch.step(np.full((2, 1), 1.0))
    assert infos["is_success"].tolist() == [True, False]
    frozen = infos["features"][0].copy()
    for _ in range(3):
        _, rewards, terminated, _, infos = batch.step(np.full((2, 1), 1.0))
        assert rewards[0] == 0.0
        assert not terminated[0]
    np.testing.assert_array_equal(infos["features"][0], frozen)
    assert infos["features"][1, 0] == pytest.approx(8 * 0.05)


def test_seeds_repeat_tasks_and_starts_and_differ_between_environments():
    def begin(seed):
        batch = TaskBatch(make_env, 3)
        observation, infos = batch.reset(seed=seed)
        return np.column_stack([observation, infos["variant"]])

    np.testing.assert_array_equal(begin(5), begin(5))
    assert (begin(5) != begin(6)).any(axis=1).all()
    assert len(np.unique(begin(5), axis=0)) == 3


def test_a_saved_batch_goes_on_identically_from_the_middle_of_episodes():
    rng = np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (40, 3, 1))
    one, other = TaskBatch(make_env, 3), TaskBatch(make_env, 3)
    one.set_task_distribution(NARROW)
    one.reset(seed=0)
    for action in actions[:17]:
        one.step(action)
    other.load_state_dict(one.state_dict())
    for action in actions[17:]:
        first, second = one.step(action), other.step(action)
        for a, b in zip(first[:4], second[:4], strict=True):
            np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(first[4]["variant"], second[4]["variant"])


def test_an_environment_that_cannot_be_repeated_is_warned_of():
    class Forgetful(PointEnv):
        def _observe(self):
            return super()._observe() + np.float32(np.random.rand())  # noqa: NPY002

    batch = TaskBatch(lambda: make_point(Forgetful()), 1)
    batch.reset(seed=0)
    batch.step(np.zeros((1, 1)))
    with pytest.warns(UserWarning, match="came elsewhere"):
        batch.load_state_dict(batch.state_dict())


def test_the_task_may_go_through_the_options_of_reset():
    env = make_point(set_task="task")
    _, info = env.reset(options={"variant": [1.5, 2.0], "other": 1})
    assert env.unwrapped.task_of_reset == {"task": {"distance_m": 1.5, "wind": 2.0}, "other": 1}
    assert info["variant"].tolist() == [1.5, 2.0]


def test_the_task_can_be_observed_on_a_scale_of_its_range():
    env = make_point(observe_task=True)
    observation, _ = env.reset(seed=0, options={"variant": [2.0, 1.0]})
    assert observation[-2:].tolist() == [1.0, 0.0]
    assert env.observation_space.contains(observation)
    assert observation.dtype == np.float32


def test_success_can_end_an_episode():
    env = make_point(
        success=lambda transition: transition.observation[0] > 0.5, end_on_success=True
    )
    env.reset(seed=0, options={"variant": [2.0, 0.0]})
    ended = False
    while not ended:
        observation, _, ended, _, info = env.step(np.ones(1))
    assert info["is_success"]
    assert 0.5 < observation[0] < 0.75


def told_success(told, *, by_key: bool) -> bool:
    class Telling(PointEnv):
        def step(self, action):
            *moment, info = super().step(action)
            return *moment, {**info, "reached": told}

    env = make_point(Telling(), success="reached" if by_key else lambda t: t.info["reached"])
    env.reset(seed=0)
    return env.step(np.zeros(1))[-1]["is_success"]


@pytest.mark.parametrize("by_key", [True, False])
def test_success_is_true_or_false_or_a_number_that_is_1_or_0(by_key):
    yes = [True, np.True_, 1, 1.0, np.float32(1), np.array([True]), np.array([[1.0]])]
    no = [False, np.False_, 0, 0.0, np.float32(0), np.array([False]), np.array(0)]
    assert [told_success(told, by_key=by_key) for told in yes] == [True] * 7
    assert [told_success(told, by_key=by_key) for told in no] == [False] * 7
    assert not told_success(None, by_key=True)  # before the end: it is not told yet


@pytest.mark.parametrize("told", [np.nan, 0.1, 2, "no", np.array([True, False]), {}])
def test_whatever_else_tells_success_is_refused_with_its_value(told):
    with pytest.raises(InputError, match="neither true nor false") as caught:
        told_success(told, by_key=True)
    assert caught.value.message.startswith(f"`info['reached']` is {told!r}, ")
    assert 'success=lambda t: t.info["reached"] >= 1' in caught.value.remedy
    with pytest.raises(InputError, match=r"^What `success` returns is .* neither true nor false"):
        told_success(told, by_key=False)


def test_a_state_that_is_no_longer_finite_ends_the_episode_as_diverged():
    class Exploding(PointEnv):
        def step(self, action):
            observation, *rest = super().step(action)
            return observation * np.float32(np.nan), *rest

    env = make_point(Exploding())
    first, _ = env.reset(seed=0)
    observation, reward, terminated, _, info = env.step(np.zeros(1))
    assert (terminated, reward, info["diverged"], info["is_success"]) == (True, 0.0, True, False)
    np.testing.assert_array_equal(observation, first)


def failing(*, step=None, reset=None):
    """The point, which fails at a step or in its reset."""

    class Failing(PointEnv):
        def reset(self, **options):
            self.steps = 0
            if reset:
                raise reset
            return super().reset(**options)

        def step(self, action):
            self.steps += 1
            if self.steps == 3 and step:
                raise step
            return super().step(action)

    return make_point(Failing())


def test_an_environment_that_fails_is_said_with_its_step_task_and_seed():
    lost = ValueError("sensor lost")
    env = failing(step=lost)
    env.reset(seed=0, options={"variant": [1.5, 2.0]})
    seed = env.state_dict()["seed"]
    for _ in range(2):
        env.step(np.zeros(1))
    where = f"on task distance_m=1.5, wind=2, seed {seed} (ValueError: sensor lost)."
    with pytest.raises(InputError) as caught:
        env.step(np.zeros(1))
    assert caught.value.message == f"The environment fails in `step` 3 {where}"
    assert caught.value.__cause__ is lost
    with pytest.raises(InputError) as caught:
        failing(reset=lost).reset(seed=0, options={"variant": [1.5, 2.0]})
    assert caught.value.message == f"The environment fails in `reset` {where}"


@pytest.mark.parametrize("error", [TimeoutError("alarm"), InputError("Said.", remedy="Done.")])
def test_an_alarm_and_what_is_said_already_are_passed_on(error):
    with pytest.raises(type(error)) as caught:
        failing(reset=error).reset()
    assert caught.value is error


def rewarded(value) -> float:
    class Paying(PointEnv):
        def step(self, action):
            observation, _, *rest = super().step(action)
            return observation, value, *rest

    env = make_point(Paying())
    env.reset(seed=0)
    return env.step(np.zeros(1))[1]


def test_a_reward_of_one_element_is_a_number_and_any_other_is_said_with_its_value():
    values = [np.float32(0.5), np.array(0.5), np.array([0.5]), np.array([[0.5]]), [0.5]]
    assert [rewarded(value) for value in values] == [0.5] * 5
    for value in (np.array([0.5, 1.0]), None, "much", []):
        with pytest.raises(InputError, match="not one number") as caught:
            rewarded(value)
        assert caught.value.message == f"The reward is {value!r}, not one number."
    env = make_point(features={"both": lambda transition: transition.observation})
    with pytest.raises(InputError, match=r"The feature `both` is array\(.*not one number"):
        env.reset(seed=0)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_an_observation_of_reset_that_is_not_finite_is_refused_with_its_task(value):
    class Unplaced(PointEnv):
        def reset(self, **options):
            _, info = super().reset(**options)
            return np.array([0.0, value], np.float32), info

    sentence = f"After `reset`, observation 1 is {value} on task distance_m=1.5, wind=2."
    with pytest.raises(InputError, match=sentence):
        make_point(Unplaced()).reset(options={"variant": [1.5, 2.0]})


@pytest.mark.parametrize(
    ("action", "sentence"),
    [
        (lambda: make_point(features={}), "`features` is empty"),
        (lambda: make_point(features={"a": "nothing"}).reset(), "`info\\['nothing'\\]`"),
        (lambda: make_point().reset(options={"variant": [1.0]}), "does not fit distance_m, wind"),
        (
            lambda: make_point().set_task_distribution(
                TaskDistribution.uniform(("x",), np.zeros(1), np.ones(1))
            ),
            "is over x, the environment over distance_m, wind",
        ),
        (TaskSpace.grid, "no parameter"),
        (lambda: TaskSpace.grid(a=[1, 1]), "names a variant twice"),
        (lambda: TaskSpace.grid(a=[1, 2], harder={"b": 1}), "`harder` names"),
        (lambda: TaskSpace.grid(a=[1, 2], harder={"a": 2}), "not 1 or -1"),
        (lambda: TaskSpace.grid(a=[1, float("nan")]), "cannot be nan"),
    ],
)
def test_what_is_missing_is_said(action, sentence):
    with pytest.raises(InputError, match=sentence):
        action()


def test_a_grid_has_every_combination_and_the_outermost_values_as_range():
    space = TaskSpace.grid(a=[3, 1], b=[0, 5, 10], harder={"a": 1, "b": -1})
    assert space.variants.tolist() == [[1, 0], [1, 5], [1, 10], [3, 0], [3, 5], [3, 10]]
    assert space.lower.tolist() == [1, 0]
    assert space.upper.tolist() == [3, 10]
    assert space.harder == (1, -1)


def test_the_direction_of_difficulty_follows_success():
    variants = own_point.make_env().space.variants
    success = 1.0 - 0.2 * variants[:, 0] + 0.1 * variants[:, 1]
    assert harder_by_success(variants, success) == (1, -1)
    assert harder_by_success(variants, np.ones(len(variants))) == (1, 1)
    assert callable(set_task)
