"""The paper's automatic test to advance from level to level (eq. 5)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import get_args

from surmount.core.configuration import absent
from surmount.core.errors import ConfigError
from surmount.teachers.teacher import RewardMeasure, Rule


@dataclass(frozen=True, kw_only=True)
class AdvancementConfig:
    """Length of a level and the test that ends it (paper II-C, III-C)."""

    iteration_steps: int = 500_000
    """k: learning steps of a level's first iteration, over all environments (paper III-C). The
    test after it compares the first iteration with itself, and never passes."""

    extension_steps: int = 100_000
    """p: learning steps of each further iteration after a test not passed (paper III-C)."""

    measure: RewardMeasure = field(default="episode", metadata=absent("step"))
    """r of eq. 5 over a window of W learning steps. `episode`: the mean unnormalised reward of the
    episodes that ended within it, wherever they began; where none did, of the first to end in the
    iteration, or of the last (the paper has "cumulative reward", II-C, and "average cumulative
    reward", fig. 7: most plausibly this). Where no episode ended in the whole iteration, or both
    windows hold the same ones, no gain can be told and the level is extended. `step`: the sum of
    the unnormalised rewards of its learning steps, in which an episode counts by its length."""

    window_steps: int = 5_000
    """W: learning steps at the start and the end of an iteration over which r is measured
    (paper III-C)."""

    threshold: float = 0.1
    """A level is passed where the newest reward gain falls below this share of the first
    (paper eq. 5), from its second test on."""

    max_extensions: int = 10
    """Extensions after which the next level begins whatever the test says (paper III-C)."""

    gain_floor: float = 0.0
    """Reward gain, in units of r, that the first iteration must exceed for the ratio of eq. 5 to
    mean anything. Where it did not, the level is extended while the newest gain exceeds it
    (assumed: the paper does not treat a first gain of zero or less)."""

    def __post_init__(self) -> None:
        for name in ("iteration_steps", "extension_steps", "window_steps"):
            if getattr(self, name) < 1:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give a positive number of steps."
                )
        if self.measure not in get_args(RewardMeasure):
            raise ConfigError(
                f"`measure` is {self.measure!r}.", remedy="Choose among 'episode' and 'step'."
            )
        if self.window_steps > min(self.iteration_steps, self.extension_steps):
            raise ConfigError(
                f"`window_steps` ({self.window_steps}) is longer than an iteration.",
                remedy="Let it be at most `iteration_steps` and `extension_steps`.",
            )
        if not self.threshold > 0:
            raise ConfigError(
                f"`threshold` is {self.threshold}.", remedy="Give a positive share, such as 0.1."
            )
        if self.max_extensions < 0:
            raise ConfigError(
                f"`max_extensions` is {self.max_extensions}.", remedy="Give zero or more."
            )
        if not self.gain_floor >= 0:
            raise ConfigError(
                f"`gain_floor` is {self.gain_floor}.",
                remedy="Give zero or more: a share of a negative gain means nothing.",
            )


def gain_ratio(
    first_gain: float | None, newest_gain: float | None, *, gain_floor: float
) -> float | None:
    """Return the left side of eq. 5, or ``None`` where it means nothing.

    Parameters
    ----------
    first_gain
        rL − rF of the level's first iteration; ``None`` where it cannot be told.
    newest_gain
        rL − rF of the newest iteration, likewise.
    gain_floor
        Gain that ``first_gain`` must exceed, zero or more.
    """
    if first_gain is None or newest_gain is None or first_gain <= gain_floor:
        return None
    return newest_gain / first_gain


def deciding_rule(
    first_gain: float | None, newest_gain: float | None, *, iteration: int, gain_floor: float
) -> Rule:
    """Return what decides a test, as :attr:`surmount.teachers.teacher.LevelTest.rule` names it.

    Parameters
    ----------
    first_gain, newest_gain, gain_floor
        As in :func:`gain_ratio`.
    iteration
        The newest, from 0.
    """
    if newest_gain is None:
        return "no gain"
    if iteration == 0:
        return "first test"
    ratio = gain_ratio(first_gain, newest_gain, gain_floor=gain_floor)
    return "newest gain" if ratio is None else "ratio"


def passes(
    first_gain: float | None,
    newest_gain: float | None,
    *,
    iteration: int,
    threshold: float,
    gain_floor: float,
) -> bool:
    """Decide eq. 5: whether reward has stopped growing, compared with the first iteration.

    Read as printed, the first test compares the first iteration with itself: its ratio is 1,
    whatever the gain, and no level is passed by it. Where the first iteration gained nothing there
    is no scale for those after it; the level is then passed as soon as the newest gains nothing
    either.
    """
    rule = deciding_rule(first_gain, newest_gain, iteration=iteration, gain_floor=gain_floor)
    ratio = gain_ratio(first_gain, newest_gain, gain_floor=gain_floor)
    if rule == "ratio" and ratio is not None:
        return ratio < threshold
    return rule == "newest gain" and newest_gain is not None and newest_gain <= gain_floor
