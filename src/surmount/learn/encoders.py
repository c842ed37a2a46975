"""An encoder for pictures that are too small for that of Stable-Baselines3."""

from __future__ import annotations

from typing import Any

import gymnasium
import torch
from stable_baselines3.common.preprocessing import get_flattened_obs_dim, is_image_space
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

SMALLEST_FOR_NATURE = 36
"""Pixels of a side below which ``NatureCNN`` has nothing left to convolve."""


def smallest_picture(space: gymnasium.Space[Any]) -> int | None:
    """Return the shortest side of the pictures among observations, None where there are none."""
    parts = space.spaces.values() if isinstance(space, gymnasium.spaces.Dict) else [space]
    sides = [
        sorted(part.shape)[-2]  # of height, width and channels, the smallest are the channels
        for part in parts
        if isinstance(part, gymnasium.spaces.Box) and is_image_space(part)
    ]
    return min(sides, default=None)


class SmallPictures(BaseFeaturesExtractor):
    """Three small convolutions for pictures, such as MiniGrid's 7 x 7; numbers pass through.

    Parameters
    ----------
    observation_space
        A picture, channels first, or a dictionary with pictures among its entries.
    channels
        Of the three layers, each of 2 x 2 pixels.
    """

    def __init__(
        self, observation_space: gymnasium.Space[Any], channels: tuple[int, int, int] = (16, 32, 64)
    ) -> None:
        parts: dict[str, Any] = (
            dict(observation_space.spaces)
            if isinstance(observation_space, gymnasium.spaces.Dict)
            else {"": observation_space}
        )
        encoders: dict[str, torch.nn.Module] = {}
        width = 0
        for name, part in parts.items():
            if is_image_space(part):
                encoders[name] = _convolutions(part.shape[0], channels)
                width += encoders[name](torch.zeros(1, *part.shape)).shape[1]
            else:
                encoders[name] = torch.nn.Flatten()
                width += get_flattened_obs_dim(part)
        super().__init__(observation_space, width)
        self._names = tuple(parts)
        self.encoders = torch.nn.ModuleList(encoders[name] for name in self._names)

    def forward(self, observations: Any) -> torch.Tensor:
        """Return all entries' features side by side, ``(row, feature)``."""
        if isinstance(observations, torch.Tensor):
            return self.encoders[0](observations)
        named = zip(self._names, self.encoders, strict=True)
        return torch.cat([encoder(observations[name]) for name, encoder in named], dim=1)


def _convolutions(inputs: int, channels: tuple[int, int, int]) -> torch.nn.Module:
    first, second, third = channels
    return torch.nn.Sequential(
        torch.nn.Conv2d(inputs, first, 2),
        torch.nn.ReLU(),
        torch.nn.Conv2d(first, second, 2),
        torch.nn.ReLU(),
        torch.nn.Conv2d(second, third, 2),
        torch.nn.ReLU(),
        torch.nn.Flatten(),
    )
