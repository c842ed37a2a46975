"""What a model of Stable-Baselines3's kind holds, as arrays by name: no pickle.

======================  =======================================================================
``policy/…``            weights of the policy
``optimiser/<name>/…``  moments of each optimiser, by parameter
``variable/<name>``     tensors that are learnt beside the policy, such as SAC's entropy weight
``normaliser/…``        running statistics of ``VecNormalize``
======================  =======================================================================
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from typing import Any, cast

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.save_util import recursive_getattr
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecFrameStack, VecNormalize
from stable_baselines3.common.vec_env.stacked_observations import StackedObservations

from surmount.core.errors import InputError
from surmount.learn.snapshot import Tensors

POLICY = "policy"


def take_model(model: BaseAlgorithm) -> Tensors:
    """Return copies of a model's weights, optimisers, variables and running statistics."""
    objects, variables = _learnt(model)
    tensors: Tensors = {}
    for name in objects:
        held = recursive_getattr(model, name)
        if isinstance(held, torch.optim.Optimizer):
            for index, moments in held.state_dict()["state"].items():
                for moment, value in moments.items():
                    tensors[f"optimiser/{name}/{index}/{moment}"] = _array(value)
        else:
            for part, value in held.state_dict().items():
                tensors[f"{name}/{part}"] = _array(value)
    for name in variables:
        value = recursive_getattr(model, name)
        if isinstance(value, torch.Tensor):
            tensors[f"variable/{name}"] = _array(value)
    for name, statistics in _statistics(model.get_vec_normalize_env()):
        for moment in ("mean", "var", "count"):
            tensors[f"normaliser/{name}/{moment}"] = np.array(
                getattr(statistics, moment), dtype=np.float64
            )
    return tensors


def put_model(tensors: Mapping[str, np.ndarray], model: BaseAlgorithm) -> None:
    """Give a model what :func:`take_model` returned.

    Raises
    ------
    InputError
        If it is not what this model holds.
    """
    objects, variables = _learnt(model)
    try:
        for name in objects:
            held = recursive_getattr(model, name)
            if isinstance(held, torch.optim.Optimizer):
                _put_moments(_below(tensors, f"optimiser/{name}/"), held)
            else:
                held.load_state_dict(
                    {part: torch.from_numpy(np.array(value))
                     for part, value in _below(tensors, f"{name}/").items()}
                )  # fmt: skip
        for name in variables:
            value = recursive_getattr(model, name)
            if isinstance(value, torch.Tensor):
                with torch.no_grad():
                    value.copy_(torch.from_numpy(np.array(tensors[f"variable/{name}"])))
        put_statistics(tensors, model.get_vec_normalize_env())
    except (KeyError, RuntimeError, ValueError) as error:
        raise InputError(
            f"The network does not fit the algorithm or the environment ({error}).",
            remedy="Use it with the task and the learner that it was trained with.",
        ) from error


def put_statistics(tensors: Mapping[str, np.ndarray], normaliser: VecNormalize | None) -> None:
    """Give a normaliser the statistics among tensors."""
    for name, statistics in _statistics(normaliser):
        statistics.mean = tensors[f"normaliser/{name}/mean"].copy()
        statistics.var = tensors[f"normaliser/{name}/var"].copy()
        statistics.count = float(tensors[f"normaliser/{name}/count"])


def _learnt(model: Any) -> tuple[list[str], list[str]]:
    """Return the names of what a model saves: objects with a state, and tensors."""
    return model._get_torch_save_params()  # noqa: SLF001 - what `save` keeps


def wrappers(model: BaseAlgorithm) -> list[VecEnvWrapper]:
    """Return what is around a model's environments, the innermost first."""
    found: list[VecEnvWrapper] = []
    env: VecEnv | None = model.get_env()
    while isinstance(env, VecEnvWrapper):
        found.append(env)
        env = env.venv
    return found[::-1]


def loop_state(model: Any) -> dict[str, Any]:
    """Return where a model's loop stands, and all random generators it draws from."""
    state: dict[str, Any] = {
        "steps": model.num_timesteps,
        "updates": getattr(model, "_n_updates", 0),
        "episodes": getattr(model, "_episode_num", 0),
        "calls": getattr(model, "_n_calls", 0),
        "exploration_rate": getattr(model, "exploration_rate", 0.0),
        "last": _held({"observation": model._last_obs}),  # noqa: SLF001
        "layouts": _layouts(model._last_obs),  # noqa: SLF001
        "last_original": _held({"observation": model._last_original_obs}),  # noqa: SLF001
        "last_episode_starts": np.array(model._last_episode_starts),  # noqa: SLF001
        "torch": torch.get_rng_state().numpy(),
        "numpy": _numpy_state(),
        "python": _python_state(),
        "actions": [_generator(space).bit_generator.state for space in _drawing(model)],
        "wrappers": {
            str(index): _wrapper_state(wrapper) for index, wrapper in enumerate(wrappers(model))
        },
    }
    lstm: Any = getattr(model, "_last_lstm_states", None)
    if lstm is not None:
        state["lstm"] = {
            f"{part}-{index}": _array(value)
            for part, pair in (("pi", lstm.pi), ("vf", lstm.vf))
            for index, value in enumerate(pair)
        }
    return state


def load_loop_state(model: Any, state: Mapping[str, Any]) -> None:
    """Go on from a loop state."""
    model.num_timesteps = int(state["steps"])
    for name, key in (("_n_updates", "updates"), ("_episode_num", "episodes"),
                      ("_n_calls", "calls"), ("exploration_rate", "exploration_rate")):  # fmt: skip
        if hasattr(model, name):
            setattr(model, name, state[key])
    last = state["last"].get("observation")
    model._last_obs = _laid_out(last, state["layouts"])  # noqa: SLF001
    model._last_original_obs = state["last_original"].get("observation")  # noqa: SLF001
    model._last_episode_starts = state["last_episode_starts"]  # noqa: SLF001
    for index, wrapper in enumerate(wrappers(model)):
        _load_wrapper(wrapper, state["wrappers"][str(index)])
    if "lstm" in state:
        kept = {name: torch.from_numpy(value).to(model.device)
                for name, value in state["lstm"].items()}  # fmt: skip
        before = model._last_lstm_states  # noqa: SLF001
        model._last_lstm_states = type(before)(  # noqa: SLF001
            *(tuple(kept[f"{part}-{index}"] for index in range(2)) for part in ("pi", "vf"))
        )
    for space, generator in zip(_drawing(model), state["actions"], strict=True):
        _generator(space).bit_generator.state = generator
    torch.set_rng_state(torch.from_numpy(state["torch"]))
    kept = state["numpy"]
    keys = np.asarray(kept["keys"], dtype=np.uint32)
    np.random.set_state(  # noqa: NPY002
        (kept["kind"], keys, kept["position"], kept["has_gauss"], kept["gauss"])
    )
    drawn = state["python"]
    random.setstate((drawn["version"], tuple(drawn["values"]), drawn["after"]))


def _statistics(normaliser: VecNormalize | None) -> Iterator[tuple[str, RunningMeanStd]]:
    if normaliser is None:
        return
    yield "reward", normaliser.ret_rms
    if not normaliser.norm_obs:
        return
    if isinstance(normaliser.obs_rms, dict):
        for name, statistics in normaliser.obs_rms.items():
            yield f"observation/{name}", statistics
    else:
        yield "observation", normaliser.obs_rms


def _put_moments(tensors: Mapping[str, np.ndarray], optimiser: torch.optim.Optimizer) -> None:
    moments: dict[int, dict[str, torch.Tensor]] = {}
    for name, value in tensors.items():
        index, _, moment = name.partition("/")
        moments.setdefault(int(index), {})[moment] = torch.from_numpy(np.array(value))
    optimiser.load_state_dict({**optimiser.state_dict(), "state": moments})


def _below(tensors: Mapping[str, np.ndarray], prefix: str) -> dict[str, np.ndarray]:
    return {
        name.removeprefix(prefix): value
        for name, value in tensors.items()
        if name.startswith(prefix)
    }


def _array(value: Any) -> np.ndarray:
    return torch.as_tensor(value).detach().cpu().numpy().copy()


def _held(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what there is of some values, dictionaries of arrays as they are."""
    return {name: value for name, value in values.items() if value is not None}


def _layouts(observations: Any) -> dict[str, list[int]]:
    """Return the order of axes in memory: the last bits of convolutions depend on it."""
    parts = observations if isinstance(observations, dict) else {"": observations}
    return {
        name: np.argsort(part.strides, kind="stable")[::-1].tolist()
        for name, part in parts.items()
        if isinstance(part, np.ndarray)
    }


def _laid_out(observations: Any, layouts: Mapping[str, list[int]]) -> Any:
    if isinstance(observations, dict):
        return {name: _in_order(part, layouts[name]) for name, part in observations.items()}
    return _in_order(observations, layouts[""])


def _in_order(array: np.ndarray, order: list[int]) -> np.ndarray:
    return np.ascontiguousarray(array.transpose(order)).transpose(np.argsort(order))


def _drawing(model: BaseAlgorithm) -> list[gymnasium.Space[Any]]:
    """Return the spaces that a model draws random actions from."""
    env = model.get_env()
    return [model.action_space, *([] if env is None else [env.action_space])]


def _generator(space: gymnasium.Space[Any]) -> np.random.Generator:
    return space.np_random


def _numpy_state() -> dict[str, Any]:
    kind, keys, position, has_gauss, gauss = np.random.get_state(legacy=True)  # noqa: NPY002
    return {
        "kind": kind,
        "keys": np.asarray(keys).tolist(),
        "position": position,
        "has_gauss": has_gauss,
        "gauss": gauss,
    }


def _python_state() -> dict[str, Any]:
    version, values, after = random.getstate()
    return {"version": version, "values": list(values), "after": after}


def _wrapper_state(wrapper: VecEnvWrapper) -> dict[str, Any]:
    if isinstance(wrapper, VecNormalize):
        return {"returns": wrapper.returns}
    if isinstance(wrapper, VecFrameStack):
        return {"stacked": _stacks(wrapper.stacked_obs)}
    return {}


def _load_wrapper(wrapper: VecEnvWrapper, state: Mapping[str, Any]) -> None:
    if isinstance(wrapper, VecNormalize):
        wrapper.returns = state["returns"]
    elif isinstance(wrapper, VecFrameStack):
        stacks: dict[str, np.ndarray] = state["stacked"]
        for name, part in _stack_parts(wrapper.stacked_obs):
            part.stacked_obs = stacks[name]


def _stacks(stack: StackedObservations[Any]) -> dict[str, np.ndarray]:
    return {name: part.stacked_obs.copy() for name, part in _stack_parts(stack)}


def _stack_parts(stack: Any) -> list[tuple[str, Any]]:
    """Return a stack, or those of a dictionary's entries, by name."""
    parts = cast("dict[str, Any] | None", getattr(stack, "sub_stacked_observations", None))
    return [("all", stack)] if parts is None else list(parts.items())
