"""The point mass moves, hits the wall and is rewarded as published, and goes on bit-identically."""

from __future__ import annotations

import json

import numpy as np
import pytest

from surmount.suite import point_mass
from surmount.suite.families import PointMassFamily
from surmount.suite.point_mass_env import PointMassVectorEnv
from surmount.tasks.distribution import TaskDistribution


def published_step(state, action, task, noise):
    """The publication's step for one mass: ten parts by Euler, a straight cut at the wall."""
    state = list(state)
    for part in range(10):
        x, vx, y, vy = state
        new = [
            min(4.0, max(-4.0, x + 0.01 * vx)),
            vx + 0.01 * (1.5 * action[0] + noise[part][0]),
            min(4.0, max(-4.0, y + 0.01 * vy)),
            vy + 0.01 * (1.5 * action[1] + noise[part][1]),
        ]
        if y >= 0 > new[2] or y <= 0 < new[2]:
            share = (0.0 - y) / (new[2] - y)
            crossed_at = share * new[0] + (1 - share) * x
            if abs(crossed_at - task[0]) > 0.5 * task[1]:
                return [crossed_at, 0.0, 0.0, 0.0], True
        state = new
    return state, False


def test_many_masses_at_once_move_as_one_by_one():
    rng = np.random.default_rng(0)
    state = rng.uniform([-4, -8, -1, -8], [4, 8, 1, 8], (500, 4))
    task = rng.uniform(point_mass.LOWER, point_mass.UPPER, (500, 2))
    actions = rng.uniform(-10, 10, (500, 2))
    noise = np.random.default_rng(1).normal(0.0, 0.05, (10, 500, 2))
    moved, crashed = point_mass.push(state, actions, task, np.random.default_rng(1))
    expected = [
        published_step(state[one], actions[one], task[one], noise[:, one]) for one in range(500)
    ]
    np.testing.assert_allclose(moved, [one for one, _ in expected], atol=1e-12)
    np.testing.assert_array_equal(crashed, [hit for _, hit in expected])
    assert 20 < crashed.sum() < 400  # both ways are tested


def test_actions_beyond_the_range_count_as_its_ends():
    state, task = np.array([point_mass.START]), np.array([[0.0, 8.0]])
    one, _ = point_mass.push(state, np.array([[50.0, -50.0]]), task, np.random.default_rng(0))
    other, _ = point_mass.push(state, np.array([[10.0, -10.0]]), task, np.random.default_rng(0))
    np.testing.assert_array_equal(one, other)


def fly(env: PointMassVectorEnv, steps: int, rng: np.random.Generator) -> list[np.ndarray]:
    return [env.step(rng.normal(0, 5, (env.num_envs, 2)))[0] for _ in range(steps)]


def test_it_goes_on_bit_identically_from_a_saved_state():
    first, second = PointMassVectorEnv(5), PointMassVectorEnv(5)
    first.reset(seed=3)
    fly(first, 70, np.random.default_rng(0))
    state = first.state_dict()
    saved = {
        key: value if isinstance(value, np.ndarray) else json.loads(json.dumps(value))
        for key, value in state.items()
    }
    second.load_state_dict(saved)
    for one, other in zip(
        fly(first, 90, np.random.default_rng(1)),
        fly(second, 90, np.random.default_rng(1)),
        strict=True,
    ):
        np.testing.assert_array_equal(one, other)


def test_episodes_end_at_the_wall_or_after_a_hundred_steps_and_begin_anew():
    env = PointMassVectorEnv(2)
    env.set_task_distribution(
        TaskDistribution.uniform(env.task_parameters, np.array([2.0, 0.5]), np.array([2.0, 0.5]))
    )
    env.reset(seed=0)
    pushed = np.array([[0.0, -10.0], [0.0, 10.0]])  # into the wall, and away from it
    ended = {}
    for step in range(1, 101):
        _, _, terminated, truncated, infos = env.step(pushed)
        for one in np.flatnonzero(terminated | truncated):
            ended.setdefault(int(one), (step, bool(terminated[one]), infos["final_info"]))
    assert ended[0][0] < 30
    assert ended[0][1]
    assert ended[0][2]["features"][0, 2] == 0.0  # it lies at the wall
    assert ended[0][2]["covered"][0] == pytest.approx(0.5)
    assert ended[1][:2] == (100, False)
    assert not ended[1][2]["is_success"][1]


def test_trials_stay_where_they_ended():
    family = PointMassFamily()
    space = family.space(None)
    env = family.trial_env(None, len(space.variants))
    env.reset(seed=0, options={"variant": space.variants})
    pushed = np.tile([0.0, -10.0], (len(space.variants), 1))
    for _ in range(120):
        observations, _, _, _, infos = env.step(pushed)
    # Straight down passes every gate that covers x = 0, and no other.
    names, group = family.right_groups(space.variants)
    assert names == ("straight", "left", "right")
    through = observations[:, 2] < 0
    open_ahead = np.abs(space.variants[:, 0]) < 0.5 * space.variants[:, 1] - 0.05
    blocked = group > 0
    assert through[open_ahead].all()
    assert not through[blocked].any()
    np.testing.assert_array_equal(infos["variant"], space.variants)


def test_targets_are_narrow_gates_far_aside_and_among_the_variants():
    family = PointMassFamily()
    target = family.target(None)
    tasks = target.sample(np.random.default_rng(0), 1_000)
    assert np.abs(np.abs(tasks[:, 0]) - 3.0).max() <= 0.02
    assert tasks[:, 1].min() >= 0.5
    variants = {tuple(one) for one in family.space(None).variants}
    assert set(point_mass.TARGETS) <= variants


def test_the_fingerprint_is_of_the_files_that_results_depend_on():
    assert len(PointMassFamily().fingerprint(None)) == 64
