import numpy as np
import pytest

from surmount.core.errors import ConfigError
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig, RewardConfig
from surmount.rstar.course.rewards import Reward

# 200 steps in an episode.
CONFIG = EnvConfig(step_s=0.1, episode_s=20.0)
REWARD = Reward(CONFIG)


def test_time_costs_one_per_episode_and_three_times_that_when_tilted():
    # −(1 + 2 K_b)/S_m with S_m = 200: −0.005 upright, −0.015 beyond 100 deg of yaw or pitch.
    yaw = np.array([0.0, 100.0, 100.1, 0.0, 0.0])
    pitch = np.array([0.0, 100.0, 0.0, 120.0, 170.0])
    penalty = REWARD.time(np.array([yaw, pitch]))
    assert penalty == pytest.approx([-0.005, -0.005, -0.015, -0.015, -0.015])
    assert REWARD.time(np.full((2, 3), 100.0)) == pytest.approx(-0.005)


def test_distance_costs_more_the_further_the_robot_is_turned():
    # 58.4 cm left: 1e-4, 1e-3 and 1e-2 a centimetre up to 5 deg, up to 10 deg, and beyond.
    yaw = np.array([0.0, 5.0, 5.1, 10.0, 10.1, 90.0])
    penalty = REWARD.distance(np.full(6, 0.584), yaw)
    assert penalty == pytest.approx([-0.00584, -0.00584, -0.0584, -0.0584, -0.584, -0.584])


def test_speed_costs_almost_nothing():
    # 250 mm/s at 1e-8 each.
    assert REWARD.speed(np.array([0.25, 0.0])) == pytest.approx([-2.5e-6, 0.0])


def test_a_full_swing_of_the_fbem_costs_144_thousandths():
    # 0.005 per 5 degrees: 144 deg from end to end cost 0.144; sprawl alike.
    penalty = REWARD.motion(np.array([[144.0, 0.0, 8.0], [0.0, 48.0, 8.0]]))
    assert penalty == pytest.approx([-0.144, -0.048, -0.016])
    weights = RewardConfig(fbem_weight=0.0, sprawl_weight=0.01)
    sprawl_only = Reward(EnvConfig(reward=weights))
    assert sprawl_only.motion(np.array([[144.0], [5.0]])) == pytest.approx([-0.01])


def test_endings_are_rewarded_with_plus_or_minus_five():
    reached, failed = np.array([True, False, False]), np.array([False, True, False])
    assert REWARD.final(reached, failed) == pytest.approx([5.0, -5.0, 0.0])


def test_units_of_distance_and_angle_are_fields():
    metres = Reward(EnvConfig(reward=RewardConfig(distance_unit_m=1.0, angle_unit_deg=1.0)))
    one = np.ones(1)
    assert metres.distance(one, 0 * one) == pytest.approx([-1e-4])
    assert metres.motion(np.ones((2, 1))) == pytest.approx([-0.01])


@pytest.mark.parametrize(("unit_m", "cost"), [(1.0, 5e-5), (0.1, 5e-4), (0.01, 5e-3)])
def test_half_a_metre_left_costs_a_decision_as_many_units_as_it_holds(unit_m, cost):
    reward = Reward(EnvConfig(reward=RewardConfig(distance_unit_m=unit_m)))
    assert reward.distance(np.array([0.5]), np.zeros(1)) == pytest.approx([-cost], rel=1e-12)


def test_a_swing_of_the_body_earns_nothing_where_the_carriers_are_measured():
    from surmount.rstar.course.measures import Measures  # noqa: PLC0415

    still = np.zeros((2, 2))
    rows = np.zeros((8, 2))
    rows[5] = [-0.1, -0.1 + 0.0476]  # the base at two FBEM angles, the wheels in the same place
    by_body = REWARD.running(Measures(rows=rows), still)
    assert by_body[1] - by_body[0] == pytest.approx(1e-4 * 4.76, rel=1e-9)
    carriers = Measures(rows=rows, carrier_x_m=np.array([-0.1, -0.1]))
    assert REWARD.running(carriers, still) == pytest.approx([by_body[0]] * 2, rel=1e-12)


def test_only_the_reward_asks_for_the_carriers_and_only_where_it_is_told_to():
    outcomes = {}
    for point in ("body", "carriers"):
        config = EnvConfig(reward=RewardConfig(distance_point=point), step_s=0.02)
        env = ObstacleVectorEnv("low-entrance", 2, config=config, n_threads=1)
        env.reset(seed=0, options={"variant": 140.0, "start": "fixed"})
        assert (env.simulation.measure().carrier_x_m is None) == (point == "body")
        steps = [env.step([[1.0, 0.7, 0.0], [1.0, -0.7, 0.0]]) for _ in range(120)]
        outcomes[point] = steps
    for body, carriers in zip(*outcomes.values(), strict=True):
        np.testing.assert_array_equal(body[0], carriers[0])
        np.testing.assert_array_equal(body[2], carriers[2])  # success is judged by the base
        left = np.isclose(body[1], carriers[1], rtol=0, atol=1e-9)
        assert not left.all() or body[4]["features"][0, 0] < 0.1
    assert any(step[2].any() for step in outcomes["body"])
    assert EnvConfig().reward.distance_point == "body"
    with pytest.raises(ConfigError, match="distance_point"):
        RewardConfig(distance_point="wheels")


def test_the_sum_takes_magnitudes_of_signed_measures_and_stops_at_the_target():
    from surmount.rstar.course.measures import Measures  # noqa: PLC0415

    # yaw, pitch, FBEM, sprawl, speed, x, y, z; the second robot is 0.1 m beyond the target.
    rows = np.array([[-7.0, 0.0, 0, 48, -0.25, 0.12, 0, 0], [0, -150.0, 0, 48, 0, 0.42, 0, 0]]).T
    total = REWARD.running(Measures(rows=rows), np.array([[5.0, 0.0], [0.0, 0.0]]))
    first = -0.005 - 1e-3 * 20 - 2.5e-6 - 0.005
    assert total == pytest.approx([first, -0.015], rel=1e-9)
