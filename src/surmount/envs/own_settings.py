"""Settings that every environment of one's own has: what its task parameters are."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import get_args

from surmount.core.axis import AxisKind
from surmount.core.configuration import absent
from surmount.core.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class OwnSettings:
    """Kinds of axes, for parameters of which the environment says something else, or nothing."""

    continuous: tuple[str, ...] = field(default=(), metadata=absent(()))
    """Task parameters that are continuous although their values were given as whole numbers."""

    logarithmic: tuple[str, ...] = field(default=(), metadata=absent(()))
    """Task parameters that are positive and even in their logarithm."""

    integer: tuple[str, ...] = field(default=(), metadata=absent(()))
    """Task parameters that are whole numbers; the environment gets an int."""

    categorical: tuple[str, ...] = field(default=(), metadata=absent(()))
    """Task parameters whose numbers are names without distances; the environment gets text."""

    def __post_init__(self) -> None:
        kinds: tuple[AxisKind, ...] = get_args(AxisKind)
        named = Counter(name for kind in kinds for name in getattr(self, kind))
        twice = [name for name, count in named.items() if count > 1]
        if twice:
            raise ConfigError(
                f"`{twice[0]}` is named twice among the kinds of axes.",
                remedy="Name each task parameter in one of them.",
            )

    @property
    def kinds(self) -> dict[str, AxisKind]:
        """The kind of axis of each task parameter that is named."""
        kinds: tuple[AxisKind, ...] = get_args(AxisKind)
        return {name: kind for kind in kinds for name in getattr(self, kind)}
