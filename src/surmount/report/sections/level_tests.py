"""Every test of eq. 5 on a run's page: what was measured, by which rule, and what was decided."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median

from surmount.report.document.parts import Block, Column, Fold, Notice, Paragraph, Table
from surmount.report.document.text import MINUS, UNDEFINED, counted, integer, number, signed
from surmount.report.results import RunResults
from surmount.report.sections.gain_noise import CLEAR, noise_of_test
from surmount.teachers.teacher import LevelTest

FEW_TESTS = 12
"""Up to so many tests are shown at once; more are folded network by network."""


def level_tests(results: RunResults) -> list[Block]:
    """Return a table of all level tests, or one per network where there are many."""
    found = {
        network: training.level_tests
        for network, training in results.trainings["curriculum"].items()
        if training.level_tests
    }
    if not found:
        return []
    window_steps = int(results.folder.config["advancement"]["window_steps"])
    noise = {
        network: [
            noise_of_test(test, results.trainings["curriculum"][network], window_steps)
            for test in tests
        ]
        for network, tests in found.items()
    }
    tests = [test for own in found.values() for test in own]
    intro = Paragraph(
        text=f"A level ends when (rL − rF) of its newest iteration falls below a set share of "
        f"(rL − rF) of its first iteration (eq. 5). {_about_measure(tests, window_steps)} "
        f"{_about_rules(tests)} Iterations end with whole roll-outs, so they are a little longer "
        "than k and p. Every test made:"
    )
    rows = {
        network: [
            _row(network, test, size) for test, size in zip(tests, noise[network], strict=True)
        ]
        for network, tests in found.items()
    }
    before: list[Block] = [
        intro,
        *_about_short_windows(results, found, window_steps),
        *_about_noise(results, found, noise, window_steps),
    ]
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


def _about_measure(tests: Sequence[LevelTest], window_steps: int) -> str:
    """Say what rF and rL are, and how their noise is told."""
    if any(test.measure == "episode" for test in tests):
        return (
            "rF and rL are the mean rewards of the episodes that ended within the first and the "
            f"last W learning steps of an iteration, W = {integer(window_steps)}, or of the "
            "nearest to end where none ended within them; how many, stands behind each. By "
            "chance: the standard deviation that the newest gain has where nothing is learnt, "
            "from the differences of episodes that ended one after the other."
        )
    return (
        "rF and rL sum the reward over the first and the last W learning steps of an iteration, "
        f"W = {integer(window_steps)}. By chance: the standard deviation that a gain has where "
        "nothing is learnt, estimated from neighbouring roll-outs."
    )


def _about_rules(tests: Sequence[LevelTest]) -> str:
    """Say which rules decided, those of older records included."""
    if any(test.rule is None for test in tests):
        return (
            "In this run, made by an earlier rule, a level was passed at its first test already "
            "where its first gain was zero or less; eq. 5 as printed passes none there."
        )
    return (
        "A first test compares the first iteration with itself and never passes. Where the first "
        "gain was not above the floor, a level was extended while the newest gain was (assumed)."
    )


def _about_noise(
    results: RunResults,
    found: Mapping[int, tuple[LevelTest, ...]],
    noise: Mapping[int, Sequence[float | None]],
    window_steps: int,
) -> list[Block]:
    """Warn where the first gain, by which eq. 5 measures all others, may be chance."""
    begun = [(test, size) for network, tests in found.items()
             for test, size in zip(tests, noise[network], strict=True)
             if test.iteration == 0]  # fmt: skip
    unclear = sum(
        abs(test.first_gain) < CLEAR * size
        for test, size in begun
        if test.first_gain is not None and size is not None
    )
    if not unclear:
        return []
    unsure = (
        f"In {unclear} of {counted(len(begun), 'level')} the first gain was less than {CLEAR:g} "
        "times what chance makes of it: there eq. 5 could not tell learning from noise, and the "
        "level ended, or was extended, largely by luck."
    )
    remedy = _remedy(results, found, window_steps)
    return [Notice(title="Level tests decided by chance", sentences=(unsure, remedy))]


def _about_short_windows(
    results: RunResults, found: Mapping[int, tuple[LevelTest, ...]], window_steps: int
) -> list[Block]:
    """Warn where the first window of a training closed before its longer episodes could end."""
    begun = {network: tests[0] for network, tests in found.items() if tests[0].level == 0}
    lengths = [
        int(record.length.max())
        for network, test in begun.items()
        if (record := results.trainings["curriculum"][network].record) is not None
        and record.length.size
        and test.measure == "episode"
    ]
    environments = int(results.folder.config["learner"]["num_envs"])
    if not lengths or environments * max(lengths) <= window_steps:
        return []
    gains = [test.first_gain for test in begun.values() if test.first_gain is not None]
    fell = sum(gain <= 0 for gain in gains)
    return [
        Notice(
            title="The first window held the quickest episodes alone",
            sentences=(
                (
                    f"All episodes begin anew with the first level. Its first window of "
                    f"{integer(window_steps)} learning steps is "
                    f"{integer(window_steps // environments)} steps in each of "
                    f"{counted(environments, 'environment')}, and episodes took up to "
                    f"{integer(max(lengths))}: those that fail late had not ended. So rF is of "
                    f"what succeeds soon, and the first gain too small: it is zero or less in "
                    f"{fell} of {counted(len(gains), 'network')}."
                ),
                (
                    "A window of at least "
                    f"{integer(environments * max(lengths))} learning steps "
                    "(`advancement.window_steps`, W) holds all kinds of episodes."
                ),
            ),
        )
    ]


def _remedy(
    results: RunResults, found: Mapping[int, tuple[LevelTest, ...]], window_steps: int
) -> str:
    window = f"A window of {integer(window_steps)} learning steps"
    counts = [
        count
        for tests in found.values()
        for test in tests
        for count in (test.first_episodes, test.last_episodes)
        if count is not None
    ]
    if counts:
        return (
            f"{window} held {number(median(counts), 2)} episodes (median). In longer windows "
            "(`advancement.window_steps`, W) noise falls with the square root of their number."
        )
    trainings = [results.trainings["curriculum"][network] for network in found]
    decisions = sum(training.total_steps for training in trainings)
    episodes = sum(training.episodes for training in trainings)
    return (
        f"{window} is worth {number(window_steps * episodes / max(decisions, 1), 2)} episodes. In "
        "longer windows (`advancement.window_steps`, W) noise grows with the square root of W, "
        "what was learnt with W itself."
    )


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
        _window(test.first_window, test.first_episodes),
        _window(test.last_window, test.last_episodes),
        signed(test.newest_gain),
        signed(test.first_gain),
        UNDEFINED if noise is None else f"± {number(noise, 3)}",
        "undefined" if test.ratio is None else f"{test.ratio:.3f}".replace("-", MINUS),
        f"{test.threshold:g}",
        UNDEFINED if test.rule is None else test.rule,
        test.decision,
    )


def _window(reward: float | None, episodes: int | None) -> str:
    """Return rF or rL and, by episodes, how many it is the mean of."""
    return number(reward, 4) if episodes is None else f"{number(reward, 4)} ({episodes})"


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
            Column(heading="decided by"),
            Column(heading="decision"),
        ),
        rows=tuple(rows),
    )
