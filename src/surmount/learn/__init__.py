"""PPO through Stable-Baselines3, roll-outs and checkpoints."""

from surmount.learn.callback import TeacherCallback
from surmount.learn.config import LearnerConfig
from surmount.learn.history import History
from surmount.learn.recorder import TaskVectorEnv
from surmount.learn.rollouts import Actor, RolloutConfig, roll_out
from surmount.learn.snapshot import TRAINED_ON, Snapshot, acting_only
from surmount.learn.trainer import Checkpointing, Trainer, Training

__all__ = [
    "TRAINED_ON",
    "Actor",
    "Checkpointing",
    "History",
    "LearnerConfig",
    "RolloutConfig",
    "Snapshot",
    "TaskVectorEnv",
    "TeacherCallback",
    "Trainer",
    "Training",
    "acting_only",
    "roll_out",
]
