"""One's own environment: the contract, many of them as one, and a check of the contract."""

from surmount.envs.batch import TaskBatch
from surmount.envs.check import Finding, check_contract
from surmount.envs.loading import is_own, load_make_env, source_hash
from surmount.envs.making import make_task_env, time_limit
from surmount.envs.task_env import TaskEnv, Transition, UntoldSuccessError

__all__ = [
    "Finding",
    "TaskBatch",
    "TaskEnv",
    "Transition",
    "UntoldSuccessError",
    "check_contract",
    "is_own",
    "load_make_env",
    "make_task_env",
    "source_hash",
    "time_limit",
]
