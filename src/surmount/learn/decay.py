"""Hyper-parameters that fall linearly while training goes on, as ML-Agents' do."""

from __future__ import annotations

from dataclasses import dataclass

from surmount.learn.config import LearnerConfig

LAST_LEARNING_RATE = 1e-10
LAST_CLIP_RANGE = 0.1
LAST_ENTROPY_COEFFICIENT = 1e-5
"""What they fall to (ML-Agents, `ppo/optimizer_torch.py`)."""


@dataclass(frozen=True, kw_only=True)
class Decayed:
    """The hyper-parameters of one update.

    Attributes
    ----------
    learning_rate
        Step size of Adam.
    clip_range
        Of the probability ratio, and of the value where that is clipped.
    entropy_coefficient
        Weight of the entropy bonus.
    """

    learning_rate: float
    clip_range: float
    entropy_coefficient: float

    @classmethod
    def at(cls, config: LearnerConfig, steps: int) -> Decayed:
        """Return them after a number of learning steps of the present training."""
        over = config.decay_steps
        left = 1.0 if over is None else 1.0 - min(steps, over) / over
        return cls(
            learning_rate=_between(config.learning_rate, LAST_LEARNING_RATE, left),
            clip_range=_between(config.clip_range, LAST_CLIP_RANGE, left),
            entropy_coefficient=_between(
                config.entropy_coefficient, LAST_ENTROPY_COEFFICIENT, left
            ),
        )


def _between(first: float, last: float, left: float) -> float:
    """Return ``first`` while all is left, ``last`` in the end; nothing grows."""
    last = min(first, last)
    return last + (first - last) * left if left < 1.0 else first
