"""The engine's contacts are what the geometry says (ADR 22)."""

import mujoco
import numpy as np
import pytest

from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.course.scene import build_model
from surmount.rstar.robot.config import RobotConfig


def test_the_contact_of_a_tyre_in_an_edge_has_the_depth_of_the_overlap():
    # Between two convex bodies the depth is the shortest way out, hence no longer than the way out
    # along any direction: oracle by support functions, over random poses at a block's upper edge.
    config = EnvConfig()
    model = build_model(OBSTACLES["step"], config)
    tyre, block = model.geom("left_front_tyre"), model.geom("step_block")
    spec = mujoco.MjSpec()
    spec.option.disableflags = model.opt.disableflags
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=block.size)
    body = spec.worldbody.add_body(pos=[0, 0, 0.2])
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=tyre.size, mass=0.1)
    pair = spec.compile()
    data = mujoco.MjData(pair)
    rng = np.random.default_rng(0)
    edge = np.array([-block.size[0], 0.0, block.size[2]])
    radius, half_width = tyre.size[:2]
    turns = np.linspace(0, np.pi / 2, 91)
    fan = np.stack([-np.cos(turns), np.zeros(91), np.sin(turns)], axis=1)
    overlaps = 0
    for _ in range(2000):
        data.qpos[:3] = edge + rng.uniform(-0.02, 0.02, 3)
        data.qpos[3:] = rng.standard_normal(4)
        mujoco.mj_kinematics(pair, data)
        mujoco.mj_collision(pair, data)
        axis = data.geom_xmat[1].reshape(3, 3)[:, 2]
        along = np.abs(fan @ axis)
        reach = radius * np.sqrt(1 - along**2) + half_width * along
        ways_out = np.abs(fan) @ block.size - (fan @ data.geom_xpos[1] - reach)
        if ways_out.min() > 0.0005:
            overlaps += 1
            depth = -data.contact.dist.min()
            # MuJoCo rounds the cylinder by a polyhedron, and tries other directions, too.
            assert 0.3 * ways_out.min() < depth < 1.1 * ways_out.min() + 0.0005
    assert overlaps > 1500


@pytest.mark.parametrize("tick_s", [0.00125, 0.000625])
def test_contacts_are_as_stiff_at_a_shorter_tick(tick_s):
    # Four weights of the robot on the floor: a property of the robot, not of the integration.
    depths_mm = []
    for physics_step_s in (RobotConfig().physics_step_s, tick_s):
        config = EnvConfig(robot=RobotConfig(physics_step_s=physics_step_s))
        model = build_model(OBSTACLES["step"], config)
        data = mujoco.MjData(model)
        data.qpos[:3] = [-0.3, 0, 0.1]
        data.xfrc_applied[model.body("base").id, 2] = -3 * 9.81 * model.body_mass.sum()
        for _ in range(round(3.0 / physics_step_s)):
            mujoco.mj_step(model, data)
        assert data.ncon > 0
        assert np.abs(data.qvel).max() < 0.01
        depths_mm.append(-data.contact.dist.min() * 1e3)
    assert depths_mm[0] > 0.005
    assert depths_mm[1] == pytest.approx(depths_mm[0], rel=0.02)
