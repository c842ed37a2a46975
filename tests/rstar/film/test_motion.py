"""A motion is the episode that it was recorded from, and a puppet stands where it says."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from surmount.core.errors import InputError
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import block_positions, find_obstacle
from surmount.rstar.film.motion import Puppet, record_motion, stand_still
from surmount.rstar.manoeuvres.manoeuvre import Player
from surmount.rstar.manoeuvres.stored import stored_manoeuvres

STEP = find_obstacle("step")
CONFIG = EnvConfig(step_s=0.1, episode_s=2.0)


def wriggle(observations, x_m):
    """Drive towards the step, swinging body and legs: a pilot."""
    swing = np.sin(40 * float(x_m[0]))
    return np.array([[0.8, swing, -swing]])


def test_a_motion_has_every_tick_of_the_episode_to_the_last_bit():
    motion = record_motion(STEP, CONFIG, 30.0, wriggle, caption="wriggle")
    env = ObstacleVectorEnv("step", 1, config=CONFIG, autoreset_mode=AutoresetMode.DISABLED)
    observations, infos = env.reset(options={"variant": 30.0, "start": "fixed"})
    positions = env.simulation.batch.bind("qpos")
    qpos, features = [positions[0].copy()], [infos["features"][0].copy()]
    for _ in range(20):
        observations, *_, infos = env.step(wriggle(observations, env.simulation.measure().x_m))
        qpos.append(positions[0].copy())
        features.append(infos["features"][0].copy())
    physics_steps = CONFIG.physics_steps_per_step
    assert len(motion.qpos) == 20 * physics_steps + 1
    np.testing.assert_array_equal(motion.qpos[::physics_steps], qpos)
    np.testing.assert_array_equal(motion.features, features)
    np.testing.assert_allclose(motion.time_s[::physics_steps], motion.features[:, 0], atol=1e-12)
    assert (
        np.abs(np.diff(motion.qpos, axis=0)).max(axis=1).min() > 0
    )  # every physics step moves something
    assert not motion.success
    assert motion.outcome == "had not reached the target after 2.00 s"


def test_a_motion_ends_with_the_episode_and_says_how():
    def drive(observations, x_m):
        return np.array([[1.0, 0.0, 0.0]])

    wide = record_motion(find_obstacle("narrow-channel"), EnvConfig(), 320.0, drive, caption="")
    assert wide.success
    assert wide.outcome == f"reached the target after {wide.duration_s:.2f} s"
    # 0.584 m, up to 0.25 m/s at 1 m/s²: 2.46 s and a little slip.
    assert 2.4 < wide.duration_s < 2.8


def test_a_standing_robot_is_recorded_as_long_as_asked():
    motion = record_motion(STEP, CONFIG, 30.0, stand_still, caption="", longest_s=0.5)
    assert motion.duration_s == pytest.approx(0.5)
    assert np.abs(motion.qpos[:, 0] - motion.qpos[0, 0]).max() < 0.005  # m along the course
    assert motion.outcome == "shown for 0.50 s"


def test_inadmissible_sizes_are_refused():
    with pytest.raises(InputError, match="height_mm 60 is not admissible"):
        record_motion(STEP, CONFIG, 60.0, stand_still, caption="")


@pytest.mark.parametrize("name", ["narrow-channel", "low-entrance", "step"])
def test_a_puppet_stands_where_the_motion_says_before_the_variant_it_says(name):
    obstacle = find_obstacle(name)
    sizes = obstacle.variants[[0, -1]]
    motions = [
        record_motion(obstacle, CONFIG, size, wriggle, caption="", longest_s=0.3) for size in sizes
    ]
    puppet = Puppet(motions[0])
    for motion in (*motions, motions[0]):
        puppet.follow(motion)
        data = puppet.at(0.2)
        row = round(0.2 / CONFIG.robot.physics_step_s)
        np.testing.assert_array_equal(data.qpos, motion.qpos[row])
        np.testing.assert_allclose(data.body("base").xpos, motion.qpos[row, :3], atol=1e-15)
        expected = block_positions(obstacle, CONFIG.course, np.array([motion.size_mm]))[0]
        np.testing.assert_array_equal(data.mocap_pos, expected)
        assert (puppet.at(99.0).qpos == motion.qpos[-1]).all()


@pytest.mark.parametrize("name", ["narrow-channel", "low-entrance", "step"])
def test_in_a_motion_nothing_floats_and_nothing_enters_another(name):
    config, stored = EnvConfig(), stored_manoeuvres(name)
    hardest = stored[-1 if name == "step" else 0]
    player = Player([hardest.manoeuvre], config.step_s)
    obstacle = find_obstacle(name)
    motion = record_motion(
        obstacle, config, hardest.size_mm, lambda _, x_m: player.act(x_m), caption=""
    )
    assert motion.success
    puppet = Puppet(motion)
    model = puppet.model
    robot, world = np.flatnonzero(model.geom_contype), np.flatnonzero(model.geom_conaffinity)
    gaps_mm = []
    for time_s in motion.time_s[::8]:
        data = puppet.at(time_s)
        gaps = [
            mujoco.mj_geomDistance(model, data, part, other, 0.01, None)
            for part in robot
            for other in world
        ]
        gaps_mm.append(1e3 * min(gaps))
    # Contacts give by some tenths of a millimetre, and moving legs make the wheels hop as far.
    assert min(gaps_mm) > -1.0
    assert max(gaps_mm) < 1.0
