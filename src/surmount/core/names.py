"""Names in files of others: shown on pages and terminals, so they must be text and nothing else."""

from __future__ import annotations

import unicodedata

LONGEST_NAME = 200
"""Characters of a name; more would fill a page."""
_UNFIT = {"Cc", "Cs", "Zl", "Zp"}
"""Control characters, with which a terminal can be made to do things, halves of characters, and
line ends."""
_TURNING = set("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Marks that turn the direction of writing: what is read is then not what is there."""


def is_printable(name: str) -> bool:
    """Whether a name can be printed as it stands."""
    return len(name) <= LONGEST_NAME and not any(
        unicodedata.category(character) in _UNFIT or character in _TURNING for character in name
    )


FORMULA_MARKS = ("=", "+", "-", "@", "\t", "\r")
"""A text that begins so is a formula to spreadsheets, and may run a program."""


def text_cell(text: str) -> str:
    """Return a text for a cell of CSV, as which no spreadsheet takes it for a formula."""
    return f"'{text}" if text.startswith(FORMULA_MARKS) else text
