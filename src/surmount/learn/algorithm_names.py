"""Names of the algorithms of Stable-Baselines3 and sb3-contrib, known without importing them."""

from __future__ import annotations

from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError

ON_POLICY = ("A2C", "PPO", "RecurrentPPO", "TRPO")
"""Algorithms with roll-outs, whose critic estimates advantages."""
OFF_POLICY = ("CrossQ", "DDPG", "DQN", "QRDQN", "SAC", "TD3", "TQC")
"""Algorithms that learn from a buffer of past experience."""
CONTRIB = ("CrossQ", "QRDQN", "RecurrentPPO", "TQC", "TRPO")
"""Of these, what sb3-contrib has."""
NAMES = tuple(sorted((*ON_POLICY, *OFF_POLICY)))


def is_function(algorithm: str) -> bool:
    """Whether an algorithm is a function of the user's."""
    return ":" in algorithm


def check_name(algorithm: str) -> None:
    """Refuse a name that no algorithm has.

    Raises
    ------
    ConfigError
        If there is none.
    """
    if not is_function(algorithm) and algorithm not in NAMES:
        raise ConfigError(
            f"There is no algorithm `{algorithm}`.",
            remedy=f"{nearest(algorithm, ['auto', 'ppo', *NAMES])} There are auto, ppo "
            f"(Surmount's own), {', '.join(NAMES)}, and my_module:make_model.",
        )
