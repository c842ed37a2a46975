"""How what is measured is read off the simulations' state."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco
import numpy as np
from mujoco.batch import Batch

from surmount.core.arrays import FloatArray, IntArray
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.measures import MEASURES, Measures
from surmount.rstar.robot import constants as c
from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.parts import SIDES
from surmount.rstar.robot.running_gear import rolling_radius_m, wheel_names

_DEGREES = 180.0 / math.pi
_HALF: FloatArray = np.array(0.5)


class Gauge:
    """Reads all measures of all simulations at once.

    One ``take`` gathers all coordinates, one row each, into a table whose first rows become the
    measures. Its parts are named once, since cutting an array costs half as much as adding two
    (ADR 41), and they are contiguous, which keeps the arithmetic independent of the number of
    simulations.

    Parameters
    ----------
    batch
        Simulations.
    config
        The robot, and what is asked of it beside the measures: the servos' targets, the carriers'
        position.
    """

    def __init__(self, batch: Batch, config: EnvConfig) -> None:
        robot, num_envs = config.robot, batch.nsim
        targets = _target_columns(batch, robot) if config.observe_targets else []
        columns = _columns(batch, robot, targets)
        self._state: FloatArray = batch.state.reshape(-1)
        self._where: IntArray = columns[:, None] + batch.nstate * np.arange(num_envs)
        self._table: FloatArray = np.empty((len(columns), num_envs))
        measures, rest = np.split(self._table, [len(MEASURES) + len(targets)])
        self._rows = measures
        self._attitude, self._joints, self._rim = measures[:2], measures[2:4], measures[4]
        self._first, self._second = rest[:8], rest[8:16]
        self._other_side, self._wheels = rest[16:18], rest[18:]
        self._products: FloatArray = np.empty((8, num_envs))
        self._xy_zx, self._xx_xx, self._wz_wy, self._zz_yy = self._products.reshape(4, 2, num_envs)
        self._sines: FloatArray = np.empty((2, num_envs))
        self._cosines: FloatArray = np.empty((2, num_envs))
        # Yaw (whose sine is that of −yaw), pitch, means of two joint angles, mean rim speed.
        rim_m = rolling_radius_m(robot) / len(wheel_names(robot))
        units = np.array([-_DEGREES, _DEGREES, 0.5 * _DEGREES, 0.5 * _DEGREES, rim_m])
        self._scaled, self._units = measures[:5], np.repeat(units[:, None], num_envs, axis=1)
        self._targets = measures[len(MEASURES) :]
        units = np.array([rolling_radius_m(robot), _DEGREES, _DEGREES])[: len(targets)]
        self._target_units = np.repeat(units[:, None], num_envs, axis=1)
        self._finds_carriers = config.reward.distance_point == "carriers"

    def read(self) -> Measures:
        """Return what the robots measure."""
        self._state.take(self._where, out=self._table, mode="clip")
        np.multiply(self._first, self._second, self._products)
        # Entries of the rotation matrix, halved: horizontal part of the lateral axis (xy − wz,
        # ½ − xx − zz), and heights of the forward and upward axes (xz − wy, ½ − xx − yy).
        np.subtract(self._xy_zx, self._wz_wy, self._sines)
        np.add(self._xx_xx, self._zz_yy, self._cosines)
        np.subtract(_HALF, self._cosines, self._cosines)
        np.arctan2(self._sines, self._cosines, self._attitude)
        carrier_x_m = self._carrier_x_m() if self._finds_carriers else None
        np.add(self._joints, self._other_side, self._joints)
        np.add.reduce(self._wheels, axis=0, out=self._rim)
        np.multiply(self._scaled, self._units, self._scaled)
        if self._targets.size:
            np.multiply(self._targets, self._target_units, self._targets)
        return Measures(rows=self._rows.copy(), carrier_x_m=carrier_x_m)

    def _carrier_x_m(self) -> FloatArray:
        """Return the mean of both sides' mid-wheelbase along the course, shape ``(env,)``.

        Exact for legs whose carriers are parallel to the body. Reads each side's angles, so it
        must come before they are averaged.
        """
        # FBEM and sprawl of the left and of the right side, in rad.
        angles = np.stack([self._joints, self._other_side])
        (fbem_sine, sprawl_sine), (fbem_cosine, sprawl_cosine) = (
            np.moveaxis(function(angles), 1, 0) for function in (np.sin, np.cos)
        )
        leg_m = 1e-3 * (c.PIVOT_OFFSET_MM + c.AXLE_OFFSET_MM + c.ROD_LENGTH_MM * fbem_cosine)
        ahead_m = -1e-3 * c.ROD_LENGTH_MM * (fbem_sine[0] + fbem_sine[1]) / 2
        outward_m = leg_m * sprawl_sine
        left_m = (outward_m[0] - outward_m[1]) / 2
        downward_m = leg_m * sprawl_cosine
        up_m = -(downward_m[0] + downward_m[1]) / 2
        # Components along the course of the base's axes: forward, left (the sine of −yaw), up.
        forward = 1.0 - 2.0 * (self._zz_yy[0] + self._zz_yy[1])
        left, up = 2.0 * self._sines[0], 2.0 * (self._xy_zx[1] + self._wz_wy[1])
        base_x_m = self._rows[MEASURES.index("x_m")]
        return base_x_m + forward * ahead_m + left * left_m + up * up_m


def _first_column(batch: Batch, name: str) -> int:
    """Return the column of the state in which a field of it begins."""
    return (batch.bind(name).ctypes.data - batch.state.ctypes.data) // batch.state.itemsize


def _target_columns(batch: Batch, config: RobotConfig) -> list[int]:
    """Return the columns of the servos' targets, in the order of ``TARGETS``.

    Servos that are fed alike have equal targets: one stands for all of them.
    """
    servos = (
        wheel_names(config)[0],
        *(f"{next(iter(SIDES))}_{kind}" for kind in ("fbem", "sprawl")),
    )
    act = _first_column(batch, "act")
    return [act + int(batch.model.actuator(servo).actadr[0]) for servo in servos]


def _columns(batch: Batch, config: RobotConfig, targets: list[int]) -> IntArray:
    """Return the column of the state that each row of the gauge's table takes."""
    model: mujoco.MjModel = batch.model
    qpos, qvel = _first_column(batch, "qpos"), _first_column(batch, "qvel")
    w, x, y, z = range(qpos + 3, qpos + 7)
    left, right = (
        [qpos + int(model.joint(f"{side}_{joint}").qposadr[0]) for joint in ("fbem", "sprawl")]
        for side in SIDES
    )
    wheels = [qvel + int(model.joint(name).dofadr[0]) for name in wheel_names(config)]
    # Attitude and speed are worked out later: their rows take anything.
    measures = [qpos, qpos, *left, qpos, qpos, qpos + 1, qpos + 2]
    factors = [x, x, x, x, w, w, z, y, y, z, x, x, z, y, z, y]
    return np.array([*measures, *targets, *factors, *right, *wheels])
