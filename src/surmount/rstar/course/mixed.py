"""All three obstacles for one policy: every environment changes from one kind to another."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.axis import Axis
from surmount.core.errors import InputError
from surmount.core.seeds import derive_seed
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.infos import Infos, final_infos, with_masks
from surmount.rstar.course.kinds import AXES, KINDS, PARAMETERS, sizes_mm
from surmount.rstar.course.measures import FEATURE_NAMES
from surmount.rstar.course.observations import Observations
from surmount.rstar.course.streams import Streams
from surmount.tasks.distribution import TaskDistribution


class MixedVectorEnv:
    """Satisfies :class:`surmount.envs.vector_env.TaskVectorEnv`; each kind is simulated as alone.

    Every environment has a course of each kind, of which one is under way and the others are
    parked, at no cost of physics: bodies, contacts and bits are those of the single families.

    Observations are those of :class:`ObstacleVectorEnv` with pitch at all obstacles, and before the
    size three numbers that tell the kind: 1 for its own, -1 for the others, in the order of
    :data:`KINDS`. The size is scaled by the range of its kind. ``infos`` hold ``size_mm`` besides.

    Parameters
    ----------
    num_envs
        Number of environments.
    config
        Configuration of every course.
    autoreset
        Whether an episode begins anew in the step in which it ended; otherwise it stays.
    start
        Where episodes begin unless a reset says otherwise: ``"random"`` or ``"fixed"``.
    """

    task_parameters: tuple[str, ...] = PARAMETERS
    task_axes: tuple[Axis, ...] = AXES
    feature_names: tuple[str, ...] = FEATURE_NAMES
    render_mode: str | None = None

    def __init__(
        self, num_envs: int, *, config: EnvConfig, autoreset: bool = True, start: str = "random"
    ) -> None:
        self.num_envs = num_envs
        self.step_s: float = config.step_s
        self._autoreset = autoreset
        self._start = start
        self._parts = [
            ObstacleVectorEnv(
                kind,
                num_envs,
                config=config,
                n_threads=1,  # stages run side by side (ADR 3)
                autoreset_mode=AutoresetMode.DISABLED,
                start=start,
            )
            for kind in KINDS
        ]
        own = cast(Box, self._parts[0].single_observation_space).high
        bounds = np.concatenate([own[:-1], np.ones(len(KINDS), dtype=np.float32), own[-1:]])
        self.single_observation_space = Box(-bounds, bounds, dtype=np.float32)
        self.single_action_space = self._parts[0].single_action_space
        self._distribution = TaskDistribution.uniform(
            PARAMETERS, np.array([0.0, 0.0]), np.array([len(KINDS) - 1.0, 1.0]), AXES
        )
        self._streams = Streams(num_envs)
        self._task: FloatArray = np.zeros((num_envs, 2))
        self._told: Observations = np.zeros((num_envs, bounds.size), dtype=np.float32)
        self._infos: Infos = {}
        self._sources: dict[str, str] = {}
        self._of_kind: list[IntArray] = []

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the tasks of coming episodes from another distribution."""
        if distribution.parameters != PARAMETERS or distribution.axes != AXES:
            raise InputError(
                f"The task distribution is over {distribution.parameters} or other axes than the "
                f"environment's, whose parameters are {PARAMETERS}.",
                remedy="Push a distribution made for rstar/all, with its axes.",
            )
        _check_hardness(np.stack([distribution.lower, distribution.upper])[..., 1])
        self._distribution = distribution

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observations, Infos]:
        """Begin an episode in every environment.

        Parameters
        ----------
        seed
            Of all that is drawn; None goes on with the present streams.
        options
            ``"variant"``: tasks, shape ``(env, 2)``, the kind by its place among :data:`KINDS`.

        Raises
        ------
        InputError
            If an option is unknown or does not fit.
        """
        given = dict(options or {})
        tasks = given.pop("variant", None)
        if given:
            raise InputError(
                f"Reset does not know the option {', '.join(map(repr, given))}.",
                remedy="There is the option variant.",
            )
        if seed is not None:
            self._streams.seed(derive_seed(seed, "tasks"))
        everywhere: BoolArray = np.ones(self.num_envs, dtype=np.bool_)
        seeds = [None if seed is None else derive_seed(seed, kind.name) for kind in KINDS]
        self._begin(everywhere, None if tasks is None else _checked(tasks, self.num_envs), seeds)
        return self._told.copy(), with_masks(self._copied(), everywhere)

    def step(
        self, actions: npt.ArrayLike
    ) -> tuple[Observations, FloatArray, BoolArray, BoolArray, Infos]:
        """Hold actions of shape ``(env, 3)`` for a step in every environment."""
        if not self._infos:
            raise InputError("The environment has not been reset.", remedy="Call reset() first.")
        reward: FloatArray = np.zeros(self.num_envs)
        terminated: BoolArray = np.zeros(self.num_envs, dtype=np.bool_)
        truncated: BoolArray = np.zeros(self.num_envs, dtype=np.bool_)
        for own, part in zip(self._of_kind, self._parts, strict=True):
            if not own.size:
                continue
            observed, rewards, ended, cut, infos = part.step(actions)
            reward[own], terminated[own], truncated[own] = rewards[own], ended[own], cut[own]
            self._take(own, observed, infos)
        done = terminated | truncated
        final: Infos = {}
        if self._autoreset and done.any():
            final = final_infos(self._told, self._infos, done)
            self._begin(done)
        infos = with_masks(self._copied(), np.ones(self.num_envs, dtype=np.bool_))
        return self._told.copy(), reward, terminated, truncated, {**infos, **final}

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on bit-identically."""
        if not self._infos:
            raise InputError(
                "The environment has no state before its first reset.", remedy="Call reset() first."
            )
        return {
            "kinds": {
                kind.name: part.state_dict() for kind, part in zip(KINDS, self._parts, strict=True)
            },
            "task": self._task.copy(),
            "observed": self._told.copy(),
            "infos": self._copied(),
            "generators": self._streams.state(),
            "task_distribution": dict(self._distribution.to_record()),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        for kind, part in zip(KINDS, self._parts, strict=True):
            part.load_state_dict(state["kinds"][kind.name])
        self._task = np.array(state["task"])
        self._told = np.array(state["observed"])
        self._infos = {key: np.array(value) for key, value in state["infos"].items()}
        self._sources = {
            name: "variant" if name == "size_mm" else name
            for name in self._infos
            if name != "variant"
        }
        self._tell_kinds()
        self._streams.load_state(state["generators"])
        self._distribution = TaskDistribution.from_record(state["task_distribution"])

    def close(self) -> None:
        """Release graphics."""
        for part in self._parts:
            part.close()

    def _begin(
        self,
        envs: BoolArray,
        tasks: FloatArray | None = None,
        seeds: list[int | None] | None = None,
    ) -> None:
        """Begin an episode in some environments, drawing the tasks that are not given."""
        for env in np.flatnonzero(envs).tolist():
            self._task[env] = (
                self._distribution.sample(self._streams[env], 1)[0] if tasks is None else tasks[env]
            )
        for place, (kind, part) in enumerate(zip(KINDS, self._parts, strict=True)):
            own = envs & (self._task[:, 0] == place)
            if seeds is not None or own.any():
                # Of a course's first reset, which begins everywhere, most is parked at once.
                sizes = sizes_mm(kind, np.where(own, self._task[:, 1], 0.0))
                observed, infos = part.reset(
                    seed=None if seeds is None else seeds[place],
                    options={"variant": sizes, "reset_mask": own, "start": self._start},
                )
                self._take(np.flatnonzero(own), observed, infos)
            part.park(envs & ~own)
        self._tell_kinds()

    def _tell_kinds(self) -> None:
        """Note which environments are of each kind, and tell the policy."""
        self._of_kind = [np.flatnonzero(self._task[:, 0] == place) for place in range(len(KINDS))]
        flags = self._told[:, -1 - len(KINDS) : -1]
        flags[:] = -1.0
        for place, own in enumerate(self._of_kind):
            flags[own, place] = 1.0
        self._infos["variant"] = self._task.copy()

    def _take(self, envs: IntArray, observed: Observations, infos: Infos) -> None:
        """Take what environments of one kind observed and told."""
        self._told[envs, : -1 - len(KINDS)] = observed[envs, :-1]
        self._told[envs, -1] = observed[envs, -1]
        if not self._infos:
            self._sources = {
                key: key for key in infos if not key.startswith("_") and key != "variant"
            } | {"size_mm": "variant"}
            for name, key in self._sources.items():
                shape = (self.num_envs,) if name == "size_mm" else infos[key].shape
                self._infos[name] = np.zeros(shape, infos[key].dtype)
        for name, key in self._sources.items():
            new = infos[key]
            self._infos[name][envs] = new[envs, 0] if name == "size_mm" else new[envs]

    def _copied(self) -> Infos:
        return {key: values.copy() for key, values in self._infos.items()}


def _checked(tasks: npt.ArrayLike, num_envs: int) -> FloatArray:
    given = np.asarray(tasks, dtype=np.float64)
    if given.shape != (num_envs, 2) or not AXES[0].holds(given[:, 0]).all():
        raise InputError(
            f"The variant has shape {given.shape}, or names a kind that there is not.",
            remedy=f"Give one kind, from 0 to {len(KINDS) - 1}, and hardness per environment.",
        )
    _check_hardness(given[:, 1])
    return given


def _check_hardness(values: FloatArray) -> None:
    if not ((values >= 0) & (values <= 1)).all():
        raise InputError("A hardness lies outside 0 to 1.", remedy="Give values within.")
