"""The paper's curriculum with one idea taken out, as curricula of the same form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.dendrogram import build_dendrogram, relabelled
from surmount.analysis.group_boxes import group_boxes
from surmount.analysis.groups import group_names, rank_groups
from surmount.analysis.levels import build_levels
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.seeds import generator
from surmount.tasks.cells import TaskCells, differences
from surmount.tasks.curriculum import Curriculum, Group, Level

_DECIMALS = 9
"""Of distances in units of the range: what differs by rounding alone is equal."""


def stepwise(curriculum: Curriculum) -> Curriculum:
    """Return the levels without mixtures: each of its dominant group alone.

    The paper names the selection of single groups as future work.
    """
    names = [group.name for group in curriculum.groups]
    return replace(
        curriculum,
        levels=tuple(
            Level(
                dominant=level.dominant,
                weights=tuple(float(name == level.dominant) for name in names),
            )
            for level in curriculum.levels
        ),
    )


def equally_weighted(curriculum: Curriculum) -> Curriculum:
    """Return the levels with the same weight for every group: groups without an order."""
    share = 1.0 / len(curriculum.groups)
    return replace(
        curriculum,
        levels=tuple(
            Level(dominant=level.dominant, weights=(share,) * len(curriculum.groups))
            for level in curriculum.levels
        ),
    )


def randomly_ordered(curriculum: Curriculum, seed: int) -> Curriculum:
    """Return the curriculum with groups in a random order instead of that of their success.

    The group in each place of the order takes over the weights that the place has in every level.
    The order is never the paper's own where there are two groups or more.
    """
    count = len(curriculum.groups)
    rng = generator(seed, "order")
    order = np.arange(count)
    while count > 1 and (order == np.arange(count)).all():
        order = rng.permutation(count)
    place = np.argsort(order)
    names = [group.name for group in curriculum.groups]
    return replace(
        curriculum,
        levels=tuple(
            Level(
                dominant=names[order[names.index(level.dominant)]],
                weights=tuple(level.weights[place[group]] for group in range(count)),
            )
            for level in curriculum.levels
        ),
    )


def by_parameter_distance(
    curriculum: Curriculum, variants: FloatArray, success_rate: FloatArray, config: AnalysisConfig
) -> Curriculum:
    """Return as many groups by nearness in parameter space instead of behaviour.

    Distances are Euclidean with every parameter in units of its range, on the scale of its axis,
    and two categories one unit apart; linkage, ranking by success, weights and bounds are those of
    the paper's way. Evenly spaced variants have many equal distances; among these the linkage takes
    the first, whatever the units. Where the groups blur success so far that none is left below the
    threshold, the hardest has the only level.

    Parameters
    ----------
    curriculum
        The paper's; it gives the number of groups.
    variants, success_rate
        Of all networks' trials, shapes ``(variant, parameter)`` and ``(variant,)``.
    config
        Linkage, weights and bounds.
    """
    from scipy.cluster import hierarchy  # noqa: PLC0415 - slow; not for a list of teachers

    distance = np.sqrt(np.square(differences(variants, curriculum.axes)).sum(axis=2))
    distance = distance.round(_DECIMALS)
    links = build_dendrogram(distance, config.linkage).links
    # Not fcluster: with equal heights it returns fewer groups than it is asked for.
    labels = hierarchy.cut_tree(links, n_clusters=len(curriculum.groups))[:, 0]
    members, rates = rank_groups(relabelled(labels.astype(np.int64)), success_rate)
    return with_some_level(curriculum, variants, members, rates, config)


def with_some_level(
    curriculum: Curriculum,
    variants: FloatArray,
    members: list[IntArray],
    rates: list[float],
    config: AnalysisConfig,
) -> Curriculum:
    """Return a curriculum of other groups; the hardest has a level, though all may succeed.

    Parameters
    ----------
    curriculum
        The paper's; it gives parameters, axes and threshold.
    variants
        All of them, ``(variant, parameter)``.
    members, rates
        Of each group in order of complexity, the variants by index and their success.
    config
        Weights and bounds.
    """
    made = _curriculum(curriculum, variants, members, rates, config)
    return made if made.levels else _with_levels(made, 1, config)


def easy_to_hard(
    curriculum: Curriculum,
    cells: TaskCells,
    success_rate: FloatArray,
    harder: tuple[int, ...],
    config: AnalysisConfig,
) -> Curriculum:
    """Return what a designer would write: equal parts of the range, from its easy end.

    There are as many parts as groups, and as many levels as the paper's curriculum has, for the
    hardest of them, with the same weights.

    Parameters
    ----------
    curriculum
        The paper's.
    cells
        All variants, in ascending order.
    success_rate
        Of each variant, ``(variant,)``; recorded with the groups, it decides nothing.
    harder
        Direction of difficulty of each parameter.
    config
        Weights and bounds.
    """
    count, n_levels = len(curriculum.groups), curriculum.n_levels
    order = cells.by_difficulty(harder)
    members = [np.sort(part) for part in np.array_split(order, count) if part.size]
    rates = [float(success_rate[part].mean()) for part in members]
    made = _curriculum(curriculum, cells.variants, members, rates, config)
    return _with_levels(made, n_levels, config)


def _with_levels(curriculum: Curriculum, n_levels: int, config: AnalysisConfig) -> Curriculum:
    """Return the curriculum with levels for its hardest groups, whatever their success."""
    names = [group.name for group in curriculum.groups]
    # The weights of eq. 4 look at places alone: succeed in the easy places, fail in the others.
    places = [float(place < len(names) - n_levels) for place in range(len(names))]
    return replace(curriculum, levels=build_levels(names, places, config))


def _curriculum(
    curriculum: Curriculum,
    variants: FloatArray,
    members: list[IntArray],
    rates: list[float],
    config: AnalysisConfig,
) -> Curriculum:
    names = group_names(len(members))
    return Curriculum(
        parameters=curriculum.parameters,
        groups=tuple(
            Group(
                name=name,
                variants=variants[group],
                success_rate=rate,
                boxes=group_boxes(variants, group, config.bounds, curriculum.axes),
            )
            for name, group, rate in zip(names, members, rates, strict=True)
        ),
        levels=build_levels(names, rates, config),
        success_threshold=config.success_threshold,
        axes=curriculum.axes,
    )
