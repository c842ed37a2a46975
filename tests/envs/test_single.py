import os

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.utils.passive_env_checker import env_render_passive_checker

from surmount.envs import OBSTACLES, EnvConfig, ObstacleEnv
from surmount.robot import RobotConfig

IDS = [obstacle.gym_id for obstacle in OBSTACLES.values()]
FIXED = {"start": "fixed"}


@pytest.mark.parametrize("gym_id", IDS)
def test_gymnasiums_checker_is_content(gym_id):
    # Warnings are errors here. The render check would open a window, which needs a display.
    check_env(gymnasium.make(gym_id).unwrapped, skip_render_check="DISPLAY" not in os.environ)


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
    env = ObstacleEnv("step")
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
def test_frames_show_the_robot(gym_id, monkeypatch):
    if "DISPLAY" not in os.environ and "MUJOCO_GL" not in os.environ:
        pytest.skip("needs a display or MUJOCO_GL=egl")
    env = gymnasium.make(gym_id, render_mode="rgb_array")
    env.reset(seed=0, options=FIXED)
    env_render_passive_checker(env)
    frame = env.render()
    assert frame.shape == (480, 640, 3)
    red, green, blue = (frame[..., i].astype(int) for i in range(3))
    orange = (red > 150) & (red - blue > 80) & (red - green > 50)
    assert 500 < orange.sum() < 50_000  # the body's shell
    env.close()
