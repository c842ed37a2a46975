"""A level test in words: what was measured, which rule decided, and what."""

from __future__ import annotations

from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.reward_windows import WindowRewards
from surmount.teachers.teacher import LevelTest


def sentence_of(test: LevelTest, windows: WindowRewards, config: AdvancementConfig) -> str:
    """Return a sentence for the log.

    Parameters
    ----------
    test
        What was measured and decided; its own sentence is not read.
    windows
        What was measured it on.
    config
        Lengths, threshold and floor.
    """
    iteration = f"extension {test.iteration}" if test.iteration else "first iteration"
    return (
        f"level {test.level + 1}, {iteration}, {test.steps:,} steps: "
        f"{_measured(windows, config)}; {_reason(test, config)}; {_action(test, config)}"
    )


def _measured(windows: WindowRewards, config: AdvancementConfig) -> str:
    span = f"over the first and last {config.window_steps:,} steps"
    if config.measure == "step":
        return f"sum of step rewards {span} rF = {windows.first:.4g}, rL = {windows.last:.4g}"
    if windows.first is None:
        return "no episode ended in the iteration"
    first, last = windows.first_episodes, windows.last_episodes
    early = _episodes(first, windows.first_steps, "first", config)
    late = _episodes(last, windows.last_steps, "last", config)
    return (
        f"mean episode reward {span} rF = {windows.first:.4g} ({early}), "
        f"rL = {windows.last:.4g} ({late})"
    )


def _episodes(count: int | None, steps: int, which: str, config: AdvancementConfig) -> str:
    words = f"{count} episode" if count == 1 else f"{count} episodes"
    if steps > config.window_steps:
        words += f", the {which} to end, within {steps:,} steps"
    return words


def _reason(test: LevelTest, config: AdvancementConfig) -> str:
    if test.newest_gain is None:
        cause = "both windows hold the same episodes" if test.first_episodes else "there is no r"
        return f"no gain can be told, for {cause}"
    if test.rule == "first test":
        return (
            f"the first test compares the first gain {test.newest_gain:+.4g} with itself (ratio 1, "
            f"threshold {config.threshold:g}) and never passes"
        )
    if test.ratio is not None:
        return (
            f"newest gain / first gain = {test.newest_gain:+.4g} / {test.first_gain:+.4g} "
            f"= {test.ratio:.3f}, threshold {config.threshold:g}"
        )
    floor = f"{config.gain_floor:g}"
    first = (
        "the level's first gain could not be told"
        if test.first_gain is None
        else f"the level's first gain {test.first_gain:+.4g} is not above {floor}"
    )
    above = test.newest_gain > config.gain_floor
    return (
        f"{first}, so the newest gain decides: {test.newest_gain:+.4g} is "
        f"{'above' if above else 'not above'} {floor}"
    )


def _action(test: LevelTest, config: AdvancementConfig) -> str:
    return {
        "advance": "passed: go on to the next level",
        "extend": f"not passed: extend by {config.extension_steps:,} steps",
        "advance at the limit": (
            f"not passed after {config.max_extensions} extensions: go on all the same"
        ),
    }[test.decision]
