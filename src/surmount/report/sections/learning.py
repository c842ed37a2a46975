"""Section: learning curves, what was learnt on, and how levels were tested and left."""

from __future__ import annotations

from surmount.report.document.parts import Block, Column, Notice, Section, Table
from surmount.report.document.text import counted, integer
from surmount.report.figures.learning import learning_curves
from surmount.report.figures.palette import ARM_STYLES
from surmount.report.results import RunResults
from surmount.report.sections.exposure import exposure_blocks
from surmount.report.sections.level_tests import level_tests
from surmount.report.sections.levels_left import levels_left_blocks
from surmount.workflow.run_layout import CONTROL, CURRICULUM, TRAININGS

FEW_TESTS = 12
"""Up to so many tests are shown at once; more are folded network by network."""


def learning_section(results: RunResults) -> Section:
    """Show how every network learnt."""
    blocks: list[Block] = []
    for measure in ("reward", "success"):
        figure = learning_curves(results.trainings, measure)
        if figure is not None:
            blocks.append(figure)
    if not blocks:
        blocks.append(
            Notice(title="Not there yet", sentences=("No network has finished its initiation.",))
        )
    blocks.append(training_table(results))
    if results.analysis is not None:
        curriculum = results.analysis.curriculum
        blocks += exposure_blocks(
            results.trainings[CURRICULUM], results.trainings[CONTROL], curriculum
        )
        blocks += levels_left_blocks(results.trainings[CURRICULUM], curriculum)
    blocks += level_tests(results)
    return Section(anchor="learning", title="Learning", blocks=tuple(blocks))


def training_table(results: RunResults) -> Table:
    """Return steps, episodes and diverged episodes of each training."""
    rows = [
        (
            str(network),
            ARM_STYLES[kind].name,
            integer(training.total_steps),
            integer(training.episodes),
            integer(training.diverged_episodes),
            integer(training.skipped_updates),
            integer(training.undone_rollouts),
        )
        for kind in TRAININGS
        for network, training in results.trainings[kind].items()
    ]
    diverged = sum(
        training.diverged_episodes
        for found in results.trainings.values()
        for training in found.values()
    )
    return Table(
        label="",
        title="What was learnt on",
        columns=(
            Column(heading="network"),
            Column(heading="stage"),
            Column(heading="learning steps", numeric=True),
            Column(heading="episodes", numeric=True),
            Column(heading="diverged", numeric=True),
            Column(heading="updates left out", numeric=True),
            Column(heading="roll-outs undone", numeric=True),
        ),
        rows=tuple(sorted(rows, key=lambda row: int(row[0]))),
        notes=(
            (
                f"Diverged: {counted(diverged, 'episode')} in all ended because the physics left "
                "its limits. Left out: updates whose loss or gradient was not finite, or exploded. "
                "Undone: roll-outs after which the networks were put back to where they were."
            ),
        ),
    )
