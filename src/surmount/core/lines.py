"""Text of several lines that a prompt or a notebook shows as lines."""

from __future__ import annotations


class Lines(str):
    """A text whose representation is itself, so that the last line of a cell can be read."""

    __slots__ = ()

    def __repr__(self) -> str:
        """Return the text."""
        return str(self)
