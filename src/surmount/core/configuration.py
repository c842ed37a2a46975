"""Frozen configuration dataclasses from and to plain records, with dotted overrides.

A configuration is a tree of frozen dataclasses whose leaves are strings, numbers, booleans, or
tuples of these. This module turns such a tree into a JSON record and back, and applies overrides
such as ``learner.learning_rate = 1e-4`` from a file or the command line. An unknown key is an
error that names the nearest valid one.

**A field that is added later** must not make strangers of the records and of the stages that were
written before it. It says which value they stand for, which need not be its default::

    measure: Literal["step", "episode"] = field(default="episode", metadata=absent("step"))

:func:`from_record` then reads a record that lacks the key as ``"step"``, and :func:`key_record`
leaves the key out where it is ``"step"``: the key of such a stage is what it was. A field without
this declaration takes its default where a record lacks it, and always counts in keys.
"""

from __future__ import annotations

import dataclasses
import difflib
import tomllib
import types
import typing
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar, cast

from surmount.core.errors import ConfigError
from surmount.core.records import canonical_json, parse_json, read_bytes

LARGEST_INTEGER = 2**63
"""Larger ones fit neither a float nor an array, and nobody means them."""
Record = dict[str, Any]


class Arguments(dict[str, Any]):
    """A leaf that is a table of JSON values by name: keyword arguments of somebody else's function.

    In a file it is a table, ``[learner.arguments]``; as a flag and with ``--set`` it is JSON.
    """

    def __hash__(self) -> int:  # type: ignore[override] - configurations are frozen
        return hash(canonical_json(self))


Config = TypeVar("Config")
_ABSENT = "absent"
"""Key of a field's metadata: what a record without the field stands for."""


def absent(value: object) -> Record:
    """Return the metadata of a field that was added later: what its absence from a record means.

    Parameters
    ----------
    value
        What was done before the field was there: a leaf, or a configuration of its own.
    """
    return {_ABSENT: value}


def to_record(config: object) -> Record:
    """Return a configuration as nested dictionaries of JSON values."""
    return cast(Record, _plain(config, whole=True))


def key_record(config: object) -> Record:
    """Return a configuration as keys of stages count it.

    As :func:`to_record`, without the fields that have the value their absence stands for.
    :func:`from_record` builds the same configuration from it.
    """
    return cast(Record, _plain(config, whole=False))


def from_record(cls: type[Config], record: Mapping[str, Any]) -> Config:
    """Build a configuration of class ``cls`` from nested dictionaries.

    Missing keys take what their absence stands for, or else the defaults of the class.

    Raises
    ------
    ConfigError
        If a key is unknown, a value has the wrong type, or the class rejects a value.
    """
    return cast(Config, _build(cls, completed(cls, record), prefix=""))


def completed(cls: type[object], record: Mapping[str, Any]) -> Record:
    """Return a record with those keys that it lacks because they came later, as it meant them."""
    kinds = _fields(cls)
    found = dict(record)
    for field in dataclasses.fields(cast(Any, cls)):
        if field.name not in found and _ABSENT in field.metadata:
            found[field.name] = _plain(field.metadata[_ABSENT], whole=True)
        kind, value = kinds.get(field.name), found.get(field.name)
        if dataclasses.is_dataclass(kind) and isinstance(value, Mapping):
            found[field.name] = completed(cast(type[object], kind), cast(Record, value))
    return found


def override(config: Config, changes: Mapping[str, Any]) -> Config:
    """Return a copy of a configuration with dotted keys changed.

    Parameters
    ----------
    config
        Instance of a configuration dataclass.
    changes
        Dotted keys to values; strings are read as JSON where they are JSON.
    """
    record = to_record(config)
    valid = set(dotted_keys(type(config)))
    tables = _table_keys(type(config))
    for key, value in _gathered(changes, tables).items():
        if key not in valid:
            raise unknown_key(key, valid)
        node = record
        *parents, leaf = key.split(".")
        for parent in parents:
            node = node[parent]
        node[leaf] = _parse(value) if isinstance(value, str) else value
    return from_record(type(config), record)


def read_overrides(path: Path) -> dict[str, Any]:
    """Read overrides from a TOML or JSON file as dotted keys.

    Raises
    ------
    ConfigError
        If the file cannot be read or is not TOML or JSON.
    """
    try:
        text = read_bytes(path).decode("utf-8")
    except (OSError, ValueError) as error:
        raise ConfigError(
            f"The configuration file {path} cannot be read ({error}).",
            remedy="Give the path of a readable TOML or JSON text file.",
        ) from error
    try:
        tree = parse_json(text) if path.suffix == ".json" else tomllib.loads(text)
        flat = dict(_flatten(tree, prefix="")) if isinstance(tree, dict) else None
    except (ValueError, RecursionError) as error:
        raise ConfigError(
            f"The configuration file {path} is not valid ({error}).",
            remedy="Correct the file; JSON files end in .json, all others are read as TOML.",
        ) from error
    if flat is None:
        raise ConfigError(
            f"The configuration file {path} holds no table of keys.",
            remedy="Write keys and values, for example `learner.learning_rate = 1e-4`.",
        )
    return flat


def dotted_keys(cls: type[object]) -> list[str]:
    """Return the dotted keys of all leaves of a configuration class."""
    keys: list[str] = []
    for name, kind in _fields(cls).items():
        if dataclasses.is_dataclass(kind):
            keys += [f"{name}.{key}" for key in dotted_keys(cast(type[object], kind))]
        else:
            keys.append(name)
    return keys


def differences(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the dotted keys on which two records differ, with both values."""
    left, right = dict(_flatten(first, prefix="")), dict(_flatten(second, prefix=""))
    keys = dict.fromkeys([*left, *right])
    return {key: (left.get(key), right.get(key)) for key in keys if left.get(key) != right.get(key)}


def unknown_key(key: str, valid: set[str] | list[str]) -> ConfigError:
    """Return the error for an unknown key, naming the nearest valid one."""
    return ConfigError(f"Unknown configuration key `{key}`.", remedy=nearest(key, sorted(valid)))


def nearest(word: str, choices: list[str]) -> str:
    """Return a sentence that names the choice nearest to a mistyped word."""
    close = difflib.get_close_matches(word, choices, n=1, cutoff=0.0)
    leaf = word.rsplit(".", 1)[-1]
    same_leaf = [choice for choice in choices if choice.rsplit(".", 1)[-1] == leaf]
    best = (same_leaf or close)[:1]
    return f"Did you mean `{best[0]}`?" if best else "There are no valid choices."


def _plain(value: object, *, whole: bool) -> object:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            field.name: _plain(getattr(value, field.name), whole=whole)
            for field in dataclasses.fields(value)
            if whole or not _as_absent(field, getattr(value, field.name))
        }
    if isinstance(value, tuple | list):
        return [_plain(item, whole=whole) for item in cast(tuple[object, ...], value)]
    return value


def _as_absent(field: dataclasses.Field[Any], value: object) -> bool:
    return _ABSENT in field.metadata and value == field.metadata[_ABSENT]


def _fields(cls: type[object]) -> dict[str, Any]:
    hints = typing.get_type_hints(cls)
    return {
        field.name: hints[field.name] for field in dataclasses.fields(cast(Any, cls)) if field.init
    }


def _build(cls: type[object], record: Record, *, prefix: str) -> object:
    kinds = _fields(cls)
    values: Record = {}
    for key, value in record.items():
        if key not in kinds:
            raise unknown_key(prefix + key, [prefix + name for name in dotted_keys(cls)])
        values[key] = _coerce(kinds[key], value, prefix + key)
    missing = [
        prefix + field.name
        for field in dataclasses.fields(cast(Any, cls))
        if field.name not in values
        and field.default is dataclasses.MISSING
        and field.default_factory is dataclasses.MISSING
    ]
    if missing:
        raise ConfigError(
            f"The configuration lacks `{missing[0]}`.", remedy="Give it in the file or by --set."
        )
    return cls(**values)


def _table_keys(cls: type[object]) -> set[str]:
    """Return the dotted keys of the leaves that are tables."""
    keys: set[str] = set()
    for name, kind in _fields(cls).items():
        if dataclasses.is_dataclass(kind):
            keys |= {f"{name}.{key}" for key in _table_keys(cast(type[object], kind))}
        elif Arguments in (kind, *typing.get_args(kind)):
            keys.add(name)
    return keys


def _gathered(changes: Mapping[str, Any], tables: set[str]) -> Record:
    """Put together the tables whose entries were given one by one."""
    found: Record = {}
    for key, value in changes.items():
        table = next((one for one in tables if key.startswith(f"{one}.")), None)
        if table is None:
            found[key] = value
            continue
        node = found.setdefault(table, Arguments())
        *parents, leaf = key.removeprefix(f"{table}.").split(".")
        for parent in parents:
            node = node.setdefault(parent, {})
        node[leaf] = _parse(value) if isinstance(value, str) else value
    return found


def _coerce(kind: Any, value: Any, key: str) -> object:
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if dataclasses.is_dataclass(kind) and isinstance(value, dict):
        return _build(cast(type[object], kind), cast(Record, value), prefix=f"{key}.")
    if kind is Arguments and isinstance(value, Mapping):
        return Arguments(cast(Mapping[str, Any], value))
    if origin is tuple and isinstance(value, list | tuple):
        items = list(cast(tuple[Any, ...], value))
        if len(arguments) == 2 and arguments[1] is Ellipsis:
            return tuple(_coerce(arguments[0], item, key) for item in items)
        if len(items) == len(arguments):
            return tuple(_coerce(k, item, key) for k, item in zip(arguments, items, strict=True))
    if origin is typing.Literal:
        if value in arguments:
            return value
        raise ConfigError(
            f"`{key}` is {value!r}.",
            remedy=f"Choose among {', '.join(repr(choice) for choice in arguments)}.",
        )
    if origin in (types.UnionType, typing.Union):
        return _coerce_union(arguments, value, key)
    if isinstance(value, int) and abs(value) >= LARGEST_INTEGER:
        raise ConfigError(f"`{key}` is too large a number.", remedy="Give one below 2⁶³.")
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if (
        kind is int
        and isinstance(value, float)
        and value.is_integer()
        and (abs(value) < LARGEST_INTEGER)
    ):
        return int(value)  # 5e5 in a file means 500,000
    if kind in (int, bool, str) and type(value) is kind:
        return value
    raise _wrong_type(kind, value, key)


def _coerce_union(arguments: tuple[Any, ...], value: Any, key: str) -> object:
    if value is None and type(None) in arguments:
        return None
    for choice in arguments:
        if choice is type(None):
            continue
        try:
            return _coerce(choice, value, key)
        except ConfigError:
            continue
    raise _wrong_type(arguments, value, key)


def _wrong_type(kind: object, value: object, key: str) -> ConfigError:
    wanted = kind.__name__ if isinstance(kind, type) else str(kind)
    return ConfigError(
        f"`{key}` is {value!r}, which is not of type {wanted}.",
        remedy="Give a value of that type; lists are written [1, 2].",
    )


def _parse(text: str) -> object:
    try:
        return parse_json(text)
    except (ValueError, RecursionError):
        return text


def _flatten(tree: Mapping[str, Any], *, prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, Mapping) and value:  # an empty one is a value: no arguments
            yield from _flatten(cast(Mapping[str, Any], value), prefix=f"{prefix}{key}.")
        else:
            yield prefix + key, value
