"""Errors a user can act on: one sentence that says what is wrong and one that says what to do."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar


class SurmountError(Exception):
    """Base of every error that Surmount raises on purpose.

    Parameters
    ----------
    message
        One sentence: what is wrong, with the offending value and, where there is one, the file.
    remedy
        One sentence: what the user can do about it.
    """

    exit_code: ClassVar[int] = 1
    """Exit code of the command line when this error ends it."""

    def __init__(self, message: str, *, remedy: str) -> None:
        super().__init__(message)
        self.message = message
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.message} {self.remedy}"

    def __reduce__(self) -> tuple[Callable[..., SurmountError], tuple[object, ...]]:
        """Let the error cross from a worker process to the one that reports it."""
        return _rebuild, (type(self), self.message, self.remedy)


def _rebuild(kind: type[SurmountError], message: str, remedy: str) -> SurmountError:
    return kind(message, remedy=remedy)


class ConfigError(SurmountError):
    """A configuration, preset or option is unknown or out of range."""

    exit_code = 2


class InputError(SurmountError):
    """A file or array given by the user cannot be used."""

    exit_code = 3


class OutputError(SurmountError):
    """The output folder cannot be used: unwritable, full, locked or made by something else."""

    exit_code = 4


class IntegrityError(SurmountError):
    """A stored artefact does not have the content that its hash promises."""

    exit_code = 5


class MissingExtraError(SurmountError, ImportError):
    """An optional dependency is not installed; an `ImportError` too, as importing may raise it."""

    exit_code = 6


class LearningError(SurmountError):
    """Training cannot go on: a NaN policy, an exploding loss, a physics that keeps diverging."""

    exit_code = 7


def cause(error: BaseException) -> str:
    """Return the kind of an error and, where it has one, its sentence."""
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
