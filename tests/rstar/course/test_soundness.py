import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from soundness import Soundness

from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.robot.config import RobotConfig

TICK = EnvConfig(step_s=RobotConfig().physics_step_s)
"""Steps of one physics step: what the cheap looks see is the state that was planted."""
STEP_MM = 40.0


def watched(name="step", num_envs=1, config=TICK):
    mode = AutoresetMode.DISABLED  # after a reset there is nothing to see
    env = ObstacleVectorEnv(name, num_envs, config=config, n_threads=1, autoreset_mode=mode)
    looks = Soundness(env.obstacle, config, env.simulation)
    env.reset(seed=0, options={"start": "fixed", "variant": 200.0 if "ch" in name else STEP_MM})
    return env, looks


def plant(env, **values):
    """Put the first robot somewhere, and look at it from one physics step later."""
    qpos = env.simulation.batch.bind("qpos")[0]
    for joint, value in values.items():
        place = "xyz".find(joint)
        if place < 0:
            place = int(env.simulation.model.joint(joint).qposadr[0])
        qpos[place] = value
    return env.simulation.data(0), env.step(np.zeros((1, 3)))


@pytest.mark.parametrize("name", list(OBSTACLES))
def test_a_sound_simulation_is_quiet(name):
    env = ObstacleVectorEnv(name, 4, n_threads=1)
    looks = Soundness(env.obstacle, env.config, env.simulation)
    _, infos = env.reset(seed=0)
    rng = np.random.default_rng(0)
    for step in range(60):
        size_mm = infos["variant"][:, 0]
        *_, infos = env.step(rng.uniform(-1, 1, (4, 3)))
        assert not looks.tunnelled(size_mm).any()
        # It weighs 24.4 N, stands with its centre between 0 and 150 mm above floor or step, and has
        # hardly begun to move.
        potential, kinetic = looks.energy_j().T
        assert ((potential > 0) & (potential < 24.4 * 0.15)).all()
        assert ((kinetic >= 0) & (kinetic < 1.0)).all()
        assert (looks.speed_mps() < 1.0).all()
        if step % 20 == 19:
            data = env.simulation.data(step % 4)
            assert max(looks.penetration_mm(data)) < 2.0
            assert looks.self_penetration_mm(data) < 0.5


@pytest.mark.parametrize("gear", ["wheels", "both"])
def test_watching_changes_no_bit_of_the_simulation(gear):
    config = EnvConfig(robot=RobotConfig(gear=gear))
    states = []
    for watch in (False, True):
        env = ObstacleVectorEnv("step", 3, config=config, n_threads=1)
        if watch:
            Soundness(env.obstacle, config, env.simulation)
        env.reset(seed=1)
        rng = np.random.default_rng(1)
        for _ in range(50):
            env.step(rng.uniform(-1, 1, (3, 3)))
        states.append(env.state_dict()["simulation"])
    np.testing.assert_array_equal(*states)


def test_energies_and_speeds_are_mujocos():
    env, looks = watched(num_envs=2)
    rng = np.random.default_rng(0)
    for _ in range(40):
        data = [env.simulation.data(index) for index in range(2)]
        env.step(rng.uniform(-1, 1, (2, 3)))
        for index in range(2):
            energy, model = looks.energy_j()[index], env.simulation.model
            body = slice(1, model.body("step_block").id)
            weight_n = 9.81 * model.body_mass[body]
            assert energy[0] == pytest.approx(weight_n @ data[index].xipos[body, 2], rel=1e-12)
            assert energy[1] == pytest.approx(data[index].energy[1], rel=1e-9, abs=1e-12)
    after = env.simulation.data(1)
    assert looks.speed_mps()[1] == pytest.approx(np.linalg.norm(after.qvel[:3]))
    joints = [f"{side}_{joint}" for side in ("left", "right") for joint in ("sprawl", "fbem")]
    fastest = max(abs(np.degrees(after.joint(joint).qvel[0])) for joint in joints)
    assert looks.joint_speed_degps()[1] == pytest.approx(fastest)


@pytest.mark.parametrize(
    ("where", "seen"),
    [
        ({}, False),  # the start
        ({"x": 0.15, "z": 0.01}, True),  # base, 30 mm below the step's top
        ({"x": -0.05, "z": 0.055}, True),  # only front wheels, 42 mm ahead of the base's half
        ({"z": 0.02}, True),  # wheels in the floor
        ({"z": -0.2}, True),  # all of it under the floor
        ({"x": -0.9, "z": -0.2}, False),  # behind the floor, falling
        ({"y": 0.5, "z": -0.05}, False),  # beside it
    ],
)
def test_a_part_within_step_or_floor_or_under_it_has_tunnelled(where, seen):
    env, looks = watched()
    plant(env, **where)
    assert looks.tunnelled(np.array([STEP_MM])).tolist() == [seen]


def test_a_part_that_came_under_the_floor_round_its_edge_has_not_tunnelled():
    env, looks = watched()
    size_mm = np.array([STEP_MM])
    for where, seen in (
        ({"z": -0.2}, True),  # through it
        ({"x": -0.9, "z": 0.1}, False),
        ({"x": -0.9, "z": -0.2}, False),
        ({"x": -0.5, "z": -0.2}, False),  # round its rear edge
        ({"x": -0.5, "z": 0.1}, False),
        ({"x": -0.5, "z": -0.2}, True),  # through it again
    ):
        qpos = env.simulation.batch.bind("qpos")[0]
        for place, value in where.items():
            qpos["xyz".find(place)] = value
        env.simulation.advance(np.zeros((1, 3)), np.array([True]))  # no episode that could end
        assert looks.tunnelled(size_mm).tolist() == [seen], where


def test_a_wheel_within_a_wall_has_tunnelled_and_one_beside_it_has_not():
    env, looks = watched("narrow-channel")
    for y_m, seen in ((0.0, False), (0.03, True)):
        plant(env, x=0.15, y=y_m)
        # Sprawl 48°: wheels 99 mm from the mid-plane, walls from 100 mm on.
        assert looks.tunnelled(np.array([200.0])).tolist() == [seen]


@pytest.mark.parametrize("depth_mm", [0.5, 3.0])
def test_a_planted_penetration_is_seen_with_its_depth(depth_mm):
    env, looks = watched()
    height_m = env.simulation.batch.bind("qpos")[0, 2]
    data, _ = plant(env, z=height_m - depth_mm * 1e-3)
    floor_mm, block_mm = looks.penetration_mm(data)
    # Of the tyre's round edge, a polyhedron to MuJoCo's collisions of cylinder and box.
    assert floor_mm == pytest.approx(depth_mm, abs=0.1)
    assert block_mm == 0.0
    # 161 mm before the step's face at the start.
    data, _ = plant(
        env, z=height_m + 0.005, x=env.config.course.fixed_start_m + 0.161 + 1e-3 * depth_mm
    )
    floor_mm, block_mm = looks.penetration_mm(data)
    assert floor_mm == 0.0
    assert block_mm == pytest.approx(depth_mm, abs=0.1)


def test_parts_that_overlap_are_seen():
    env, looks = watched()
    data, _ = plant(env)
    assert looks.self_penetration_mm(data) == 0.0
    # Legs beyond straight down cross each other below the body.
    across = np.radians(-30.0)
    data, _ = plant(env, left_sprawl=across, right_sprawl=across)
    assert looks.self_penetration_mm(data) > 5.0
    # Straight up, the motor nubs meet by 0.46 mm by construction.
    up = np.radians(180.0)
    data, _ = plant(env, left_sprawl=up, right_sprawl=up)
    assert looks.self_penetration_mm(data) == pytest.approx(0.46, abs=0.05)
