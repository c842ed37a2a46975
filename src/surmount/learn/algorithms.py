"""Algorithms of Stable-Baselines3 and sb3-contrib by name, or a model by a function of the user's.

Keyword arguments come from a configuration, as JSON values. What is no JSON value in Python is
written so:

=========================  ====================================================================
a class of one's own       ``"my_module:MyExtractor"``; a module, optimiser, buffer, noise or
                           policy, also of PyTorch: ``"torch.nn:ReLU"``
``replay_buffer_class``    ``"HerReplayBuffer"``, or a class of one's own
``action_noise``           ``{"NormalActionNoise": {"sigma": 0.1}}``, or
                           ``{"OrnsteinUhlenbeckActionNoise": {"sigma": 0.1}}``: one value for all
                           actions or one for each
a schedule                 ``"linear_3e-4"`` falls from this to 0 over ``learner.decay_steps``
=========================  ====================================================================
"""

from __future__ import annotations

import importlib
import inspect
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import gymnasium
import numpy as np
import torch
from stable_baselines3 import HerReplayBuffer
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import BaseBuffer
from stable_baselines3.common.noise import (
    ActionNoise,
    NormalActionNoise,
    OrnsteinUhlenbeckActionNoise,
)
from stable_baselines3.common.vec_env import VecEnv

from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError, MissingExtraError, SurmountError, cause
from surmount.envs.observations import is_image
from surmount.learn.algorithm_names import CONTRIB, check_name, is_function
from surmount.learn.encoders import SMALLEST_FOR_NATURE, SmallPictures, smallest_picture

GIVEN = ("env", "seed", "tensorboard_log", "verbose")
"""Arguments that Surmount gives itself, or has no use for."""
NOISES: Mapping[str, Any] = MappingProxyType(
    {
        "NormalActionNoise": NormalActionNoise,
        "OrnsteinUhlenbeckActionNoise": OrnsteinUhlenbeckActionNoise,
    }
)
BUFFERS: Mapping[str, type[BaseBuffer]] = MappingProxyType({"HerReplayBuffer": HerReplayBuffer})
CLASSES = (torch.nn.Module, torch.optim.Optimizer, BaseBuffer, ActionNoise)
"""What a class named in arguments may be: nothing else is called with them."""
_CLASS = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")
_LINEAR = re.compile(r"linear_([\d.]+(?:e-?\d+)?)")


def build_model(
    algorithm: str, arguments: Mapping[str, Any], env: VecEnv, *, seed: int
) -> BaseAlgorithm:
    """Return a new model on environments.

    Parameters
    ----------
    algorithm
        A name, or ``module:function``, which is called with the environments.
    arguments
        Keyword arguments of a named algorithm, as JSON values.
    env
        Environments.
    seed
        Of weights, exploration, batches and environments.

    Raises
    ------
    ConfigError
        If there is no such algorithm, it does not take the arguments, or cannot learn in such
        environments.
    MissingExtraError
        If sb3-contrib is asked for and not installed.
    """
    check_name(algorithm)
    if is_function(algorithm):
        return _model_of_function(algorithm, env, seed)
    made = algorithm_class(algorithm)
    chosen = dict(arguments)
    _check_arguments(algorithm, made, chosen)
    policy = chosen.pop("policy", None) or usual_policy(algorithm, env.observation_space)
    _check_policy(policy, env.observation_space)
    resolved = {key: _resolved(key, value, env.action_space) for key, value in chosen.items()}
    _choose_encoder(resolved, policy, env.observation_space)
    try:
        return made(policy=_resolved("policy", policy, None), env=env, seed=seed, **resolved)
    except SurmountError:
        raise
    except Exception as error:  # its assertions, and whatever its classes raise
        raise ConfigError(
            f"{algorithm} cannot learn here ({cause(error)}).",
            remedy="Choose another `learner.algorithm`, or correct `learner.arguments`; "
            f"observations are {env.observation_space}, actions {env.action_space}.",
        ) from error


def algorithm_class(name: str) -> type[BaseAlgorithm]:
    """Return the class of a name.

    Raises
    ------
    MissingExtraError
        If sb3-contrib is asked for and not installed.
    """
    module = "sb3_contrib" if name in CONTRIB else "stable_baselines3"
    try:
        return getattr(importlib.import_module(module), name)
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            f"The algorithm {name} is of sb3-contrib, which is not installed.",
            remedy="Install it with: pip install 'surmount[contrib]'",
        ) from error


def usual_policy(algorithm: str, observations: gymnasium.Space[Any]) -> str:
    """Return the policy for observations of a kind: of numbers, pictures or dictionaries."""
    if isinstance(observations, gymnasium.spaces.Dict):
        kind = "MultiInput"
    else:
        kind = "Cnn" if is_image(observations) else "Mlp"
    return f"{kind}{'LstmPolicy' if algorithm == 'RecurrentPPO' else 'Policy'}"


def loaded(name: str, what: str) -> Any:
    """Return what ``module:name`` stands for.

    Raises
    ------
    ConfigError
        If there is no such thing, or its module fails.
    """
    module, _, attribute = name.partition(":")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)  # workers inherit it
    try:
        return getattr(importlib.import_module(module), attribute)
    except (Exception, SystemExit) as error:
        raise ConfigError(
            f"{what} `{name}` cannot be loaded ({cause(error)}).",
            remedy=f"Let `python -c 'from {module} import {attribute}'` work first, in the folder "
            "in which you call Surmount.",
        ) from error


def _model_of_function(name: str, env: VecEnv, seed: int) -> BaseAlgorithm:
    torch.manual_seed(seed)
    make_model = loaded(name, "The function")
    try:
        model = make_model(env)
    except SurmountError:
        raise
    except Exception as error:  # it is the user's: whatever it raises is told
        raise ConfigError(
            f"`{name}` fails ({cause(error)}).",
            remedy="Let it take the vector environment and return a model of "
            "Stable-Baselines3's kind.",
        ) from error
    policy: object = getattr(model, "policy", None)
    if not isinstance(model, BaseAlgorithm) or not isinstance(policy, torch.nn.Module):
        raise ConfigError(
            f"`{name}` returned {type(model).__name__}, which is no algorithm of "
            "Stable-Baselines3's kind with a policy of PyTorch.",
            remedy="Return a model such as stable_baselines3.PPO, or a subclass of your own.",
        )
    if not any(True for _ in policy.parameters()):  # as SBX's, whose weights are JAX's
        raise ConfigError(
            f"The policy of `{name}`, {type(policy).__name__}, has no weights of PyTorch: they "
            "could be neither saved nor tried.",
            remedy="Return a model whose policy learns in PyTorch; of SBX (JAX), take the "
            "algorithm of the same name in Stable-Baselines3 or sb3-contrib.",
        )
    if model.seed is not None:
        raise ConfigError(
            f"`{name}` gives its model a seed, {model.seed}: all networks would be alike.",
            remedy="Leave `seed` out; Surmount seeds every network by itself.",
        )
    return model


def _check_arguments(algorithm: str, made: type[Any], arguments: Mapping[str, Any]) -> None:
    known = [name for name in inspect.signature(made).parameters if name not in GIVEN]
    for name in arguments:
        if name in GIVEN:
            raise ConfigError(
                f"`learner.arguments.{name}` is given by Surmount.", remedy="Leave it out."
            )
        if name not in known:
            raise ConfigError(f"{algorithm} has no argument `{name}`.", remedy=nearest(name, known))


def _check_policy(policy: str, observations: gymnasium.Space[Any]) -> None:
    if policy.startswith("Mlp") and is_image(observations):
        raise ConfigError(
            f"{policy} would take pictures of {observations.shape} as a flat vector.",
            remedy=f'Leave `policy` out, or give "{policy.replace("Mlp", "Cnn")}".',
        )


def _choose_encoder(
    arguments: dict[str, Any], policy: str, observations: gymnasium.Space[Any]
) -> None:
    """Give pictures that are too small for Stable-Baselines3's encoder one that takes them."""
    smallest = smallest_picture(observations)
    if smallest is None or smallest >= SMALLEST_FOR_NATURE or policy.startswith("Mlp"):
        return
    more = dict(arguments.get("policy_kwargs") or {})
    more.setdefault("features_extractor_class", SmallPictures)
    arguments["policy_kwargs"] = more


def _resolved(key: str, value: Any, actions: gymnasium.Space[Any] | None) -> Any:
    """Return the Python value that a JSON value stands for."""
    if key == "action_noise" and isinstance(value, Mapping):
        return _noise(cast("Mapping[str, Any]", value), actions)
    if isinstance(value, Mapping):
        table = cast("Mapping[str, Any]", value)
        return {name: _resolved(name, one, actions) for name, one in table.items()}
    if not isinstance(value, str):
        return value
    if value in BUFFERS:
        return BUFFERS[value]
    if linear := _LINEAR.fullmatch(value):
        return LinearSchedule(float(linear[1]))
    if not _CLASS.fullmatch(value):
        return value
    found = loaded(value, f"`learner.arguments`: `{key}`")
    if not (inspect.isclass(found) and issubclass(found, CLASSES)):
        raise ConfigError(
            f"`{value}` of `learner.arguments` is no class of PyTorch's or Stable-Baselines3's "
            "kind.",
            remedy="Name a module, optimiser, buffer, noise or policy; for everything else, write "
            'a function and give it as `learner.algorithm = "my_module:make_model"`.',
        )
    return found


class LinearSchedule:
    """Falls from a value to 0 while training goes on.

    Parameters
    ----------
    value
        At the beginning.
    """

    def __init__(self, value: float) -> None:
        self.value = value

    def __call__(self, remaining: float) -> float:
        """Return the value while this share of training remains."""
        return remaining * self.value


def _noise(told: Mapping[str, Any], actions: gymnasium.Space[Any] | None) -> ActionNoise:
    (name, arguments), *rest = told.items() or (("", {}),)
    if rest or name not in NOISES:
        raise ConfigError(
            f"`learner.arguments.action_noise` is {dict(told)}.",
            remedy='Write it as {"NormalActionNoise": {"sigma": 0.1}}, or with '
            "OrnsteinUhlenbeckActionNoise.",
        )
    shape = (actions.shape if actions is not None else None) or (1,)
    chosen = dict(arguments)
    sigma = np.broadcast_to(np.asarray(chosen.pop("sigma", 0.1), dtype=np.float64), shape)
    mean = np.broadcast_to(np.asarray(chosen.pop("mean", 0.0), dtype=np.float64), shape)
    make: Callable[..., ActionNoise] = NOISES[name]
    return make(mean.copy(), sigma.copy(), **chosen)
