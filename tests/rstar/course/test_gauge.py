import numpy as np
import pytest

from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig, RewardConfig
from surmount.rstar.course.measures import MEASURES
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.start_poses import Start
from surmount.rstar.robot.config import RobotConfig


@pytest.mark.parametrize(
    ("gear", "driven", "radius_m"), [("wheels", 4, 0.03058), ("whegs", 6, 0.027)]
)
def test_measures_are_those_of_mujocos_own_frames_and_joints(gear, driven, radius_m):
    env = ObstacleVectorEnv("step", 4, config=EnvConfig(robot=RobotConfig(gear=gear)), n_threads=1)
    env.reset(seed=0)
    simulation: Simulation = env.simulation
    rng = np.random.default_rng(0)
    for _ in range(20):
        env.step(rng.uniform(-1, 1, (4, 3)))
    # Any attitude, so that no sign or axis of the rotation goes unseen.
    attitude = rng.normal(size=(4, 4))
    simulation.batch.bind("qpos")[:, 3:7] = attitude / np.linalg.norm(attitude, axis=1)[:, None]
    measures = simulation.measure()
    for index in range(4):
        data = simulation.data(index)
        forward, left, up = data.body("base").xmat.reshape(3, 3).T
        joint = {name: data.joint(name) for name in _joints(simulation.model)}
        wheels = [
            j.qvel[0] for name, j in joint.items() if name.endswith(("front", "middle", "rear"))
        ]
        assert len(wheels) == driven
        expected = {
            "yaw_deg": np.degrees(np.arctan2(-left[0], left[1])),
            "pitch_deg": np.degrees(np.arctan2(forward[2], up[2])),
            "fbem_deg": np.degrees((joint["left_fbem"].qpos + joint["right_fbem"].qpos)[0] / 2),
            "sprawl_deg": np.degrees(
                (joint["left_sprawl"].qpos + joint["right_sprawl"].qpos)[0] / 2
            ),
            "speed_mps": radius_m * np.mean(wheels),
        }
        expected |= dict(zip(("x_m", "y_m", "z_m"), data.body("base").xpos, strict=True))
        for name, value in expected.items():
            assert getattr(measures, name)[index] == pytest.approx(value, abs=1e-9), name


CARRIERS = EnvConfig(reward=RewardConfig(distance_point="carriers"))


def mid_wheelbase_m(data):
    """Mean of both sides' middle between the axles of MuJoCo's own wheel bodies, in m."""
    places = [f"{side}_{place}" for side in ("left", "right") for place in ("front", "rear")]
    return np.mean([data.body(place).xpos for place in places], axis=0)


def test_the_carriers_position_is_that_of_mujocos_own_wheels_in_any_attitude():
    env = ObstacleVectorEnv("step", 4, config=CARRIERS, n_threads=1)
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(40):
        env.step(rng.uniform(-1, 1, (4, 3)))
    attitude = rng.normal(size=(4, 4))
    qpos = env.simulation.batch.bind("qpos")
    qpos[:, 3:7] = attitude / np.linalg.norm(attitude, axis=1)[:, None]
    qpos[2:, env.simulation.model.joint("left_sprawl").qposadr[0]] += 0.2  # one leg pushed out
    found = env.simulation.measure().carrier_x_m
    expected = [mid_wheelbase_m(env.simulation.data(index))[0] for index in range(4)]
    # Parallelograms give way by hundredths of a degree, which the closed form leaves out.
    assert found == pytest.approx(expected, abs=2e-5)
    assert np.abs(found - env.simulation.measure().x_m).max() > 0.02


def test_the_carriers_of_a_level_robot_are_behind_the_base_by_the_body_shift():
    env = ObstacleVectorEnv("step", 3, config=CARRIERS, n_threads=1)
    env.reset(seed=0, options={"variant": 30.0, "start": "fixed"})
    simulation = env.simulation
    for index, fbem_deg in enumerate((-72.0, 0.0, 72.0)):
        start = Start(x_m=-0.2, y_m=0, z_m=0.1, yaw_deg=0, sprawl_deg=30, fbem_deg=fbem_deg)
        simulation.place(index, 30.0, start)
    # 50.09 mm · sin 72° = 47.64 mm.
    expected = [-0.2 + 0.04764, -0.2, -0.2 - 0.04764]
    assert simulation.measure().carrier_x_m == pytest.approx(expected, abs=1e-5)


def test_servo_targets_are_the_sums_of_the_actions_where_the_joints_are_blocked():
    env = ObstacleVectorEnv("step", 2, config=EnvConfig(observe_targets=True), n_threads=1)
    env.reset(seed=0, options={"variant": 50.0, "start": "fixed"})
    plain = ObstacleVectorEnv("step", 2, n_threads=1)
    plain.reset(seed=0, options={"variant": 50.0, "start": "fixed"})
    for _ in range(20):  # 0.2 s
        action = np.array([[1.0, 0.5, -1.0], [-1.0, -1.0, 1.0]])
        env.step(action)
        plain.step(action)
    targets = env.simulation.measure().rows[len(MEASURES) :]
    expected = [[0.2, -0.2], [8.0, -16.0], [48.0 - 16.0, 48.0 + 16.0]]
    assert targets == pytest.approx(np.array(expected), abs=1e-9)
    measured = env.simulation.measure().rows[: len(MEASURES)]
    np.testing.assert_array_equal(measured, plain.simulation.measure().rows)


def test_a_measurement_stays_as_it_was_when_the_next_is_taken():
    env = ObstacleVectorEnv("step", 2, n_threads=1)
    env.reset(seed=0)
    before = env.simulation.measure()
    kept = before.rows.copy()
    env.step(np.ones((2, 3)))
    assert (env.simulation.measure().speed_mps != before.speed_mps).all()
    np.testing.assert_array_equal(before.rows, kept)


def _joints(model):
    return [model.joint(index).name for index in range(model.njnt)]
