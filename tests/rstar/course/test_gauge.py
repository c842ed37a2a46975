import numpy as np
import pytest

from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.simulation import Simulation
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
