"""The result in a few plain sentences, made from the data and never saying more than it shows."""

from __future__ import annotations

from surmount.analysis.cut import may_divide
from surmount.analysis.result import Analysis
from surmount.report.answer import answer, network_differences, time_differences
from surmount.report.document.parts import Notice
from surmount.report.document.text import (
    counted,
    duration,
    integer,
    listed,
    percent,
    variant_range,
)
from surmount.report.results import RunResults
from surmount.report.verdicts import group_sentence
from surmount.tasks.curriculum import ONE_GROUP
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import INITIATION

MOST_NAMED = 8
"""Up to so many missing stages are named."""


def notices(folder: RunFolder) -> list[Notice]:
    """Return what must be known before anything else is read: the scale, and what is missing."""
    found: list[Notice] = []
    if folder.preset == "smoke":
        found.append(
            Notice(
                title="Smoke scale",
                sentences=(
                    (
                        "This run shows every stage of the method at a fraction of the paper's "
                        "learning steps and trials. Its numbers say nothing about the method's "
                        "merit."
                    ),
                ),
            )
        )
    if len(folder.kinds) > 1:
        names = sorted({name for kind in folder.kinds for name in kind})
        differing = [n for n in names if len({kind.get(n) for kind in folder.kinds}) > 1]
        found.append(
            Notice(
                title="Made on several kinds of machine",
                sentences=(
                    (
                        f"Stages were made with {len(folder.kinds)} combinations of versions and "
                        f"machine, which differ in {listed(differing)}. Rounding may differ "
                        "between them: a run on one of them alone need not give the same bytes."
                    ),
                ),
            )
        )
    if folder.missing:
        named = list(folder.missing[:MOST_NAMED])
        rest = len(folder.missing) - len(named)
        found.append(
            Notice(
                title="Unfinished run",
                sentences=(
                    (
                        f"{counted(len(folder.missing), 'stage')} of "
                        f"{len(folder.missing) + len(folder.protocol)} "
                        f"{'is' if len(folder.missing) == 1 else 'are'} missing: "
                        f"{listed(named + ([f'{rest} more'] if rest else []))}. The page shows "
                        "what exists; the same command goes on where the run stopped."
                    ),
                ),
            )
        )
    return found


def one_group_notice(analysis: Analysis | None) -> list[Notice]:
    """Say before anything else that there is one group, where there is."""
    if analysis is None or len(analysis.groups) != 1 or not analysis.curriculum.levels:
        return []
    return [Notice(title="One group", sentences=(ONE_GROUP,))]


def summary(results: RunResults) -> list[str]:
    """Answer whether the curriculum helps, then say what that rests on, group by group."""
    analysis, comparison = results.analysis, results.comparison
    if analysis is None:
        trained = len(results.trainings[INITIATION])
        return [
            (
                f"{counted(trained, 'network')} of {results.folder.networks} finished the "
                "initiation; the analysis is still to come."
            )
        ]
    first, *rest = answer(results).sentences
    sentences = [first, grouping_sentence(analysis), level_sentence(analysis), *rest]
    if len(analysis.groups) == 1 and analysis.curriculum.levels:
        # The arms are one treatment: to rank them would tell chance for an effect.
        return sentences
    if comparison is None:
        return [*sentences, "The comparison of both arms is still to come."]
    return sentences + [
        group_sentence(entry, network_differences(results, index), time_differences(results, index))
        for index, entry in enumerate(comparison.groups)
    ]


def grouping_sentence(analysis: Analysis) -> str:
    """Say which groups there are, where they lie and how often they succeed."""
    groups = analysis.groups
    variants = counted(analysis.variants.shape[0], "variant")
    parts = [
        f"{group.name} ({variant_range(analysis.parameters, group.variants, analysis.axes)}, "
        f"{percent(group.success_rate)} success in the logged trials)"
        for group in groups
    ]
    if len(groups) == 1 and not may_divide(analysis.cut):
        return (
            f"{variants} are too few for a cut by the rule `{analysis.cut.method}`: they form one "
            f"group, {parts[0]}."
        )
    if len(groups) == 1:
        return f"Behaviour on {variants} showed no abrupt change: they form one group, {parts[0]}."
    return f"Behaviour divides {variants} into {len(groups)} groups: {listed(parts)}."


def level_sentence(analysis: Analysis) -> str:
    """Say how many levels there are, and for which groups."""
    curriculum = analysis.curriculum
    threshold = percent(curriculum.success_threshold)
    if not curriculum.levels:
        return f"Every group already reaches {threshold} success, so there is no level to learn."
    dominant = listed([f"“{level.dominant}”" for level in curriculum.levels])
    return (
        f"The curriculum has {counted(curriculum.n_levels, 'level')}, one for each group below "
        f"{threshold} success: {dominant}."
    )


def facts(results: RunResults) -> tuple[tuple[str, str], ...]:
    """Return the run's bare facts, name and value."""
    folder = results.folder
    found = [
        ("task", folder.task),
        ("preset", folder.preset),
        ("networks", str(folder.networks)),
        ("seed", str(folder.config.get("seed", "—"))),
    ]
    steps = sum(
        training.total_steps for found in results.trainings.values() for training in found.values()
    )
    found.append(("learning steps", integer(steps)))
    trials = sum(outcomes.success.size for outcomes in results.tests.values())
    found.append(("trials", integer(int(trials))))
    if folder.protocol_s:
        found.append(("computing", duration(folder.protocol_s)))
    found.append(("version", folder.versions.get("surmount", "—")))
    return tuple(found)
