"""PPO through Stable-Baselines3 or like ML-Agents', roll-outs and checkpoints."""

from surmount.learn.callback import TeacherCallback
from surmount.learn.config import LearnerConfig
from surmount.learn.history import History
from surmount.learn.noise import CorrelatedNoise
from surmount.learn.presets import LEARNERS, ML_AGENTS, learner_preset, ml_agents_learner
from surmount.learn.rollouts import Actor, RolloutConfig, roll_out
from surmount.learn.snapshot import TRAINED_ON, Snapshot, acting_only
from surmount.learn.task_env import TaskVectorEnv
from surmount.learn.trainer import Checkpointing, Trainer, Training

__all__ = [
    "LEARNERS",
    "ML_AGENTS",
    "TRAINED_ON",
    "Actor",
    "Checkpointing",
    "CorrelatedNoise",
    "History",
    "LearnerConfig",
    "RolloutConfig",
    "Snapshot",
    "TaskVectorEnv",
    "TeacherCallback",
    "Trainer",
    "Training",
    "acting_only",
    "learner_preset",
    "ml_agents_learner",
    "roll_out",
]
