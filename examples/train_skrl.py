"""PPO of skrl on the batched courses: nine robots stepped in one call.

python examples/train_skrl.py
"""

import gymnasium
import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import DeterministicMixin, GaussianMixin, Model
from skrl.trainers.torch import SequentialTrainer

import surmount.rstar  # noqa: F401  (registers the courses)


def network(inputs, outputs):
    hidden = [torch.nn.Linear(inputs, 64), torch.nn.Tanh(), torch.nn.Linear(64, 64)]
    return torch.nn.Sequential(*hidden, torch.nn.Tanh(), torch.nn.Linear(64, outputs))


class Policy(GaussianMixin, Model):
    """Normal actions with a spread of their own."""

    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        GaussianMixin.__init__(self)
        self.net = network(self.num_observations, self.num_actions)
        self.log_std = torch.nn.Parameter(torch.zeros(self.num_actions))

    def compute(self, inputs, role):  # noqa: ARG002
        """Return mean and spread."""
        return self.net(inputs["observations"]), {"log_std": self.log_std}


class Value(DeterministicMixin, Model):
    """Value of a state."""

    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        DeterministicMixin.__init__(self)
        self.net = network(self.num_observations, 1)

    def compute(self, inputs, role):  # noqa: ARG002
        """Return the value."""
        return self.net(inputs["observations"]), {}


def main(steps=200_000, num_envs=9, rollouts=256):
    torch.manual_seed(0)
    env = wrap_env(
        gymnasium.make_vec(
            "surmount/LowEntrance-v0", num_envs=num_envs, vectorization_mode="vector_entry_point"
        ),
        verbose=False,
    )
    spaces = {
        "observation_space": env.observation_space,
        "action_space": env.action_space,
        "device": env.device,
    }
    agent = PPO(
        models={"policy": Policy(**spaces), "value": Value(**spaces)},
        memory=RandomMemory(memory_size=rollouts, num_envs=num_envs, device=env.device),
        cfg=PPO_CFG(
            rollouts=rollouts,
            learning_epochs=8,
            mini_batches=4,
            learning_rate=3e-4,
            experiment={"write_interval": 0, "checkpoint_interval": 0},
        ),
        **spaces,
    )
    trainer = SequentialTrainer(
        cfg={
            "timesteps": steps // num_envs,
            "headless": True,
            "disable_progressbar": None,
            "close_environment_at_exit": False,
        },
        env=env,
        agents=agent,
    )
    trainer.train()
    env.close()
    return agent


if __name__ == "__main__":
    main()
