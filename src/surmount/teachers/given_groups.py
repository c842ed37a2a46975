"""Groups that somebody gives, with the paper's levels over them: grouping and levels told apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.groups import rank_groups
from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.space import TaskSpace
from surmount.teachers.ablations import with_some_level


@dataclass(frozen=True, kw_only=True)
class GivenGroupsConfig:
    """Where the groups end that a designer, or another publication, gives."""

    boundaries: tuple[float, ...] = ()
    """Ends between neighbouring groups along the one task parameter, ascending, in its unit; each
    lies between two variants. The paper's groups of the step are 33.5 and 46.5 mm."""


def require_boundaries(config: GivenGroupsConfig, space: TaskSpace) -> None:
    """Refuse boundaries that make no groups of a task space, before anything is trained.

    Raises
    ------
    ConfigError
        If the space has several parameters or categories, no boundary is given, they do not ascend,
        or a group between them has no variant.
    """
    name = space.parameters[0]
    if len(space.parameters) > 1 or space.axes[0].categorical:
        raise ConfigError(
            "`given-groups` divides one numeric task parameter, and the tasks have "
            + ("several." if len(space.parameters) > 1 else f"the categories of `{name}`."),
            remedy="Leave this teacher out; `parameter-distance` groups such tasks.",
        )
    if not config.boundaries:
        raise ConfigError(
            "`given-groups` has no groups.",
            remedy=f"Give where they end on `{name}`, for example "
            "`--teaching.given-groups.boundaries 33.5 46.5`.",
        )
    if not (np.diff(config.boundaries) > 0).all():
        raise ConfigError(
            f"The boundaries {list(config.boundaries)} do not ascend.",
            remedy="Give them from the smallest to the largest, each once.",
        )
    places = np.searchsorted(config.boundaries, space.variants[:, 0])
    empty = np.flatnonzero(np.bincount(places, minlength=len(config.boundaries) + 1) == 0)
    if empty.size:
        raise ConfigError(
            f"No variant of `{name}` lies in group {empty[0] + 1} of the boundaries "
            f"{list(config.boundaries)}.",
            remedy=f"Give boundaries between variants, which go from "
            f"{space.variants[0, 0]:g} to {space.variants[-1, 0]:g}.",
        )


def given_groups(
    curriculum: Curriculum,
    variants: FloatArray,
    success_rate: FloatArray,
    config: GivenGroupsConfig,
    analysis: AnalysisConfig,
) -> Curriculum:
    """Return the paper's levels over given groups instead of those that the analysis finds.

    Ranking by success, names, weights and bounds are the paper's way; every group below the
    threshold has a level. Where none is left below it, the hardest has the only level.

    Parameters
    ----------
    curriculum
        The one found; it gives parameters and threshold.
    variants, success_rate
        Of all networks' trials, shapes ``(variant, 1)`` and ``(variant,)``.
    config
        Where groups end.
    analysis
        Weights and bounds.
    """
    labels = np.searchsorted(config.boundaries, variants[:, 0]).astype(np.int64)
    return with_some_level(curriculum, variants, *rank_groups(labels, success_rate), analysis)
