"""MiniGrid's crossings over the number of walls: a dictionary, with an encoder of one's own.

surmount check crossings:make_env
surmount reproduce crossings:make_env --preset smoke --config crossings.toml --out runs/crossings
"""

import gymnasium
import minigrid  # noqa: F401 - registers its environments
import torch
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

from surmount import TaskEnv, TaskSpace


class Encoder(BaseFeaturesExtractor):
    """Sees kind, colour and state of 7 × 7 fields as numbers, which they are, and the direction."""

    def __init__(self, observation_space, features_dim=64):
        super().__init__(observation_space, features_dim)
        self.fields = torch.nn.Sequential(
            torch.nn.Conv2d(3, 16, 2), torch.nn.ReLU(), torch.nn.Conv2d(16, 16, 2), torch.nn.ReLU(),
            torch.nn.Flatten(),
        )  # fmt: skip
        self.both = torch.nn.Sequential(
            torch.nn.Linear(16 * 5 * 5 + 4, features_dim), torch.nn.ReLU()
        )

    def forward(self, observations):
        """Encode the entries of a batch of observations."""
        fields = self.fields(observations["image"] / 10.0)
        return self.both(torch.cat([fields, observations["direction"].flatten(1)], dim=1))


def set_task(env, task):
    env.num_crossings = task["n_walls"]  # the reset that follows lays the grid


def make_env():
    return TaskEnv(
        gymnasium.make("MiniGrid-SimpleCrossingS9N1-v0", max_episode_steps=60),
        space=TaskSpace.grid(n_walls=[0, 1, 2, 3], harder={"n_walls": 1}),
        set_task=set_task,
        success=lambda transition: transition.reward > 0,
        features={
            "column": lambda transition: transition.env.agent_pos[0],
            "row": lambda transition: transition.env.agent_pos[1],
            "direction": lambda transition: transition.env.agent_dir,
        },
    )
