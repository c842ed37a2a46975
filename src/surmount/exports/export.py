"""What an export consists of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Export:
    """Files, and what they cannot say.

    Attributes
    ----------
    files
        Text by file name.
    notes
        Sentences on how to use them, and on what the format cannot express.
    """

    files: Mapping[str, str]
    notes: tuple[str, ...]
