from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from surmount.envs.screen import has_display
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.course.single import ObstacleEnv
from surmount.rstar.robot.config import RobotConfig

IDS = [obstacle.gym_id for obstacle in OBSTACLES.values()]
FIXED = {"start": "fixed"}
SLOWER = EnvConfig(step_s=0.02)
"""Fifty steps a second, 1,000 an episode."""


@pytest.mark.parametrize("gym_id", IDS)
def test_gymnasiums_checker_is_content(gym_id):
    # Warnings are errors here. The render check would open a window, which needs a display.
    check_env(gymnasium.make(gym_id).unwrapped, skip_render_check=not has_display())


def test_observations_are_the_documented_terms_in_the_documented_units():
    env = ObstacleEnv("step")
    obs, info = env.reset(seed=0, options={"variant": 50, **FIXED})
    # yaw, pitch, FBEM, sprawl (48 − 90)/90, speed, 0.26438 m / 0.3 m, upper end of the range.
    expected = [0.0, 0.0, 0.0, -42 / 90, 0.0, 0.26438 / 0.3, 1.0]
    assert obs == pytest.approx(expected, abs=1e-5)
    # Target 0.32 m beyond the face.
    assert info["features"] == pytest.approx([0.0, 48.0, 0.0, 0.58438], abs=1e-5)
    obs, info = ObstacleEnv("narrow-channel").reset(seed=0, options={"variant": 250, **FIXED})
    assert obs == pytest.approx([0.0, 0.0, -42 / 90, 0.0, 0.26438 / 0.3, 0.0], abs=1e-5)


def test_rewards_of_a_standing_robot_are_those_of_eq_6():
    env = ObstacleEnv("step", config=SLOWER)
    env.reset(seed=0, options={"variant": 30, **FIXED})
    for _ in range(50):
        _, reward, _, _, info = env.step(np.zeros(3))
    # At rest: −1/1000 − 1e-4 x distance in cm, nothing for motion.
    expected = -0.001 - 1e-4 * info["features"][3] * 100
    assert reward == pytest.approx(expected, abs=1e-5)


def test_a_fixed_start_stands_still():
    for gear in ("wheels", "both"):
        env = ObstacleEnv("step", config=EnvConfig(robot=RobotConfig(gear=gear)))
        start, _ = env.reset(seed=0, options={"variant": 30, **FIXED})
        for _ in range(100):
            obs, _, _, _, _ = env.step(np.zeros(3))
        moved = np.abs(obs - start)
        assert moved[:2] * 90 == pytest.approx(0.0, abs=1.0)  # yaw and pitch, degrees
        assert moved[3] * 90 == pytest.approx(0.0, abs=1.0)  # sprawl under the robot's weight
        assert moved[5] * 0.3 == pytest.approx(0.0, abs=0.005)  # m along the course


@pytest.mark.parametrize("gym_id", IDS)
def test_the_same_seed_and_actions_give_the_same_bits_and_another_seed_does_not(gym_id):
    plan = np.random.default_rng(0).uniform(-1, 1, (30, 3))
    outcomes = []
    for seed in (7, 7, 8):
        env = gymnasium.make(gym_id)
        obs, info = env.reset(seed=seed)
        trajectory = [obs]
        for action in plan:
            obs, reward, *_, info = env.step(action)
            trajectory += [obs, [reward], info["features"], info["variant"]]
        outcomes.append(np.concatenate(trajectory))
    np.testing.assert_array_equal(outcomes[0], outcomes[1])
    assert not np.array_equal(outcomes[0], outcomes[2])


def test_actions_are_speed_fbem_and_sprawl_in_this_order():
    moved = []
    for action in np.eye(3):
        env = ObstacleEnv("step", config=SLOWER)
        before, _ = env.reset(seed=0, options={"variant": 30, **FIXED})
        for _ in range(10):
            after, _, _, _, _ = env.step(action)
        moved.append((after - before)[[4, 2, 3]] * [0.25, 72.0, 90.0])
    # A full action for 0.2 s: 0.2 m/s, 16 deg and 16 deg, which the servos follow with a lag.
    expected = np.diag([0.2, 16.0, 16.0])
    assert np.diag(moved) == pytest.approx(np.diag(expected), rel=0.25)
    others = np.array(moved)[~np.eye(3, dtype=bool)].reshape(3, 2)
    assert np.abs(others[1:, 0]).max() < 0.05  # wheels turn a little while the legs swing
    assert np.abs(others[:, 1]).max() < 1.0


def test_info_carries_the_papers_measures_of_a_trial():
    env = ObstacleEnv("low-entrance", config=SLOWER)
    _, info = env.reset(seed=0, options={"variant": 140, **FIXED})
    assert info["variant"].tolist() == [140.0]
    assert (info["sprawl_path_deg"], info["fbem_path_deg"]) == (0.0, 0.0)
    logged, terminated, step = [info["features"]], False, 0
    while not terminated:
        assert info["completion_time_s"] == 20.0  # the cap, as long as the target is not reached
        assert not info["is_success"]
        swing = np.sin(step / 10)
        _, _, terminated, _, info = env.step([1.0, swing, -swing])
        logged.append(info["features"])
        step += 1
    assert info["is_success"]
    assert info["completion_time_s"] == pytest.approx(0.02 * step, abs=1e-9)
    assert 2.0 < info["completion_time_s"] < 6.0  # 0.58 m at up to 0.25 m/s
    _, sprawl, fbem, _ = np.abs(np.diff(logged, axis=0)).sum(axis=0)
    assert info["sprawl_path_deg"] == pytest.approx(sprawl, rel=1e-9)
    assert info["fbem_path_deg"] == pytest.approx(fbem, rel=1e-9)
    assert info["fbem_path_deg"] > 50.0
    _, info = env.reset()
    assert (info["sprawl_path_deg"], info["fbem_path_deg"]) == (0.0, 0.0)


def test_a_failed_trials_completion_time_is_the_cap():
    env = ObstacleEnv("step", config=replace(SLOWER, episode_s=0.2))
    env.reset(seed=0, options={"variant": 30, **FIXED})
    for _ in range(10):
        _, _, terminated, truncated, info = env.step(np.zeros(3))
    assert (terminated, truncated) == (False, True)
    assert info["completion_time_s"] == 0.2
    assert not info["is_success"]
