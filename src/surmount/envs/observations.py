"""Observations of any usual kind: what learners can take, and as plain numbers to compare."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import gymnasium
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError

spaces = gymnasium.spaces
PLAIN = (spaces.Box, spaces.Discrete, spaces.MultiDiscrete, spaces.MultiBinary)
"""Spaces of actions, of observations, and of the entries of dictionaries of observations."""
Space = gymnasium.Space[Any]


def require_usual(observations: Space, actions: Space) -> None:
    """Refuse spaces that no learner behind the seam can take.

    Raises
    ------
    InputError
        If actions are neither numbers nor choices, or observations hold something else than these
        or dictionaries of them.
    """
    if not isinstance(actions, PLAIN):
        raise InputError(
            f"The environment's actions are {actions}.",
            remedy="Let them be a Box, Discrete, MultiDiscrete or MultiBinary: wrap the "
            "environment so that it takes one of these.",
        )
    parts = observations.spaces if isinstance(observations, spaces.Dict) else {"": observations}
    for name, part in parts.items():
        if not isinstance(part, PLAIN):
            where = f"entry `{name}`" if name else "observations"
            raise InputError(
                f"The environment's {where} is {part}."
                if name
                else f"The environment's observations are {part}.",
                remedy="Let observations be a Box, Discrete, MultiDiscrete or MultiBinary, or one "
                "dictionary of these: gymnasium.wrappers.FlattenObservation makes one box of them.",
            )


def is_image(space: Space) -> bool:
    """Whether a space holds pictures: bytes of three dimensions."""
    return isinstance(space, spaces.Box) and len(space.shape) == 3 and space.dtype == np.uint8


def text_entries(space: Space) -> tuple[str, ...]:
    """Return the entries of a dictionary of observations that hold text."""
    if not isinstance(space, spaces.Dict):
        return ()
    return tuple(name for name, part in space.spaces.items() if _is_text(part))


def without_text(space: Space) -> Space:
    """Return a dictionary of observations without its text, which no network reads."""
    text = text_entries(space)
    if not text:
        return space
    assert isinstance(space, spaces.Dict)  # noqa: S101 - only dictionaries have entries
    return spaces.Dict({name: part for name, part in space.spaces.items() if name not in text})


def with_task(space: Space, parameters: int) -> Space:
    """Return the space of observations to which a task of so many numbers is added.

    To a box it is appended, and integers become floats; in a dictionary it is the entry ``task``.

    Raises
    ------
    InputError
        If observations are pictures or choices, or the dictionary has such an entry.
    """
    ends = np.full(parameters, np.inf)  # tasks may be drawn beyond the range
    if isinstance(space, spaces.Dict):
        if "task" in space.spaces:
            raise InputError(
                "The observations have an entry `task` of their own.",
                remedy="Leave `observe_task` out, or give their entry another name.",
            )
        task = spaces.Box(-np.inf, np.inf, (parameters,), np.float32)
        return spaces.Dict({**space.spaces, "task": task})
    if not isinstance(space, spaces.Box) or is_image(space):
        kind = "pictures" if is_image(space) else str(space)
        raise InputError(
            f"A task cannot be appended to observations of {kind}.",
            remedy="Leave `observe_task` out, or let observations be a one-dimensional box, or a "
            "dictionary with the picture as one entry.",
        )
    dtype = _float_kind(space)
    return spaces.Box(
        np.concatenate([space.low.ravel(), -ends]).astype(dtype),
        np.concatenate([space.high.ravel(), ends]).astype(dtype),
        dtype=dtype,
    )


def add_task(observation: Any, place: FloatArray, space: Space) -> Any:
    """Return an observation with a task added, in the space that :func:`with_task` gave."""
    if isinstance(space, spaces.Dict):
        return {**observation, "task": place.astype(np.float32)}
    whole = np.empty(space.shape or (), dtype=space.dtype)
    whole[: -len(place)] = np.ravel(observation)
    whole[-len(place) :] = place
    return whole


def is_finite(observation: Any) -> bool:
    """Whether all numbers of an observation are finite."""
    if isinstance(observation, np.ndarray):  # nearly always, and at every step
        return observation.dtype.kind != "f" or bool(np.isfinite(observation).all())
    if isinstance(observation, Mapping):
        return all(map(is_finite, cast("Mapping[Any, Any]", observation).values()))
    if isinstance(observation, tuple | list):
        return all(map(is_finite, cast("Sequence[Any]", observation)))
    array = np.asarray(observation)
    return array.dtype.kind != "f" or bool(np.isfinite(array).all())


def numbers(observation: Any) -> FloatArray:
    """Return all numbers of an observation in a fixed order, shape ``(number,)``; text is left out.

    To compare observations.
    """
    if isinstance(observation, Mapping):
        named = cast("Mapping[Any, Any]", observation)
        return _joined([named[name] for name in sorted(named, key=str)])
    if isinstance(observation, tuple | list):
        return _joined(list(cast("Sequence[Any]", observation)))
    array = np.asarray(observation)
    if array.dtype.kind not in "biuf":
        return np.empty(0)
    return array.astype(np.float64).ravel()


def stacked(observations: Sequence[Any], space: Space) -> Any:
    """Return observations of several environments as one, row by row; dictionaries by entry."""
    if isinstance(space, spaces.Dict):
        return {
            name: np.array([np.asarray(one[name], dtype=part.dtype) for one in observations])
            for name, part in space.spaces.items()
        }
    return np.array([np.asarray(one) for one in observations])


def row(observations: Any, index: int) -> Any:
    """Return one environment's part of :func:`stacked` observations."""
    if isinstance(observations, Mapping):
        named = cast("Mapping[str, Any]", observations)
        return {name: values[index] for name, values in named.items()}
    return observations[index]


def _joined(parts: Sequence[Any]) -> FloatArray:
    return np.concatenate([numbers(part) for part in parts]) if parts else np.empty(0)


def _float_kind(space: gymnasium.spaces.Box) -> Any:
    """Return the space's own type where it is a float, else single precision."""
    kind = space.dtype
    return kind.type if kind.kind == "f" else np.float32


def _is_text(space: Space) -> bool:
    """Whether a space holds text: Gymnasium's own, or another whose samples are strings."""
    if isinstance(space, spaces.Text):
        return True
    known = (*PLAIN, spaces.Dict, spaces.Tuple, spaces.Sequence, spaces.Graph, spaces.OneOf)
    return not isinstance(space, known) and isinstance(space.sample(), str)
