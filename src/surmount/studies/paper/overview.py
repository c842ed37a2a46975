"""One page over several runs: claim by claim, and what all obstacles say together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

from surmount.core.errors import InputError
from surmount.report.answer import Answer, Help, answer
from surmount.report.document.parts import (
    Block,
    Column,
    Document,
    Figure,
    Notice,
    Paragraph,
    Section,
    Table,
)
from surmount.report.document.text import counted, duration, integer, listed, number
from surmount.report.figures.profile import profiles
from surmount.report.figures.success import success_by_group
from surmount.report.figures.variant import success_by_variant
from surmount.report.results import RunResults
from surmount.report.sections.evidence import evidence_row, evidence_table
from surmount.report.sections.grouping import group_table, level_table
from surmount.report.sections.summary import notices
from surmount.report.verdicts import UNTRAINED, Claim, Verdict
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.evidence import (
    SeedInterval,
    bootstrap_interval,
    difference_interval,
    probability_of_improvement,
)
from surmount.stats.profile import THRESHOLDS, PerformanceProfile, performance_profile
from surmount.stats.result import Result
from surmount.studies.paper.section import claim_table
from surmount.workflow.run_layout import ARMS, SCHEMA

VERDICTS = get_args(Verdict)
SEED = 0
"""Seed of the bootstrap over networks."""


def overview_of(runs: Sequence[RunResults], over_all: Together | None) -> Document:
    """Lay out the page of several runs, one per obstacle, and of what they say together.

    Raises
    ------
    InputError
        If two runs are on the same obstacle.
    """
    names = [_name(run) for run in runs]
    if len(set(names)) < len(names):
        raise InputError(
            f"Two of the runs are on the same obstacle: {listed(names)}.",
            remedy="Give one run for each obstacle.",
        )
    claims = {_name(run): run.evidence.claims for run in runs}
    answers = {_title(run): answer(run) for run in runs}
    sections = [_obstacle(run, claims[_name(run)]) for run in runs]
    if over_all is not None:
        sections.insert(0, _together(over_all, runs))
    return Document(
        title="RSTAR's obstacles, claim by claim",
        subtitle="What a reproduction at this scale says to the paper's results",
        notices=tuple(_notices(runs)),
        summary=(_verdict(answers), *_effects(answers), *_summary(claims)),
        facts=(
            ("obstacles", str(len(runs))),
            ("networks", listed([str(run.folder.networks) for run in runs])),
            ("seeds", listed([str(run.folder.config.get("seed", "—")) for run in runs])),
            ("learning steps", integer(sum(map(_steps, runs)))),
            ("computing", duration(sum(run.folder.protocol_s for run in runs))),
        ),
        sections=(*sections, _effort(runs)),
    )


def overview_record(runs: Sequence[RunResults], over_all: Together | None) -> dict[str, Any]:
    """Return what the page of several runs concludes, in JSON form."""
    return {
        "schema": SCHEMA,
        "claims": {
            _name(run): [claim.to_record() for claim in run.evidence.claims] for run in runs
        },
        "together": None if over_all is None else over_all.to_record(),
    }


def _notices(runs: Sequence[RunResults]) -> list[Notice]:
    return [
        replace(notice, title=f"{_title(run)}: {notice.title.lower()}")
        for run in runs
        for notice in notices(run.folder)
    ]


def _verdict(answers: Mapping[str, Answer]) -> str:
    """Answer for all obstacles in one sentence."""
    by = {
        verdict: [name.lower() for name, found in answers.items() if found.verdict == verdict]
        for verdict in get_args(Help)
    }
    helps, harms, unsure = (by[verdict] for verdict in ("helps", "harms", "not shown"))
    mastered = by["nothing to add"]
    ends = f"; on {listed(mastered)} every trial succeeds without it, too" if mastered else ""
    asked = len(helps) + len(harms) + len(unsure)
    if not asked and mastered:
        return f"The curriculum had nothing to add on {listed(mastered)}: every trial succeeds."
    if not asked:
        return "Whether the curriculum helps cannot be said of any obstacle yet."
    of = f"of {counted(asked, 'obstacle')} on which it can be asked"
    if helps and not harms:
        first = f"The curriculum helps on {len(helps)} {of}: {listed(helps)}"
    elif harms:
        first = f"The curriculum harms on {len(harms)} {of}: {listed(harms)}"
        if helps:
            first += f"; it helps on {listed(helps)}"
    else:
        first = f"The curriculum is not shown to help on any {of}"
    return f"{first}{f'; on {listed(unsure)} networks do not tell' if unsure else ''}{ends}."


def _effects(answers: Mapping[str, Answer]) -> list[str]:
    """Return the effect on each obstacle, by networks."""
    return [
        f"{name}: {found.effect}; {found.networks}."
        if found.effect
        else f"{name}: {found.sentences[0][0].lower()}{found.sentences[0][1:]}"
        for name, found in answers.items()
    ]


def _summary(claims: dict[str, tuple[Claim, ...]]) -> list[str]:
    sentences: list[str] = []
    for obstacle, found in claims.items():
        counts = [
            f"{sum(claim.verdict == verdict for claim in found)} {verdict}"
            for verdict in VERDICTS
            if any(claim.verdict == verdict for claim in found)
        ]
        sentences.append(
            f"{obstacle.replace('-', ' ').capitalize()}: of {counted(len(found), 'claim')} "
            f"{listed(counts)}."
            if found
            else f"{obstacle.replace('-', ' ').capitalize()}: no claim can be judged yet."
        )
    return sentences


def _name(run: RunResults) -> str:
    """Return the last part of the task's name: an anchor, and the stem of file names."""
    return run.folder.task.rpartition("/")[2]


def _title(run: RunResults) -> str:
    return _name(run).replace("-", " ").capitalize()


def _obstacle(run: RunResults, claims: tuple[Claim, ...]) -> Section:
    blocks: list[Block] = []
    if claims:
        blocks.append(claim_table(claims))
    if run.analysis is not None:
        blocks += [group_table(run.analysis), level_table(run.analysis)]
        if run.comparison is not None:
            curriculum = run.analysis.curriculum
            for figure in (
                success_by_group(run.comparison, curriculum, run.tests),
                success_by_variant(run.comparison, curriculum),
            ):
                blocks.append(_of_obstacle(figure, run))
    if not blocks:
        blocks.append(Paragraph(text="The run has not come as far as its analysis."))
    return Section(anchor=_name(run), title=_title(run), blocks=tuple(blocks))


def _of_obstacle(figure: Figure, run: RunResults) -> Figure:
    return replace(
        figure,
        name=f"{_name(run)}-{figure.name}",
        label="",
        title=f"{figure.title}, {_title(run).lower()}",
    )


# All obstacles together ------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Together(Result):
    """What all obstacles say together, each being a stratum with networks of its own.

    Attributes
    ----------
    obstacles
        Those that count: both arms were tested, and there was something to learn.
    interquartile_mean, profiles
        Of the success rates over networks, by arm.
    difference, probability_of_improvement
        Curriculum against control.
    """

    obstacles: tuple[str, ...]
    interquartile_mean: Mapping[str, SeedInterval]
    difference: SeedInterval
    probability_of_improvement: SeedInterval
    profiles: Mapping[str, PerformanceProfile]


def together(runs: Sequence[RunResults]) -> Together | None:
    """Summarise over networks and obstacles; ``None`` before both arms of one were tested."""
    counted_in = [run for run in _tested(runs) if not _untrained(run)]
    if not counted_in:
        return None
    scores = {arm: {_name(run): run.tests[arm].scores() for run in counted_in} for arm in ARMS}
    bootstrap = Bootstrap(seed=SEED)
    first, second = (scores[arm] for arm in ARMS)
    return Together(
        obstacles=tuple(map(_name, counted_in)),
        interquartile_mean={arm: bootstrap_interval(own, bootstrap) for arm, own in scores.items()},
        difference=difference_interval(first, second, bootstrap, paired=True),
        probability_of_improvement=probability_of_improvement(
            first, second, bootstrap, paired=True
        ),
        profiles={
            arm: performance_profile(own, THRESHOLDS, bootstrap) for arm, own in scores.items()
        },
    )


def _together(found: Together, runs: Sequence[RunResults]) -> Section:
    rows = [
        *(
            evidence_row(f"success, interquartile mean, {arm}", found.interquartile_mean[arm])
            for arm in ARMS
        ),
        evidence_row("difference, curriculum − control", found.difference, "points"),
        evidence_row("probability of improvement", found.probability_of_improvement),
    ]
    note = (
        "Stratified bootstrap: networks are redrawn within their obstacle. Rates of all "
        "variants count alike, so obstacles with more variants count more."
    )
    left_out = [
        f"{_title(run)} is left out. {UNTRAINED}" for run in _tested(runs) if _untrained(run)
    ]
    table = evidence_table("Success over networks, all obstacles", rows, (note, *left_out))
    blocks = (table, profiles(found.profiles))
    return Section(anchor="together", title="All obstacles together", blocks=blocks)


def _tested(runs: Sequence[RunResults]) -> list[RunResults]:
    return [run for run in runs if all(arm in run.tests for arm in ARMS)]


def _untrained(run: RunResults) -> bool:
    return run.analysis is not None and run.analysis.curriculum.n_levels == 0


# What it took ----------------------------------------------------------------------------------


def _steps(run: RunResults) -> int:
    return sum(
        training.total_steps for found in run.trainings.values() for training in found.values()
    )


def _effort(runs: Sequence[RunResults]) -> Section:
    rows: list[tuple[str, ...]] = []
    for run in runs:
        trained = sum(
            run.folder.seconds.get(f"{kind}/network-{network}", 0.0)
            for kind, found in run.trainings.items()
            for network in found
        )
        rows.append(
            (
                _title(run),
                str(run.folder.networks),
                integer(_steps(run)),
                number(_steps(run) / trained, 4) if trained else "—",
                duration(run.folder.protocol_s),
                run.folder.machine.get("processor", "—"),
            )
        )
    headings = ("obstacle", "networks", "learning steps", "steps/s per process", "computing")
    table = Table(
        label="",
        title="Steps and time",
        columns=(
            Column(heading=headings[0]),
            *(Column(heading=heading, numeric=True) for heading in headings[1:]),
            Column(heading="machine"),
        ),
        rows=tuple(rows),
        notes=("Time of all stages together, each on one thread; several ran side by side.",),
    )
    return Section(anchor="effort", title="What it took", blocks=(table,))
