import numpy as np
import pytest

from surmount.envs import rewards
from surmount.envs.config import RewardConfig

CONFIG = RewardConfig()


def test_time_costs_one_per_episode_and_three_times_that_when_tilted():
    # −(1 + 2 K_b)/S_m with S_m = 200: −0.005 upright, −0.015 beyond 100 deg of yaw or pitch.
    yaw = np.array([0.0, 100.0, -100.1, 0.0, 0.0])
    pitch = np.array([0.0, -100.0, 0.0, 120.0, -170.0])
    penalty = rewards.time_penalty(yaw, pitch, 200, CONFIG)
    assert penalty == pytest.approx([-0.005, -0.005, -0.015, -0.015, -0.015])


def test_distance_costs_more_the_further_the_robot_is_turned():
    # 58.4 cm left: 1e-4, 1e-3 and 1e-2 a centimetre up to 5 deg, up to 10 deg, and beyond.
    yaw = np.array([0.0, -5.0, 5.1, 10.0, -10.1, 90.0])
    penalty = rewards.distance_penalty(np.full(6, 0.584), yaw, CONFIG)
    assert penalty == pytest.approx([-0.00584, -0.00584, -0.0584, -0.0584, -0.584, -0.584])


def test_speed_costs_almost_nothing_either_way():
    # 250 mm/s at 1e-8 each.
    penalty = rewards.speed_penalty(np.array([0.25, -0.25, 0.0]), CONFIG)
    assert penalty == pytest.approx([-2.5e-6, -2.5e-6, 0.0])


def test_a_full_swing_of_the_fbem_costs_144_thousandths():
    # 0.005 per 5 degrees: 144 deg from end to end cost 0.144; sprawl alike.
    penalty = rewards.motion_penalty(
        np.array([0.0, -48.0, 8.0]), np.array([144.0, 0.0, -8.0]), CONFIG
    )
    assert penalty == pytest.approx([-0.144, -0.048, -0.016])


def test_endings_are_rewarded_with_plus_or_minus_five():
    reached, failed = np.array([True, False, False]), np.array([False, True, False])
    assert rewards.final_reward(reached, failed, CONFIG) == pytest.approx([5.0, -5.0, 0.0])


def test_units_of_distance_and_angle_are_fields():
    metres = RewardConfig(distance_unit_m=1.0, angle_unit_deg=1.0)
    one = np.ones(1)
    assert rewards.distance_penalty(one, 0 * one, metres) == pytest.approx([-1e-4])
    assert rewards.motion_penalty(one, one, metres) == pytest.approx([-0.01])
