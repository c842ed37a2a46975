"""Gradients of PPO's loss in closed form are those of autograd, for every form of the loss."""

from __future__ import annotations

import itertools

import pytest
import torch

from surmount.learn.update import Batch, Objective, ppo_loss

ROWS, ACTIONS = 64, 3
FORMS = list(itertools.product((False, True), repeat=4))


@pytest.mark.parametrize(("per_action", "clip_values", "mean_entropy", "normalised"), FORMS)
def test_gradients_are_those_of_autograd(per_action, clip_values, mean_entropy, normalised):
    generator = torch.Generator().manual_seed(0)

    def draw(*shape: int) -> torch.Tensor:
        return torch.randn(*shape, generator=generator, dtype=torch.float64)

    means, values, log_std = draw(ROWS, ACTIONS), draw(ROWS), 0.3 * draw(ACTIONS)
    actions = means + log_std.exp() * draw(ROWS, ACTIONS)
    peer = torch.distributions.Normal(means, log_std.exp()).log_prob(actions)
    batch = Batch(
        observations=draw(ROWS, 2),
        actions=actions,
        # Ratios on both sides of the clipping range and within it.
        log_probs=(peer if per_action else peer.sum(dim=1))
        + 0.3 * draw(*peer.shape[: 1 + per_action]),
        values=values + 0.3 * draw(ROWS),
        advantages=draw(ROWS),
        returns=draw(ROWS),
    )
    objective = Objective(
        clip_range=0.2,
        entropy_coefficient=0.01,
        value_coefficient=0.5,
        normalise_advantages=normalised,
        mean_entropy=mean_entropy,
        clip_values=clip_values,
    )
    given = [one.clone().requires_grad_() for one in (means, values, log_std)]
    loss, slopes = ppo_loss(*given, batch, objective)
    assert 0.1 < loss.clip_fraction.item() < 0.9
    expected = torch.autograd.grad(loss.total, given)
    for found, gradient in zip(
        (slopes.means, slopes.values, slopes.log_std), expected, strict=True
    ):
        torch.testing.assert_close(found, gradient, rtol=1e-9, atol=1e-12)
