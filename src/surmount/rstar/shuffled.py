"""RSTAR's steps under shuffled names: the task parameter tells nothing of how high a step is.

The robot sees the height as ever, and all heights are there; only what teachers and the analysis
know of a task is a code, by a fixed bijection of the step's variants. Neighbouring codes are steps
that have nothing in common, so a metric on the parameter misleads, and only behaviour tells which
tasks belong together.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.core.seeds import generator
from surmount.envs.vector_env import TaskVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.family import INITIAL_STEPS, ObstacleFamily
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace

PARAMETER = "code"
"""Name of the task parameter, which has no unit."""
STEP = OBSTACLES["step"]
SHUFFLE_SEED = 20_240
"""Of the bijection, the same for ever."""
PAPER_GROUPS = ((34.0, "easy"), (47.0, "medium"), (np.inf, "difficult"))
"""Heights in mm below which steps are of the paper's groups (recovered)."""


def shuffled_order() -> IntArray:
    """Return the variant that each code stands for, ``(variant,)``."""
    order = generator(SHUFFLE_SEED, "shuffled").permutation(STEP.variants.size)
    return order.astype(np.int64)


class Codes:
    """The bijection between codes and heights.

    A code is the number of a variant, from 0, and half a unit to either side of it; what lies
    beside its middle lies as much beside the height of its variant, cut at the ends of the range.
    """

    def __init__(self) -> None:
        self._height_of_code = STEP.variants[shuffled_order()]
        self._code_of_height = np.argsort(shuffled_order())
        self.count = int(STEP.variants.size)

    def heights(self, codes: FloatArray) -> FloatArray:
        """Return heights in mm, of any shape."""
        middle = np.clip(np.rint(codes), 0, self.count - 1).astype(np.int64)
        height = self._height_of_code[middle] + STEP.spacing * (codes - middle)
        return np.clip(height, STEP.lower, STEP.upper)

    def codes(self, heights_mm: FloatArray) -> FloatArray:
        """Return the codes of heights, of any shape: the inverse of :meth:`heights` within."""
        place = np.clip(np.rint((heights_mm - STEP.lower) / STEP.spacing), 0, self.count - 1)
        place = place.astype(np.int64)
        beside = (heights_mm - STEP.variants[place]) / STEP.spacing
        return self._code_of_height[place] + beside

    def in_heights(self, distribution: TaskDistribution) -> TaskDistribution:
        """Return the distribution of heights that one of codes stands for.

        A box over several codes becomes a box for each of them, weighed by what it covers.
        """
        boxes: list[tuple[float, float, float]] = []
        for weight, low, high in zip(
            distribution.weights, distribution.lower[:, 0], distribution.upper[:, 0], strict=True
        ):
            first, last = np.rint([low, high])
            edges = np.concatenate([[low], np.arange(first + 0.5, last), [high]])
            width = high - low
            for begin, end in itertools.pairwise(edges):
                share = weight * ((end - begin) / width if width > 0 else 1.0)
                middle = float(np.clip(np.rint((begin + end) / 2), 0, self.count - 1))
                centre = self._height_of_code[int(middle)]
                ends = centre + STEP.spacing * (np.array([begin, end]) - middle)
                lower, upper = np.clip(ends, STEP.lower, STEP.upper)
                boxes.append((float(share), float(lower), float(upper)))
        weights, lower, upper = (np.array(column) for column in zip(*boxes, strict=True))
        return TaskDistribution(
            parameters=(STEP.parameter,),
            weights=weights / weights.sum(),
            lower=lower[:, None],
            upper=upper[:, None],
        )


class ShuffledVectorEnv:
    """Steps whose heights are told as codes; everything else is theirs.

    Parameters
    ----------
    inner
        The steps.
    """

    def __init__(self, inner: Any) -> None:
        self._inner = inner
        self._codes = Codes()
        self.task_parameters: tuple[str, ...] = (PARAMETER,)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the tasks of coming episodes from another distribution of codes."""
        if distribution.parameters != self.task_parameters:
            raise InputError(
                f"The task distribution is over {distribution.parameters}, the environment's "
                f"parameters are {self.task_parameters}.",
                remedy="Push a distribution made for shuffled steps.",
            )
        self._inner.set_task_distribution(self._codes.in_heights(distribution))

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in every environment; ``variant`` holds codes."""
        chosen = dict(options or {})
        if "variant" in chosen:
            chosen["variant"] = self._codes.heights(np.asarray(chosen["variant"], dtype=float))
        observations, infos = self._inner.reset(seed=seed, options=chosen)
        return observations, self._told(infos)

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Take one step in every environment."""
        *outcome, infos = self._inner.step(actions)
        return (*outcome, self._told(infos))  # pyright: ignore[reportReturnType]

    def _told(self, infos: dict[str, Any]) -> dict[str, Any]:
        told = {**infos, "variant": self._codes.codes(infos["variant"])}
        if "final_info" in infos:
            final = infos["final_info"]
            told["final_info"] = {**final, "variant": self._codes.codes(final["variant"])}
        return told


class ShuffledFamily(ObstacleFamily):
    """The step with shuffled names of its variants."""

    def __init__(self) -> None:
        super().__init__(STEP)
        self.name = "rstar/shuffled"
        self.title = "RSTAR and steps under shuffled names"
        self.initial_steps = INITIAL_STEPS["step"]

    def space(self, settings: EnvConfig) -> TaskSpace:
        """Return the codes; nobody knows which are harder."""
        del settings
        count = STEP.variants.size
        return TaskSpace(
            parameters=(PARAMETER,),
            lower=np.array([-0.5]),
            upper=np.array([count - 0.5]),
            variants=np.arange(count, dtype=np.float64)[:, None],
        )

    def difficulty(self, variants: FloatArray) -> FloatArray:
        """Return the heights behind the codes, in mm."""
        return Codes().heights(variants[:, 0])

    def right_groups(self, variants: FloatArray) -> tuple[tuple[str, ...], IntArray]:
        """Return the paper's groups, by the heights behind the codes."""
        heights = Codes().heights(variants[:, 0])
        bounds = np.array([bound for bound, _ in PAPER_GROUPS[:-1]])
        names = tuple(name for _, name in PAPER_GROUPS)
        return names, np.searchsorted(bounds, heights, side="right").astype(np.int64)

    def _built(
        self, settings: EnvConfig, num_envs: int, *, autoreset_mode: str, start: str
    ) -> TaskVectorEnv:
        inner = super()._built(settings, num_envs, autoreset_mode=autoreset_mode, start=start)
        return cast(TaskVectorEnv, ShuffledVectorEnv(inner))  # the rest is the inner one's

    def draw_films(self, run: Any, say: Any) -> None:
        """Draw none: films show obstacles by their size, which codes are not."""
        del run, say
