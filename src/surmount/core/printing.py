"""The one place that prints: control characters are shown instead of obeyed, messages are cut."""

from __future__ import annotations

import re
import sys
from typing import TextIO

LONGEST_MESSAGE = 1000
"""Characters of an error as it is printed, its remedy included."""
_LONGEST_REMEDY = 400
_ACTING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""Control characters but for tabulators and line ends, marks that turn the direction of writing,
halves of characters."""


def escaped(text: str) -> str:
    """Return a text with every character that acts on a terminal as its number in a backslash."""
    return _ACTING.sub(_number, text)


def _number(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


def message_of(text: str, most: int = LONGEST_MESSAGE) -> str:
    """Return a message on one line, without characters that act on a terminal, and not too long."""
    line = escaped(" ".join(text[: 2 * most].split()))
    return line if len(line) <= most else line[: most - 1] + "…"


def say(*lines: str, file: TextIO | None = None) -> None:
    """Print lines."""
    print(escaped("\n".join(lines)), file=file, flush=file is not None)


def complain(message: str, remedy: str) -> None:
    """Print what is wrong, and what to do about it, to standard error."""
    what = message_of(remedy, _LONGEST_REMEDY)
    say(f"surmount: {message_of(message, LONGEST_MESSAGE - len(what))}", what, file=sys.stderr)
