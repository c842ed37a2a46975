"""One's own environment: the contract, many of them as one, and a check of the contract."""

from surmount.own.batch import TaskBatch
from surmount.own.check import Finding, check_contract
from surmount.own.loading import is_own, load_make_env, source_hash
from surmount.own.making import make_task_env, time_limit
from surmount.own.task_env import Moment, TaskEnv, UntoldSuccessError

__all__ = [
    "Finding",
    "Moment",
    "TaskBatch",
    "TaskEnv",
    "UntoldSuccessError",
    "check_contract",
    "is_own",
    "load_make_env",
    "make_task_env",
    "source_hash",
    "time_limit",
]
