"""Section: learning curves, and every test of eq. 5 with what it measured and decided."""

from __future__ import annotations

from collections.abc import Mapping

from surmount.core.run_layout import CURRICULUM, TRAININGS
from surmount.core.teacher import LevelTest
from surmount.report.document import Block, Column, Fold, Notice, Paragraph, Section, Table
from surmount.report.gain_noise import CLEAR, gain_noise
from surmount.report.learning_figure import learning_curves
from surmount.report.levels_left import levels_left_blocks
from surmount.report.palette import ARM_STYLES
from surmount.report.results import RunResults
from surmount.report.text import MINUS, UNDEFINED, counted, integer, number, signed

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
        blocks += levels_left_blocks(results.trainings[CURRICULUM], results.analysis.curriculum)
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


def level_tests(results: RunResults) -> list[Block]:
    """Return a table of all level tests, or one per network where there are many."""
    found = {
        network: training.level_tests
        for network, training in results.trainings[CURRICULUM].items()
        if training.level_tests
    }
    if not found:
        return []
    window_steps = int(results.folder.config["advancement"]["window_steps"])
    window = "rF and rL sum the reward over the first and the last W learning steps of an iteration"
    intro = Paragraph(
        text=f"A level ends when (rL − rF) of its newest iteration falls below a set share of "
        f"(rL − rF) of its first iteration (eq. 5); {window}, W = {integer(window_steps)}. "
        "Iterations end with whole roll-outs, so they are a little longer than k and p. By "
        "chance: the standard deviation that a gain has where nothing is learnt, estimated from "
        "neighbouring roll-outs. Every test made:"
    )
    noise = {
        network: gain_noise(results.trainings[CURRICULUM][network], window_steps)
        for network in found
    }
    rows = {
        network: [_row(network, test, noise[network]) for test in tests]
        for network, tests in found.items()
    }
    before: list[Block] = [intro, *_about_noise(results, found, noise, window_steps)]
    if sum(map(len, rows.values())) <= FEW_TESTS:
        everything = [row for own in rows.values() for row in own]
        words = tuple(_words(network, tests) for network, tests in found.items())
        return [
            *before,
            _table("Every level test", everything),
            Fold(summary="The same in words", blocks=words),
        ]
    return [
        *before,
        *(
            Fold(
                summary=f"Network {network}: {counted(len(own), 'level test')}",
                blocks=(
                    _table(f"Level tests of network {network}", own),
                    _words(network, found[network]),
                ),
            )
            for network, own in rows.items()
        ),
    ]


def _about_noise(
    results: RunResults,
    found: Mapping[int, tuple[LevelTest, ...]],
    noise: Mapping[int, float | None],
    window_steps: int,
) -> list[Block]:
    """Warn where the first gain, by which eq. 5 measures all others, may be chance."""
    begun = [(network, test) for network, tests in found.items() for test in tests
             if test.iteration == 0]  # fmt: skip
    unclear = sum(
        abs(test.first_gain) < CLEAR * size
        for network, test in begun
        if (size := noise[network]) is not None
    )
    if not unclear:
        return []
    trainings = [results.trainings[CURRICULUM][network] for network in found]
    decisions = sum(training.total_steps for training in trainings)
    episodes = sum(training.episodes for training in trainings)
    unsure = (
        f"In {unclear} of {counted(len(begun), 'level')} the first gain was less than {CLEAR:g} "
        "times what chance makes of it: there eq. 5 could not tell learning from noise, and the "
        "level ended, or was extended, largely by luck."
    )
    remedy = (
        f"A window of {integer(window_steps)} learning steps is worth "
        f"{number(window_steps * episodes / max(decisions, 1), 2)} episodes. In longer windows "
        "(`advancement.window_steps`, W) noise grows with the square root of W, what was learnt "
        "with W itself."
    )
    return [Notice(title="Level tests decided by chance", sentences=(unsure, remedy))]


def _words(network: int, tests: tuple[LevelTest, ...]) -> Table:
    return Table(
        label="",
        title=f"What was logged for network {network}",
        columns=(Column(heading="test", numeric=True), Column(heading="in words")),
        rows=tuple((str(index), test.sentence) for index, test in enumerate(tests, 1)),
    )


def _row(network: int, test: LevelTest, noise: float | None) -> tuple[str, ...]:
    return (
        str(network),
        str(test.level + 1),
        f"extension {test.iteration}" if test.iteration else "first",
        integer(test.steps),
        number(test.first_window, 4),
        number(test.last_window, 4),
        signed(test.newest_gain),
        signed(test.first_gain),
        UNDEFINED if noise is None else f"± {number(noise, 3)}",
        "undefined" if test.ratio is None else f"{test.ratio:.3f}".replace("-", MINUS),
        f"{test.threshold:g}",
        test.decision,
    )


def _table(title: str, rows: list[tuple[str, ...]]) -> Table:
    return Table(
        label="",
        title=title,
        columns=(
            Column(heading="network"),
            Column(heading="level"),
            Column(heading="iteration"),
            Column(heading="steps", numeric=True),
            Column(heading="rF", numeric=True),
            Column(heading="rL", numeric=True),
            Column(heading="newest gain", numeric=True),
            Column(heading="first gain", numeric=True),
            Column(heading="by chance", numeric=True),
            Column(heading="ratio", numeric=True),
            Column(heading="threshold", numeric=True),
            Column(heading="decision"),
        ),
        rows=tuple(rows),
    )
