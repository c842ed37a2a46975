"""Motions: where the robot was at every moment of an episode, to be looked at afterwards."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
from gymnasium.vector import AutoresetMode

from surmount.core.arrays import FloatArray
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.infos import Infos
from surmount.rstar.course.observations import Observations
from surmount.rstar.course.obstacles import Obstacle
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.start_poses import fixed_start

Pilot = Callable[[Observations, FloatArray], FloatArray]
"""Decides: observations of shape ``(1, term)`` and the base's position along the course in m, of
shape ``(1,)``, to actions of shape ``(1, 3)``."""


def stand_still(observations: Observations, x_m: FloatArray) -> FloatArray:
    """Leave all targets as they are: a pilot."""
    del observations, x_m
    return np.zeros((1, 3))


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """An episode from the fixed start.

    Attributes
    ----------
    obstacle, config
        Family and configuration.
    size_mm
        Size of the obstacle in mm.
    caption
        What was moving the robot.
    outcome
        How it ended.
    success
        Whether the base passed the target line.
    time_s
        Times in s, ascending from 0, shape ``(moment,)``.
    qpos
        Joint positions at these times, shape ``(moment, coordinate)``.
    features
        Features at every step, as logged by roll-outs, shape ``(step, feature)``.
    """

    obstacle: Obstacle
    config: EnvConfig
    size_mm: float
    caption: str
    outcome: str
    success: bool
    time_s: FloatArray
    qpos: FloatArray
    features: FloatArray

    @property
    def duration_s(self) -> float:
        """Time from start to end, in s."""
        return float(self.time_s[-1])


def record_motion(
    obstacle: Obstacle,
    config: EnvConfig,
    size_mm: float,
    pilot: Pilot,
    *,
    caption: str,
    seed: int = 0,
    stream: int = 0,
    longest_s: float = float("inf"),
) -> Motion:
    """Simulate an episode from the fixed start and keep its motion, at every physics step.

    Parameters
    ----------
    obstacle, config
        Family and configuration.
    size_mm
        Size of the obstacle in mm.
    pilot
        Decides.
    caption
        What the pilot is, in words.
    seed, stream
        Where the configuration randomises, draw as environment ``stream`` of a vector environment
        with this seed.
    longest_s
        Time in s after which to stop, if the episode has not ended.

    Raises
    ------
    InputError
        If the size is not admissible.
    """
    env = ObstacleVectorEnv(obstacle.name, 1, config=config, autoreset_mode=AutoresetMode.DISABLED)
    simulation = env.simulation
    controls: FloatArray = simulation.batch.bind("ctrl")
    child = np.random.SeedSequence(seed, spawn_key=(stream,))
    env.generator(0).bit_generator.state = np.random.PCG64(child).state
    observations, infos = env.reset(options={"variant": size_mm, "start": "fixed"})
    model = simulation.batch.get_model(0)
    data = simulation.batch.get_data(0)
    qpos: list[FloatArray] = [data.qpos.copy()]
    features: list[FloatArray] = [infos["features"][0].copy()]
    ended = False
    while not ended and features[-1][0] < longest_s - 1e-9:
        data = simulation.batch.get_data(0, data)
        actions = pilot(observations, simulation.measure().x_m)
        observations, _, terminated, truncated, infos = env.step(actions)
        features.append(infos["features"][0].copy())
        ended = bool(terminated[0] | truncated[0])
        if infos["diverged"][0]:
            break  # put back to where it was
        # The batch shows no physics steps within a step: repeat them, to the same bits (tested).
        data.ctrl[:] = controls[0]
        for _ in range(config.physics_steps_per_step):
            mujoco.mj_step(model, data)
            qpos.append(data.qpos.copy())
    env.close()
    return Motion(
        obstacle=obstacle,
        config=config,
        size_mm=size_mm,
        caption=caption,
        outcome=_outcome(infos, ended=ended, time_s=float(features[-1][0])),
        success=bool(infos["is_success"][0]),
        time_s=np.arange(len(qpos), dtype=np.float64) * config.robot.physics_step_s,
        qpos=np.array(qpos),
        features=np.array(features),
    )


def _outcome(infos: Infos, *, ended: bool, time_s: float) -> str:
    if infos["is_success"][0]:
        return f"reached the target after {time_s:.2f} s"
    if infos["diverged"][0]:
        return f"the simulation diverged after {time_s:.2f} s"
    if not ended:
        return f"shown for {time_s:.2f} s"
    return f"had not reached the target after {time_s:.2f} s"


class Puppet:
    """A robot that is put where a motion says: nothing is simulated.

    Attributes
    ----------
    model
        The compiled model.
    """

    def __init__(self, motion: Motion) -> None:
        self._simulation = Simulation(motion.obstacle, motion.config, 1, 1)
        self._data: mujoco.MjData = self._simulation.data(0)
        self.model: mujoco.MjModel = self._simulation.model
        self.follow(motion)

    def follow(self, motion: Motion) -> None:
        """Take up another motion on the same course, before an obstacle of its size."""
        self._motion = motion
        self._simulation.place(0, motion.size_mm, fixed_start(motion.config))
        self._data = self._simulation.data(0, self._data)

    def at(self, time_s: float) -> mujoco.MjData:
        """Return the robot as it was at a time in s; the same object every time."""
        moment = int(np.searchsorted(self._motion.time_s, time_s + 1e-9, side="right")) - 1
        self._data.qpos[:] = self._motion.qpos[max(moment, 0)]
        self._data.time = time_s
        mujoco.mj_kinematics(self.model, self._data)
        mujoco.mj_comPos(self.model, self._data)
        mujoco.mj_camlight(self.model, self._data)
        return self._data
