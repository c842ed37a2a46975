"""Small trainings by algorithms of Stable-Baselines3, and trials of what they learnt."""

from __future__ import annotations

from any_spaces import make_walk

from surmount.core.configuration import override
from surmount.envs.batch import TaskBatch
from surmount.learn.choice import make_actor
from surmount.learn.config import LearnerConfig
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import roll_out
from surmount.learn.trainer import Trainer
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import SilentMonitor

SPACE = make_walk().space
ON = {"n_steps": 16, "batch_size": 16, "n_epochs": 2, "policy_kwargs": {"net_arch": [16]}}
OFF = {
    "learning_starts": 32,
    "batch_size": 16,
    "buffer_size": 1000,
    "policy_kwargs": {"net_arch": [16]},
}
LSTM = ON | {"policy_kwargs": {"net_arch": [16], "lstm_hidden_size": 8}}
NOISE = {"action_noise": {"NormalActionNoise": {"sigma": 0.2}}}
HER = {"replay_buffer_class": "HerReplayBuffer", "learning_starts": 100}
CASES = {
    "auto-discrete": ("auto", {}, ("discrete", "box"), {}),
    "auto-multidiscrete-dict": ("auto", {}, ("multidiscrete", "dict"), {}),
    "auto-multibinary": ("auto", {}, ("multibinary", "discrete"), {}),
    "ppo-normalised": ("PPO", ON, ("box", "box"), {"vec_normalize": {}}),
    "ppo-stacked-pictures": ("PPO", ON, ("discrete", "image"), {"frame_stack": 4}),
    "a2c": ("A2C", {"n_steps": 8}, ("discrete", "dict"), {}),
    "dqn": ("DQN", OFF, ("discrete", "box"), {"frame_stack": 3}),
    "sac": ("SAC", OFF, ("box", "box"), {"vec_normalize": {}}),
    "sac-her": ("SAC", OFF | HER, ("box", "goal"), {}),
    "td3-noise": ("TD3", OFF | NOISE, ("box", "box"), {}),
    "recurrent": ("RecurrentPPO", LSTM, ("discrete", "box"), {}),
    "tqc": ("TQC", OFF, ("box", "box"), {}),
    "qrdqn": ("QRDQN", OFF, ("discrete", "dict"), {}),
}
CONTRIB = ("recurrent", "tqc", "qrdqn")


def config_of(algorithm, arguments, more=None, **changes):
    base = {"num_envs": 4, "rollout_steps": 16}
    if algorithm in ("auto", "ppo"):
        base |= {"batch_size": 32}
    if algorithm == "auto":
        base |= {"hidden_layers": [16]}
    chosen = {"algorithm": algorithm, "arguments": arguments, **(more or {}), **changes}
    return override(LearnerConfig(), base | chosen)


def trainer(config, spaces, *, steps=256, seed=1, start=None, memory=None):
    return Trainer(
        TaskBatch(lambda: make_walk(*spaces), 4),
        UniformTeacher(SPACE.whole_range, steps),
        config,
        seed=seed,
        start=start,
        memory=memory,
    )


def tried(network, spaces, *, deterministic=False, seed=3):
    env = TaskBatch(lambda: make_walk(*spaces), 6, autoreset=False)
    actor = make_actor(network, env.single_observation_space, env.single_action_space)
    return roll_out(
        env,
        actor,
        SPACE.variants,
        RolloutConfig(repetitions=2, deterministic=deterministic),
        network=0,
        seed=seed,
        monitor=SilentMonitor(),
    )
