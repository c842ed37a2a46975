"""Per-simulation friction, masses and servo gains, under one compiled model."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import mujoco
import numpy as np
from mujoco.batch import Batch

from surmount.core.arrays import FloatArray, IntArray
from surmount.rstar.course.randomisation import FACTORS


class Dynamics:
    """The model fields of a batch that differ between its simulations.

    MuJoCo keeps a value per simulation of each field named here and loads it, with the state,
    before it steps the simulation; constants that follow from the masses are computed anew.

    Parameters
    ----------
    batch
        Simulations whose fields become their own.
    """

    def __init__(self, batch: Batch) -> None:
        self._batch = batch
        model: mujoco.MjModel = batch.model
        root = int(model.body("base").id)
        self._bodies: IntArray = np.flatnonzero(model.body_rootid == root)
        self._geoms: IntArray = np.flatnonzero(model.body_rootid[model.geom_bodyid] == root)
        self._gain_of_servo: IntArray = np.array(
            [_gain(model.actuator(servo).name) for servo in range(model.nu)]
        )
        self._friction: FloatArray = model.geom_friction[self._geoms, 0].copy()
        self._mass: FloatArray = model.body_mass[self._bodies].copy()
        self._inertia: FloatArray = model.body_inertia[self._bodies].copy()
        self._driven: IntArray = model.jnt_dofadr[model.actuator_trnid[:, 0]]
        self._damping: FloatArray = model.dof_damping[self._driven].copy()
        self._gain: FloatArray = model.actuator_gainprm.copy()
        self._bias: FloatArray = model.actuator_biasprm.copy()
        self._frictions: FloatArray = batch.expand("geom_friction")
        self._masses: FloatArray = batch.expand("body_mass")
        self._inertias: FloatArray = batch.expand("body_inertia")
        self._dampings: FloatArray = batch.expand("dof_damping")
        self._gains: FloatArray = batch.expand("actuator_gainprm")
        self._biases: FloatArray = batch.expand("actuator_biasprm")

    def put(self, envs: list[int], factors: FloatArray) -> None:
        """Give simulations their factors.

        Parameters
        ----------
        envs
            Simulations, ascending.
        factors
            Shape ``(len(envs), factor)``, in the order of
            :data:`~surmount.rstar.course.randomisation.FACTORS`.
        """
        for env, row in zip(envs, factors, strict=True):
            friction, mass = row[0], row[1]
            self._frictions[env, self._geoms, 0] = self._friction * friction
            self._masses[env, self._bodies] = self._mass * mass
            self._inertias[env, self._bodies] = self._inertia * mass
            gain = row[self._gain_of_servo]
            self._dampings[env, self._driven] = self._damping * gain
            self._gains[env] = self._gain * gain[:, None]
            self._biases[env] = self._bias * gain[:, None]
        self._batch.set_const(envs)


def _gain(servo: str) -> int:
    """Return the index of the factor on a servo's gains."""
    kind = servo.rsplit("_", maxsplit=1)[-1]
    return FACTORS.index(f"{kind if kind in ('sprawl', 'fbem') else 'wheel'}_gain_factor")
