"""What goes wrong with numbers while learning: told apart, counted, and stopped from spreading.

An update whose loss or gradient is not finite, or whose loss has exploded, is left out. A roll-out
that leaves the policy unsound, or of which every update was left out, is undone: weights, optimiser
and normalisation are those from before it, and learning goes on from the next one. What does not
stop is ended after :data:`MOST_IN_A_ROW` roll-outs.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import torch

LARGEST_LOSS = 1e8
"""A loss above this has exploded. Normalised rewards are clipped to ±10, so that no return exceeds
10 / (1 − discount), whose square is about 10⁶ at 0.99 and 2.5 · 10⁷ at 0.998; losses of healthy
runs are below 10."""
MOST_IN_A_ROW = 3
"""Roll-outs in a row that are undone, or in which every episode diverges, before learning ends."""


@dataclass(kw_only=True)
class Faults:
    """Counts of what went wrong.

    Attributes
    ----------
    skipped_updates
        Updates left out because their loss or gradient was not finite, or had exploded.
    undone_rollouts
        Roll-outs after which weights, optimiser and normalisation were put back.
    undone_in_a_row, diverged_in_a_row
        Newest roll-outs that were undone, or in which every episode diverged.
    """

    skipped_updates: int = 0
    undone_rollouts: int = 0
    undone_in_a_row: int = 0
    diverged_in_a_row: int = 0

    @property
    def occurred(self) -> bool:
        """Whether anything went wrong so far."""
        return bool(self.skipped_updates or self.undone_rollouts)

    def to_record(self) -> dict[str, int]:
        """Return the counts that are part of the result."""
        return {
            "skipped_updates": self.skipped_updates,
            "undone_rollouts": self.undone_rollouts,
        }

    def state_dict(self) -> dict[str, int]:
        """Return all counts."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def is_sound_update(loss: torch.Tensor, gradient_norm: torch.Tensor) -> bool:
    """Whether an update may be made: both finite, and the loss not exploded."""
    # NaN fails both comparisons.
    return abs(loss.item()) <= LARGEST_LOSS and gradient_norm.item() < float("inf")


def is_sound_policy(policy: torch.nn.Module) -> bool:
    """Whether all weights are finite, and so is the standard deviation of actions."""
    weights = dict(policy.named_parameters())
    if not all(torch.isfinite(weight).all() for weight in weights.values()):
        return False
    log_std = weights.get("log_std")
    return log_std is None or bool(torch.isfinite(log_std.exp()).all())
