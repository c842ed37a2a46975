"""Configuration of roll-outs."""

from __future__ import annotations

from dataclasses import dataclass

from surmount.core.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class RolloutConfig:
    """Repeated trials of a network on every variant (paper II-A, III-D)."""

    repetitions: int = 30
    """Trials per variant and network (paper III-C, III-D)."""

    deterministic: bool = False
    """Act by the mean of the policy instead of drawing from it. From one fixed start pose a
    deterministic policy repeats a single trial, so the default draws (assumed)."""

    def __post_init__(self) -> None:
        if self.repetitions < 1:
            raise ConfigError(
                f"`repetitions` is {self.repetitions}.", remedy="Give at least one trial."
            )
