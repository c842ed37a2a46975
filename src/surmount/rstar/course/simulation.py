"""Many simulations of one course, stepped by MuJoCo in one multi-threaded call."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco
import numpy as np
from mujoco.batch import Batch, SimulationError

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.rstar.course.actions import ACTIONS
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.gauge import Gauge
from surmount.rstar.course.measures import Measures
from surmount.rstar.course.obstacles import Obstacle, block_positions, blocks
from surmount.rstar.course.scene import build_model
from surmount.rstar.course.start_poses import Start
from surmount.rstar.robot.parts import SIDES

DIVERGED_VELOCITY = 1e3
"""A generalised speed (m/s or rad/s) above this is a diverged simulation."""
_TOO_FAST: FloatArray = np.array(DIVERGED_VELOCITY)


class Simulation:
    """Simulations of one obstacle family, each with its own variant, state and commands.

    Parameters
    ----------
    obstacle, config
        Family and configuration; the model is compiled once for all variants.
    num_envs
        Number of simulations.
    n_threads
        Threads that share the simulations; results do not depend on it.

    Attributes
    ----------
    model
        The compiled model.
    batch
        MuJoCo's batch. Each row of ``batch.state`` is all there is to a simulation: time, joint
        positions and velocities, servo targets, warm start and the obstacle's position.
    """

    def __init__(
        self, obstacle: Obstacle, config: EnvConfig, num_envs: int, n_threads: int
    ) -> None:
        _keep_warnings_out_of_the_working_folder()
        self.model: mujoco.MjModel = build_model(obstacle, config)
        self.batch = Batch(self.model, num_envs, min(n_threads, num_envs))
        self._obstacle = obstacle
        self._config = config
        self._ticks = config.physics_steps_per_step
        self._qpos: FloatArray = self.batch.bind("qpos")
        self._qvel: FloatArray = self.batch.bind("qvel")
        self._act: FloatArray = self.batch.bind("act")
        self._ctrl: FloatArray = self.batch.bind("ctrl")
        self._mocap: FloatArray = self.batch.bind("mocap_pos")
        self._mocap_ids = [
            int(self.model.body(block.name).mocapid[0]) for block in blocks(obstacle, config.course)
        ]
        self._action_of_servo, self._rate_of_servo = self._servo_map()
        self._gauge = Gauge(self.batch, config)
        self._before: FloatArray = np.empty_like(self.batch.state)
        self._speeds: FloatArray = np.empty(self._qvel.shape)
        self._none: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self._none.flags.writeable = False

    def _position(self, joint: str) -> int:
        return int(self.model.joint(joint).qposadr[0])

    def _servo_map(self) -> tuple[IntArray, FloatArray]:
        """Return each servo's action and its rate at a full action."""
        actions: list[int] = []
        for index in range(self.model.nu):
            kind = self.model.actuator(index).name.split("_")[-1]
            actions.append(ACTIONS.index(kind) if kind in ACTIONS else ACTIONS.index("speed"))
        return np.array(actions), self.model.actuator_ctrlrange[:, 1].copy()

    def advance(self, actions: FloatArray, running: BoolArray | None = None) -> BoolArray:
        """Hold actions for one step.

        Parameters
        ----------
        actions
            Fractions of the rate limits in [−1, 1], shape ``(env, 3)``, ordered as
            :data:`~surmount.rstar.course.actions.ACTIONS`. Every servo integrates its rate at each
            physics step.
        running
            Simulations to advance, shape ``(env,)``, or None for all; the others keep their state,
            at no cost.

        Returns
        -------
        BoolArray
            Simulations that diverged, shape ``(env,)``: MuJoCo gave up on them, or their state is
            not finite, or faster than :data:`DIVERGED_VELOCITY`. They are put back to where they
            were before.
        """
        state = self.batch.state
        np.copyto(self._before, state)
        np.multiply(actions.take(self._action_of_servo, axis=1), self._rate_of_servo, self._ctrl)
        failed = self._none
        try:
            self.batch.step(running, self._ticks)
        except SimulationError as error:
            failed = self._none.copy()
            failed[error.ids] = True
        # NaN fails the comparison; looking at all simulations at once is the cheap common case.
        # Positions are integrated from velocities: they cannot be the first to be not finite.
        np.abs(self._qvel, out=self._speeds)
        if np.count_nonzero(self._speeds < _TOO_FAST) < self._speeds.size:
            failed = failed | ~(self._speeds.max(axis=1) < DIVERGED_VELOCITY)
        if failed is not self._none:
            if running is not None:
                failed &= running
            state[failed] = self._before[failed]
        return failed

    def measure(self) -> Measures:
        """Return what the robots measure."""
        return self._gauge.read()

    def place(self, env: int, size_mm: float, start: Start) -> None:
        """Put simulation ``env`` at rest into a start pose, before an obstacle of a size."""
        self.batch.reset([env], stage=mujoco.mjtStage.mjSTAGE_NONE.value)
        qpos, act = self._qpos[env], self._act[env]
        half_yaw = math.radians(start.yaw_deg) / 2
        qpos[:7] = (
            *(start.x_m, start.y_m, start.z_m),
            *(math.cos(half_yaw), 0.0, 0.0, math.sin(half_yaw)),
        )
        sprawl, fbem = math.radians(start.sprawl_deg), math.radians(start.fbem_deg)
        for side in SIDES:
            qpos[self._position(f"{side}_sprawl")] = sprawl
            qpos[self._position(f"{side}_fbem")] = fbem
            qpos[self._position(f"{side}_rear_rod")] = fbem
            qpos[self._position(f"{side}_carrier")] = -fbem
        for servo, action in enumerate(self._action_of_servo.tolist()):
            act[servo] = (0.0, fbem, sprawl)[action]
        positions = block_positions(self._obstacle, self._config.course, np.array([size_mm]))
        for block, mocap in enumerate(self._mocap_ids):
            self._mocap[env, mocap] = positions[0, block]

    def data(self, env: int, data: mujoco.MjData | None = None) -> mujoco.MjData:
        """Return simulation ``env`` with all derived quantities computed, to render or examine."""
        data = self.batch.get_data(env, data)
        mujoco.mj_forward(self.batch.get_model(env), data)
        return data


def _keep_warnings_out_of_the_working_folder() -> None:
    """Let MuJoCo say warnings on the console only.

    By default it also appends them to a file in the working folder, where nothing of ours belongs;
    a diverged simulation is counted and reported as part of the result.
    """
    log = mujoco.MjLogConfig.get()
    log.logto_file = False
    log.set()
