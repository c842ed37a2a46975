"""The paper's automatic test to advance from level to level (eq. 5)."""

from __future__ import annotations

from dataclasses import dataclass

from surmount.core.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class AdvancementConfig:
    """Length of a level and the test that ends it (paper II-C, III-C)."""

    iteration_steps: int = 500_000
    """k: learning steps of a level's first iteration, over all environments (paper III-C)."""

    extension_steps: int = 100_000
    """p: learning steps of each further iteration after a test not passed (paper III-C)."""

    window_steps: int = 5_000
    """W: learning steps at the start and the end of an iteration whose rewards are summed
    (paper III-C)."""

    threshold: float = 0.1
    """A level is passed where the newest reward gain falls below this share of the first
    (paper eq. 5)."""

    max_extensions: int = 10
    """Extensions after which the next level begins whatever the test says (paper III-C)."""

    gain_floor: float = 0.0
    """Reward gain, in units of the summed reward, that the first iteration must exceed for the
    ratio of eq. 5 to mean anything (assumed: the paper does not treat a gain of zero or less)."""

    def __post_init__(self) -> None:
        for name in ("iteration_steps", "extension_steps", "window_steps"):
            if getattr(self, name) < 1:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give a positive number of steps."
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


def gain_ratio(first_gain: float, newest_gain: float, *, gain_floor: float) -> float | None:
    """Return the left side of eq. 5, or ``None`` where its denominator means nothing.

    Parameters
    ----------
    first_gain
        rL − rF of the level's first iteration.
    newest_gain
        rL − rF of the newest iteration.
    gain_floor
        Gain that ``first_gain`` must exceed.
    """
    return newest_gain / first_gain if first_gain > gain_floor else None


def passes(first_gain: float, newest_gain: float, *, threshold: float, gain_floor: float) -> bool:
    """Decide eq. 5: whether reward has stopped growing, compared with the first iteration.

    Where the first iteration gained nothing there is no scale to compare with; the level then
    counts as flat, and is passed, as soon as the newest iteration gains nothing either.
    """
    ratio = gain_ratio(first_gain, newest_gain, gain_floor=gain_floor)
    return newest_gain <= gain_floor if ratio is None else ratio < threshold
