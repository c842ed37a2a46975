"""How what is measured is read off the simulations' state."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco
import numpy as np
from mujoco.batch import Batch

from surmount.core.arrays import FloatArray, IntArray
from surmount.rstar.course.measures import MEASURES, Measures
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
        The robot.
    """

    def __init__(self, batch: Batch, config: RobotConfig) -> None:
        columns, num_envs = _columns(batch, config), batch.nsim
        self._state: FloatArray = batch.state.reshape(-1)
        self._where: IntArray = columns[:, None] + batch.nstate * np.arange(num_envs)
        self._table: FloatArray = np.empty((len(columns), num_envs))
        measures, rest = np.split(self._table, [len(MEASURES)])
        self._rows = measures
        self._attitude, self._joints, self._rim = measures[:2], measures[2:4], measures[4]
        self._first, self._second = rest[:8], rest[8:16]
        self._other_side, self._wheels = rest[16:18], rest[18:]
        self._products: FloatArray = np.empty((8, num_envs))
        self._xy_zx, self._xx_xx, self._wz_wy, self._zz_yy = self._products.reshape(4, 2, num_envs)
        self._sines: FloatArray = np.empty((2, num_envs))
        self._cosines: FloatArray = np.empty((2, num_envs))
        # Yaw (whose sine is that of −yaw), pitch, means of two joint angles, mean rim speed.
        rim_m = rolling_radius_m(config) / len(wheel_names(config))
        units = np.array([-_DEGREES, _DEGREES, 0.5 * _DEGREES, 0.5 * _DEGREES, rim_m])
        self._scaled, self._units = measures[:5], np.repeat(units[:, None], num_envs, axis=1)

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
        np.add(self._joints, self._other_side, self._joints)
        np.add.reduce(self._wheels, axis=0, out=self._rim)
        np.multiply(self._scaled, self._units, self._scaled)
        return Measures(rows=self._rows.copy())


def _columns(batch: Batch, config: RobotConfig) -> IntArray:
    """Return the column of the state that each row of the gauge's table takes."""
    model: mujoco.MjModel = batch.model

    def first(name: str) -> int:
        return (batch.bind(name).ctypes.data - batch.state.ctypes.data) // batch.state.itemsize

    qpos, qvel = first("qpos"), first("qvel")
    w, x, y, z = range(qpos + 3, qpos + 7)
    left, right = (
        [qpos + int(model.joint(f"{side}_{joint}").qposadr[0]) for joint in ("fbem", "sprawl")]
        for side in SIDES
    )
    wheels = [qvel + int(model.joint(name).dofadr[0]) for name in wheel_names(config)]
    # Attitude and speed are worked out later: their rows take anything.
    measures = [qpos, qpos, *left, qpos, qpos, qpos + 1, qpos + 2]
    factors = [x, x, x, x, w, w, z, y, y, z, x, x, z, y, z, y]
    return np.array([*measures, *factors, *right, *wheels])
