"""Docstrings as Markdown: roles and literal blocks of reStructuredText turned."""

from __future__ import annotations

import re
from typing import Any

import griffe

_ROLE = re.compile(r":(?:class|func|meth|attr|data|mod|exc):`~?([^`]+)`")
_LITERAL = re.compile(r"^( *)::$", flags=re.MULTILINE)


class Roles(griffe.Extension):
    """Turns all docstrings of a package."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Turn them once the package is read."""
        self._turn(pkg)

    def _turn(self, one: griffe.Object) -> None:
        if one.docstring:
            value = _ROLE.sub(lambda found: f"`{_short(found.group(1))}`", one.docstring.value)
            one.docstring.value = _LITERAL.sub("", value)
        for member in one.members.values():
            if isinstance(member, griffe.Object):
                self._turn(member)


def _short(name: str) -> str:
    return name.rpartition(".")[2] if name.startswith("surmount.") else name
