"""What a simulation must never do, and how far it went towards it.

Cheap looks take all simulations at once from what the batch copies out of every step, which
describes the state one physics step before its end (and nothing after a reset); close looks take
one simulation with all derived quantities computed.
"""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import itertools

import mujoco
import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import Obstacle, block_positions, blocks
from surmount.rstar.course.scene import FLOOR_THICKNESS_M
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.robot.parts import ROBOT_BIT, SIDES
from surmount.rstar.robot.running_gear import wheel_names

UNDER_FLOOR_INSET_M = 0.04
"""How far from its edges the floor counts as above a part: between two looks a part may pass the
edge."""


class Soundness:
    """Looks at simulations of one course.

    Parameters
    ----------
    obstacle, config
        Family and configuration of the simulation.
    simulation
        What to look at; its energies are worked out from the next step on, which changes nothing
        else about it.
    """

    def __init__(self, obstacle: Obstacle, config: EnvConfig, simulation: Simulation) -> None:
        self._obstacle, self._config, self._simulation = obstacle, config, simulation
        model, batch = simulation.model, simulation.batch
        names = ["base", *(f"{side}_carrier" for side in SIDES), *wheel_names(config.robot)]
        self._centres: IntArray = np.array([model.body(name).id for name in names])
        self._robot: IntArray = np.flatnonzero(model.body_rootid == model.body("base").id)
        joints = [f"{side}_{joint}" for side in SIDES for joint in ("sprawl", "fbem")]
        self._joints: IntArray = np.array([int(model.joint(name).dofadr[0]) for name in joints])
        self._half_size_m: FloatArray = np.array(
            [block.half_size_m for block in blocks(obstacle, config.course)]
        )
        envs = self._simulation.batch.state.shape[0]
        self._round_edge: BoolArray = np.zeros((envs, self._centres.size), dtype=np.bool_)
        self._is_floor: BoolArray = np.arange(model.ngeom) == model.geom("floor").id
        self._pairs = _pairs_of_parts(model)
        self._qvel: FloatArray = batch.bind("qvel")
        self._centres_m: FloatArray = batch.bind("xipos")
        self._energy_j: FloatArray = batch.bind("energy")
        batch.expand("opt.enableflags")[:] |= mujoco.mjtEnableBit.mjENBL_ENERGY.value

    # Cheap looks at all simulations ------------------------------------------------------------

    def tunnelled(self, size_mm: FloatArray) -> BoolArray:
        """Return whether a part is where it must not be.

        The centre of mass of base, carriers and wheels must not be inside an obstacle's block,
        inside the floor, or under the floor, unless it came there round an edge: legs of a robot
        that lies across an edge swing under it. To know, this must be asked after every step.

        Parameters
        ----------
        size_mm
            Size of each simulation's obstacle, shape ``(env,)``.

        Returns
        -------
        BoolArray
            Shape ``(env,)``.
        """
        course = self._config.course
        points = self._centres_m[:, self._centres]
        centre = block_positions(self._obstacle, course, size_mm)
        offset = np.abs(points[:, :, None] - centre[:, None])
        in_block = (offset < self._half_size_m).all(axis=-1).any(axis=-1).any(axis=-1)
        x, y, z = np.moveaxis(points, -1, 0)
        edge_m = np.minimum(course.floor_half_width_m - np.abs(y), course.floor_front_m - x)
        edge_m = np.minimum(edge_m, x + course.floor_rear_m)
        in_floor = (z < 0) & (z > -FLOOR_THICKNESS_M) & (edge_m > 0)
        self._round_edge = np.where(edge_m <= 0, True, self._round_edge & (z <= 0))
        under_floor = (z <= -FLOOR_THICKNESS_M) & (edge_m > UNDER_FLOOR_INSET_M)
        under_floor &= ~self._round_edge
        return in_block | (in_floor | under_floor).any(axis=1)

    def energy_j(self) -> FloatArray:
        """Return the robot's potential (from the floor) and kinetic energy, shape ``(env, 2)``."""
        batch, model = self._simulation.batch, self._simulation.model
        own: FloatArray | None = batch.expanded("body_mass")
        mass_kg = (model.body_mass if own is None else own)[..., self._robot]
        height_m = self._centres_m[:, self._robot, 2]
        # MuJoCo's potential energy counts the obstacle's blocks, too.
        potential_j = -model.opt.gravity[2] * (mass_kg * height_m).sum(axis=1)
        return np.column_stack([potential_j, self._energy_j[:, 1]])

    def speed_mps(self) -> FloatArray:
        """Return the speed of the base in m/s, shape ``(env,)``."""
        velocity = self._qvel[:, :3]
        return np.sqrt((velocity * velocity).sum(axis=1))

    def joint_speed_degps(self) -> FloatArray:
        """Return the speed of the fastest sprawl or FBEM joint in degrees/s, shape ``(env,)``."""
        speeds: FloatArray = np.abs(self._qvel[:, self._joints]).max(axis=1)
        return np.degrees(speeds)

    # Close looks at one simulation -------------------------------------------------------------

    def penetration_mm(self, data: mujoco.MjData) -> tuple[float, float]:
        """Return how deep the robot is in the floor, and in the obstacle and its posts, in mm."""
        contact = data.contact
        depth_mm = np.maximum(-contact.dist, 0.0) * 1e3
        floor = self._is_floor[contact.geom].any(axis=1)
        return float(depth_mm[floor].max(initial=0.0)), float(depth_mm[~floor].max(initial=0.0))

    def self_penetration_mm(self, data: mujoco.MjData) -> float:
        """Return how deep solid parts of the robot that move against each other overlap, in mm.

        The robot's parts do not touch one another in the simulation, because they cannot where
        its joints are as they should be.
        """
        model = self._simulation.model
        nearest = min(
            mujoco.mj_geomDistance(model, data, *pair, 0.001, None) for pair in self._pairs
        )
        return max(-nearest, 0.0) * 1e3


def _pairs_of_parts(model: mujoco.MjModel) -> list[tuple[int, int]]:
    """Return pairs of solid geoms: the body with each side's, and the left side's with the right's.

    A side's own solids turn with or about its carrier and keep their distances.
    """
    solid = np.flatnonzero(model.geom_contype == ROBOT_BIT).tolist()
    body = model.geom("body").id
    sides = [[geom for geom in solid if model.geom(geom).name.startswith(side)] for side in SIDES]
    left, right = sides
    return [*((body, geom) for geom in left + right), *itertools.product(left, right)]
