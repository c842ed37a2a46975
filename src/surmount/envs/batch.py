"""The obstacle courses as a Gymnasium vector environment: the one implementation of them all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import ConfigError, InputError
from surmount.core.tasks import TaskDistribution
from surmount.envs import rewards
from surmount.envs.config import EnvConfig
from surmount.envs.infos import Infos, final_infos
from surmount.envs.observations import (
    FEATURE_NAMES,
    Measures,
    Observations,
    features,
    observation_terms,
    observe,
)
from surmount.envs.obstacles import find_obstacle
from surmount.envs.options import read_options
from surmount.envs.rendering import FrameRenderer, Window
from surmount.envs.simulation import ACTIONS, Simulation
from surmount.envs.starts import fixed_start, random_start

STATE_SCHEMA = 1
"""Version of :meth:`ObstacleVectorEnv.state_dict`."""

RENDER_MODES = ("rgb_array", "human")


class ObstacleVectorEnv(VectorEnv[Observations, npt.NDArray[Any], npt.NDArray[Any]]):
    """RSTAR before narrow channels, low entrances or steps, any number of them at once.

    Observation, ``float32``, each entry ``(value − centre) / scale`` clipped to ± bound:

    ===== ==================== ==== ======== ========= ===== ===================================
    index entry                unit centre   scale     bound meaning
    ===== ==================== ==== ======== ========= ===== ===================================
    0     yaw                  deg  0        90        2     heading, left positive
    (1)   pitch                deg  0        90        2     nose up positive; step only
    1 (2) FBEM angle           deg  0        72        2     measured; positive: body forward
    2 (3) sprawl angle         deg  90       90        2     measured; 0 legs down, 90 flat
    3 (4) tangential speed     m/s  0        0.25      2     mean rim speed of the wheels
    4 (5) distance to obstacle m    0        0.3       4     front face − base, signed
    5 (6) size                 mm   mid-range half-range 2   width or height of the obstacle
    ===== ==================== ==== ======== ========= ===== ===================================

    Action, in [−1, 1], clipped: rates of the three targets as fractions of the limits, held for a
    decision interval and integrated at every physics tick; targets stay within their ranges.

    ===== ============ ============ =================
    index target       full action  range
    ===== ============ ============ =================
    0     speed        1 m/s²       ± 0.25 m/s
    1     FBEM angle   80 deg/s     ± 72 deg
    2     sprawl angle 80 deg/s     0 to 180 deg
    ===== ============ ============ =================

    Reward: eq. 6, see :mod:`surmount.envs.rewards`. An episode ends when the base passes the
    target line (success), falls off the floor or diverges (terminated), or at the cap (truncated).

    ``infos`` of every reset and step hold, with Gymnasium's ``_key`` masks: ``features`` of shape
    ``(env, feature)``, ``variant`` of shape ``(env, parameter)``, ``is_success`` and ``diverged``
    of shape ``(env,)``. Under same-step autoreset, ``final_obs`` and ``final_info`` hold the last
    values of the episodes that ended.

    Parameters
    ----------
    obstacle
        ``"narrow-channel"``, ``"low-entrance"`` or ``"step"``.
    num_envs
        Number of environments.
    config
        Configuration; the defaults if None.
    n_threads
        Threads that share the physics; results do not depend on it.
    autoreset_mode
        When an episode that ended begins anew. With ``DISABLED`` it stays frozen, unsimulated,
        with reward 0 and its ending's flags, until it is reset.
    render_mode
        ``"rgb_array"``, ``"human"`` (the first environment, in a window) or None.

    Raises
    ------
    ConfigError
        If an argument is out of range.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012  (as Gymnasium declares it)
        "render_modes": list(RENDER_MODES),
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        obstacle: str,
        num_envs: int,
        *,
        config: EnvConfig | None = None,
        n_threads: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
    ) -> None:
        for name, value in (("num_envs", num_envs), ("n_threads", n_threads)):
            if value < 1:
                raise ConfigError(f"`{name}` is {value}.", remedy="Give 1 or more.")
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise ConfigError(
                f"`render_mode` is {render_mode!r}.",
                remedy=f"Choose among {', '.join(RENDER_MODES)}, or None.",
            )
        self.config = config or EnvConfig()
        self.obstacle = find_obstacle(obstacle)
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {
            **type(self).metadata,
            "render_fps": round(1 / self.config.decision_interval_s),
            "autoreset_mode": self.autoreset_mode,
        }
        self.task_parameters: tuple[str, ...] = (self.obstacle.parameter,)
        self.feature_names: tuple[str, ...] = FEATURE_NAMES
        self._terms = observation_terms(self.obstacle)
        bounds = np.array([term.bound for term in self._terms], dtype=np.float32)
        self.single_observation_space = Box(-bounds, bounds, dtype=np.float32)
        self.single_action_space = Box(-1.0, 1.0, shape=(len(ACTIONS),), dtype=np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

        self.simulation = Simulation(self.obstacle, self.config, num_envs, n_threads)
        self._distribution = TaskDistribution.uniform(
            self.task_parameters,
            np.array([self.obstacle.lower]),
            np.array([self.obstacle.upper]),
        )
        self._generators: list[np.random.Generator] = _spawn(np.random.SeedSequence(), num_envs)
        self._fixed_start = fixed_start(self.config)
        self._steps: IntArray = np.zeros(num_envs, dtype=np.int64)
        self._variant: FloatArray = np.zeros((num_envs, 1))
        self._terminated: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self._truncated: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self._success: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self._diverged: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self._measures: Measures | None = None
        self._frames = FrameRenderer(self.simulation.model)
        self._window: Window | None = None
        self._window_data: Any = None

    # Tasks ------------------------------------------------------------------------------------

    @property
    def task_distribution(self) -> TaskDistribution:
        """The distribution from which the next episodes' variants are drawn."""
        return self._distribution

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw variants from ``distribution`` from the next reset of each environment on.

        Parameters
        ----------
        distribution
            Over the environment's ``task_parameters``, in mm.

        Raises
        ------
        InputError
            If the parameters differ or the bounds leave the admissible sizes.
        """
        if distribution.parameters != self.task_parameters:
            raise InputError(
                f"The task distribution is over {distribution.parameters}, the environment's "
                f"parameters are {self.task_parameters}.",
                remedy="Push a distribution made for this obstacle.",
            )
        self.obstacle.check_sizes(np.concatenate([distribution.lower, distribution.upper]))
        self._distribution = distribution

    # Episodes ---------------------------------------------------------------------------------

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> tuple[Observations, Infos]:
        """Begin episodes.

        Parameters
        ----------
        seed
            An integer seeds environment ``i`` with the ``i``-th child of its seed sequence,
            whatever ``num_envs``; a sequence gives each environment the seed that a single
            environment would take; None goes on with the present streams.
        options
            ``"variant"``: size in mm, one for all, or of shape ``(env,)`` or ``(env, parameter)``,
            instead of a draw. ``"start"``: ``"random"`` (default) as in training, or ``"fixed"``
            as in roll-outs. ``"reset_mask"``: which environments to reset, shape ``(env,)``.

        Raises
        ------
        InputError
            If an option is unknown or does not fit.
        """
        chosen = read_options(options, self.obstacle, self.num_envs)
        self._seed(seed)
        mask = chosen.mask | (self._measures is None)
        self._begin(np.flatnonzero(mask), chosen.variant, fixed=chosen.fixed)
        return self._observation(), self._infos()

    def _seed(self, seed: int | Sequence[int | None] | None) -> None:
        if seed is None:
            return
        if isinstance(seed, Sequence):
            if len(seed) != self.num_envs:
                raise InputError(
                    f"{len(seed)} seeds were given for {self.num_envs} environments.",
                    remedy="Give one seed per environment, or a single integer.",
                )
            for env, value in enumerate(seed):
                if value is not None:
                    self._generators[env] = _spawn(np.random.SeedSequence(value), 1)[0]
            return
        super().reset(seed=int(seed))
        self._generators = _spawn(np.random.SeedSequence(int(seed)), self.num_envs)

    def _begin(self, envs: IntArray, variant: FloatArray | None, *, fixed: bool) -> None:
        """Begin an episode in each of ``envs``, drawing what is not given."""
        for env in envs.tolist():
            rng = self._generators[env]
            task = self._distribution.sample(rng, 1)[0] if variant is None else variant[env]
            size = float(task[0])
            start = (
                self._fixed_start if fixed else random_start(self.obstacle, self.config, size, rng)
            )
            self._variant[env] = task
            self.simulation.place(env, size, start)
        self._steps[envs] = 0
        for flags in (self._terminated, self._truncated, self._success, self._diverged):
            flags[envs] = False
        self._measures = self.simulation.measure()

    def step(
        self, actions: npt.ArrayLike
    ) -> tuple[Observations, FloatArray, BoolArray, BoolArray, Infos]:
        """Hold ``actions`` of shape ``(env, 3)`` for a decision interval in every environment."""
        if self._measures is None:
            raise InputError("The environment has not been reset.", remedy="Call reset() first.")
        before, done = self._measures, self._terminated | self._truncated
        running = ~done
        diverged = self.simulation.advance(self._checked(actions), running)
        self._diverged |= diverged
        now = self._measures = self.simulation.measure()
        self._steps += running
        self._judge(now, running)
        reward = np.where(running, self._reward(before, now, running), 0.0)
        terminated, truncated = self._terminated.copy(), self._truncated.copy()
        ended = running & (terminated | truncated)
        infos: Infos = {}
        if self.autoreset_mode is AutoresetMode.NEXT_STEP and done.any():
            self._begin(np.flatnonzero(done), None, fixed=False)
            terminated[done] = truncated[done] = False
        elif self.autoreset_mode is AutoresetMode.SAME_STEP and ended.any():
            infos = final_infos(self._observation(), self._infos(), ended)
            self._begin(np.flatnonzero(ended), None, fixed=False)
        if self.render_mode == "human":
            self.render()
        return self._observation(), reward, terminated, truncated, self._infos() | infos

    def _checked(self, actions: npt.ArrayLike) -> FloatArray:
        values = np.asarray(actions, dtype=np.float64)
        if values.shape != (self.num_envs, len(ACTIONS)) or not np.isfinite(values).all():
            raise InputError(
                f"Actions of shape {values.shape} do not fit or are not finite.",
                remedy=f"Give finite numbers of shape {(self.num_envs, len(ACTIONS))}.",
            )
        return np.minimum(np.maximum(values, -1.0), 1.0)

    def _judge(self, now: Measures, running: BoolArray) -> None:
        """Set the flags of the episodes that end with this step."""
        course = self.config.course
        self._success |= running & (now.x_m >= course.target_m) & ~self._diverged
        fell = now.z_m < -course.fall_depth_m
        self._terminated |= running & (self._success | fell | self._diverged)
        capped = self._steps >= self.config.steps_per_episode
        self._truncated |= running & capped & ~self._terminated

    def _reward(self, before: Measures, now: Measures, running: BoolArray) -> FloatArray:
        """Return the reward of eq. 6, shape ``(env,)``."""
        config = self.config.reward
        left_m = np.maximum(self.config.course.target_m - now.x_m, 0.0)
        failed = running & self._terminated & ~self._success
        return (
            rewards.time_penalty(now.yaw_deg, now.pitch_deg, self.config.steps_per_episode, config)
            + rewards.distance_penalty(left_m, now.yaw_deg, config)
            + rewards.speed_penalty(now.speed_mps, config)
            + rewards.motion_penalty(
                now.sprawl_deg - before.sprawl_deg, now.fbem_deg - before.fbem_deg, config
            )
            + rewards.final_reward(running & self._success, failed, config)
        )

    # What is returned -------------------------------------------------------------------------

    def _observation(self) -> Observations:
        assert self._measures is not None  # noqa: S101  (set by every reset)
        return observe(self._terms, self._measures, self._variant[:, 0])

    def _infos(self) -> Infos:
        assert self._measures is not None  # noqa: S101  (set by every reset)
        time_s = self._steps.astype(np.float64) * self.config.decision_interval_s
        infos: Infos = {
            "features": features(self._measures, time_s, self.config.course.target_m),
            "variant": self._variant.copy(),
            "is_success": self._success.copy(),
            "diverged": self._diverged.copy(),
        }
        infos.update({f"_{key}": np.ones(self.num_envs, dtype=np.bool_) for key in tuple(infos)})
        return infos

    # State ------------------------------------------------------------------------------------

    def state_dict(self) -> dict[str, Any]:
        """Return all that is needed to go on bit-identically: arrays and JSON-able values."""
        if self._measures is None:
            raise InputError(
                "The environment has no state before its first reset.", remedy="Call reset() first."
            )
        return {
            "schema": STATE_SCHEMA,
            "obstacle": self.obstacle.name,
            "simulation": np.array(self.simulation.batch.state),
            "steps": self._steps.copy(),
            "variant": self._variant.copy(),
            "terminated": self._terminated.copy(),
            "truncated": self._truncated.copy(),
            "success": self._success.copy(),
            "diverged": self._diverged.copy(),
            "generators": [generator.bit_generator.state for generator in self._generators],
            "task_distribution": dict(self._distribution.to_record()),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from :meth:`state_dict` of an environment made with the same arguments.

        Raises
        ------
        InputError
            If the state is of another version, obstacle or model, or another number of
            environments.
        """
        rows = np.asarray(state.get("simulation"), dtype=np.float64)
        found = (state.get("schema"), state.get("obstacle"), rows.shape)
        expected = (STATE_SCHEMA, self.obstacle.name, self.simulation.batch.state.shape)
        if found != expected:
            raise InputError(
                f"The environment state is of {found} (version, obstacle, shape), expected "
                f"{expected}.",
                remedy="Load a state saved by an environment made with the same arguments.",
            )
        self.simulation.batch.state[:] = rows
        self._steps[:] = state["steps"]
        self._variant[:] = state["variant"]
        self._terminated[:] = state["terminated"]
        self._truncated[:] = state["truncated"]
        self._success[:] = state["success"]
        self._diverged[:] = state["diverged"]
        for generator, saved in zip(self._generators, state["generators"], strict=True):
            generator.bit_generator.state = saved
        self._distribution = TaskDistribution.from_record(state["task_distribution"])
        self._measures = self.simulation.measure()

    # Pictures ---------------------------------------------------------------------------------

    def render(self) -> tuple[Any, ...] | None:
        """Return one frame per environment, or show the first one in a window."""
        if self.render_mode is None or self._measures is None:
            return None
        if self.render_mode == "human":
            self._window_data = self.simulation.data(0, self._window_data)
            if self._window is None:
                self._window = Window(self.simulation.model, self._window_data)
            self._window.sync()
            return None
        return tuple(self._frames.frame(self.simulation.data(env)) for env in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Release graphics."""
        del kwargs
        self._frames.close()
        if self._window is not None:
            self._window.close()
            self._window = None

    def generator(self, env: int) -> np.random.Generator:
        """Return the random stream of one environment."""
        return self._generators[env]


def _spawn(sequence: np.random.SeedSequence, count: int) -> list[np.random.Generator]:
    return [np.random.Generator(np.random.PCG64(child)) for child in sequence.spawn(count)]
