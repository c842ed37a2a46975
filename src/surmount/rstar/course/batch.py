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
from surmount.rstar.course.actions import ACTIONS, checked_actions
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.episodes import Episodes
from surmount.rstar.course.infos import Infos, final_infos, step_infos, with_masks
from surmount.rstar.course.measures import FEATURE_NAMES, Measures
from surmount.rstar.course.observations import Observations, Observer, observation_terms
from surmount.rstar.course.obstacles import Obstacle, find_obstacle
from surmount.rstar.course.options import check_start, read_options
from surmount.rstar.course.pictures import RENDER_MODES, Pictures
from surmount.rstar.course.randomiser import Randomiser
from surmount.rstar.course.rewards import Reward
from surmount.rstar.course.saved_state import SCHEMA, check_state
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.start_poses import fixed_start, random_start
from surmount.rstar.course.streams import Streams
from surmount.rstar.course.threads import choose_threads
from surmount.tasks.distribution import TaskDistribution


class ObstacleVectorEnv(VectorEnv[Observations, npt.NDArray[Any], npt.NDArray[Any]]):
    """RSTAR before narrow channels, low entrances or steps, any number of them at once.

    Observations are ``float32``: yaw, pitch (step only), FBEM angle, sprawl angle, tangential
    speed, distance to the obstacle, the servos' targets where they are observed, and the obstacle's
    size, each ``(value − centre) / scale``, clipped. Actions are speed, FBEM and sprawl, in
    [−1, 1], clipped: rates of the three targets as fractions of their limits, held for one
    step and integrated at every physics step; targets stay within their ranges. The tables with
    symbols, units and ranges are in ``docs/environments.md``.

    Reward: eq. 6, see :class:`~surmount.rstar.course.rewards.Reward`. An episode ends when the base
    passes the target line (success), falls off the floor or diverges (terminated), or at the cap
    (truncated).

    ``infos`` of every reset and step hold, with Gymnasium's ``_key`` masks, what
    :data:`~surmount.rstar.course.infos.INFO_KEYS` names: ``features`` of shape ``(env, feature)``,
    ``variant`` of shape ``(env, parameter)``, the others of shape ``(env,)``; and, where they are
    randomised, ``dynamics`` of shape ``(env, factor)`` and ``action_delay`` of shape ``(env,)``.
    Under same-step autoreset, ``final_obs`` and ``final_info`` hold the last values of the episodes
    that ended.

    Parameters
    ----------
    obstacle
        ``"narrow-channel"``, ``"low-entrance"`` or ``"step"``, or a family of obstacles.
    num_envs
        Number of environments.
    config
        Configuration; the defaults if None.
    n_threads
        Threads that share the physics; results do not depend on it. None: one per four
        environments, at most as many as this process may use processors.
    autoreset_mode
        When an episode that ended begins anew. With ``DISABLED`` it stays frozen, unsimulated,
        with reward 0 and its ending's flags, until it is reset.
    render_mode
        ``"rgb_array"``, ``"human"`` (the first environment, in a window) or None.
    start
        Where episodes begin unless a reset says otherwise: ``"random"`` as in training, or
        ``"fixed"`` as in roll-outs.

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
        obstacle: str | Obstacle,
        num_envs: int,
        *,
        config: EnvConfig | None = None,
        n_threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
        start: str = "random",
    ) -> None:
        check_start(start)
        if num_envs < 1:
            raise ConfigError(f"`num_envs` is {num_envs}.", remedy="Give 1 or more.")
        self.config = config or EnvConfig()
        self.obstacle = find_obstacle(obstacle) if isinstance(obstacle, str) else obstacle
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._usual_start = start
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {
            **type(self).metadata,
            "render_fps": round(1 / self.config.step_s),
            "autoreset_mode": self.autoreset_mode,
        }
        self.step_s: float = self.config.step_s
        self.task_parameters: tuple[str, ...] = (self.obstacle.parameter,)
        self.feature_names: tuple[str, ...] = FEATURE_NAMES
        terms = observation_terms(self.obstacle, targets=self.config.observe_targets)
        bounds = np.array([term.bound for term in terms], dtype=np.float32)
        self.single_observation_space = Box(-bounds, bounds, dtype=np.float32)
        self.single_action_space = Box(-1.0, 1.0, shape=(len(ACTIONS),), dtype=np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

        threads = choose_threads(n_threads, num_envs)
        self.simulation = Simulation(self.obstacle, self.config, num_envs, threads)
        self._pictures = Pictures(self.simulation, render_mode, self.config.step_s)
        self._distribution = TaskDistribution.uniform(
            self.task_parameters,
            np.array([self.obstacle.lower]),
            np.array([self.obstacle.upper]),
        )
        self._streams = Streams(num_envs)
        self._episodes = Episodes(num_envs, self.obstacle, self.config)
        self._observer = Observer(terms, num_envs)
        self._randomiser: Randomiser | None = None
        if not self.config.randomisation.is_off:
            self._randomiser = Randomiser(
                self.config.randomisation,
                self.simulation.batch,
                [term.name for term in terms],
                len(ACTIONS),
            )
        self._fixed_start = fixed_start(self.config)
        self._reward = Reward(self.config)
        self._everywhere: BoolArray = np.ones(num_envs, dtype=np.bool_)
        self._measures: Measures | None = None

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
            instead of a draw. ``"start"``: ``"random"`` as in training, or ``"fixed"`` as in
            roll-outs; by default as the environment was made. ``"reset_mask"``: which environments
            to reset, shape ``(env,)``.

        Raises
        ------
        InputError
            If an option is unknown or does not fit.
        """
        chosen = read_options(
            {"start": self._usual_start, **(options or {})}, self.obstacle, self.num_envs
        )
        if seed is not None:
            self._streams.seed(seed)
            if not isinstance(seed, Sequence):
                super().reset(seed=int(seed))
        mask = chosen.mask | (self._measures is None)
        measures = self._begin(np.flatnonzero(mask), chosen.variant, fixed=chosen.fixed)
        return self._observe(measures), with_masks(self._infos(measures), self._everywhere)

    def _begin(
        self, envs: IntArray, variant: FloatArray | None = None, *, fixed: bool = False
    ) -> Measures:
        """Begin an episode in each of ``envs``, drawing what is not given."""
        for env in envs.tolist():
            rng = self._streams[env]
            task = self._distribution.sample(rng, 1)[0] if variant is None else variant[env]
            size = float(task[0])
            start = (
                self._fixed_start if fixed else random_start(self.obstacle, self.config, size, rng)
            )
            self._episodes.variant[env] = task
            if self._randomiser is not None:
                self._randomiser.begin(env, rng)
            self.simulation.place(env, size, start)
        self._episodes.begin(envs)
        self._measures = self.simulation.measure()
        return self._measures

    def step(
        self, actions: npt.ArrayLike
    ) -> tuple[Observations, FloatArray, BoolArray, BoolArray, Infos]:
        """Hold ``actions`` of shape ``(env, 3)`` for a step in every environment."""
        if self._measures is None:
            raise InputError("The environment has not been reset.", remedy="Call reset() first.")
        episodes, randomiser, before = self._episodes, self._randomiser, self._measures
        over = episodes.over if episodes.any_over else None
        running = None if over is None else ~over
        applied = checked_actions(actions, self.num_envs)
        if randomiser is not None:
            if randomiser.delay is not None:
                applied = randomiser.delay.pass_on(applied, running)
            randomiser.sense(self._streams, running)
        diverged = self.simulation.advance(applied, running)
        now = self._measures = self.simulation.measure()
        change_deg = now.joints_deg - before.joints_deg
        np.abs(change_deg, out=change_deg)
        ended = episodes.go_on(now, change_deg, diverged, running)
        reward = self._reward.running(now, change_deg)
        if ended is not None:
            reached = ended & episodes.success
            failed = ended & episodes.terminated & ~reached
            reward += self._reward.final(reached, failed)
        if over is not None:
            reward[over] = 0.0
        terminated, truncated = episodes.terminated.copy(), episodes.truncated.copy()
        final: Infos = {}
        if self.autoreset_mode is AutoresetMode.NEXT_STEP and over is not None:
            now = self._begin(np.flatnonzero(over), fixed=self._usual_start == "fixed")
            terminated[over] = truncated[over] = False
        elif self.autoreset_mode is AutoresetMode.SAME_STEP and ended is not None:
            final = final_infos(self._observe(now), self._infos(now), ended)
            now = self._begin(np.flatnonzero(ended), fixed=self._usual_start == "fixed")
        if self.render_mode == "human":
            self.render()
        infos = with_masks(self._infos(now), self._everywhere)
        infos.update(final)
        return self._observe(now), reward, terminated, truncated, infos

    def park(self, envs: BoolArray) -> None:
        """End episodes, shape ``(env,)``, without an outcome: until they are reset nothing moves.

        For environments without automatic reset, after their first one.
        """
        self._episodes.park(envs)

    def _observe(self, measures: Measures) -> Observations:
        noise = None if self._randomiser is None else self._randomiser.noise
        return self._observer.observe(measures, self._episodes.variant[:, 0], noise)

    def _infos(self, measures: Measures) -> Infos:
        infos = step_infos(measures, self._episodes)
        return infos if self._randomiser is None else infos | self._randomiser.infos()

    def generator(self, env: int) -> np.random.Generator:
        """Return the random stream of one environment."""
        return self._streams[env]

    # State ------------------------------------------------------------------------------------

    def state_dict(self) -> dict[str, Any]:
        """Return all that is needed to go on bit-identically: arrays and JSON-able values."""
        if self._measures is None:
            raise InputError(
                "The environment has no state before its first reset.", remedy="Call reset() first."
            )
        return self._state()

    def _state(self) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "obstacle": self.obstacle.name,
            "simulation": np.array(self.simulation.batch.state),
            "generators": self._streams.state(),
            "task_distribution": dict(self._distribution.to_record()),
            **self._episodes.state_dict(),
            **({} if self._randomiser is None else self._randomiser.state_dict()),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from :meth:`state_dict` of an environment made with the same arguments.

        Raises
        ------
        InputError
            If the state is of another version, obstacle, model or randomisation, or another number
            of environments.
        """
        check_state(state, self._state())
        self.simulation.batch.state[:] = state["simulation"]
        self._streams.load_state(state["generators"])
        self._distribution = TaskDistribution.from_record(state["task_distribution"])
        self._episodes.load_state_dict(state)
        if self._randomiser is not None:
            self._randomiser.load_state_dict(state)
        self._measures = self.simulation.measure()

    # Pictures ---------------------------------------------------------------------------------

    def render(self) -> tuple[Any, ...] | None:
        """Return one frame per environment, or show the first one in a window."""
        return None if self._measures is None else self._pictures.render()

    def close_extras(self, **kwargs: Any) -> None:
        """Release graphics."""
        del kwargs
        self._pictures.close()
