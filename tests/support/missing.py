"""A package that is as if not installed, for the length of one test."""

from __future__ import annotations

import sys

import pytest


def take_away(monkeypatch: pytest.MonkeyPatch, package: str, *importers: str) -> None:
    """Let a package be missing for modules of these names and below, which are imported anew.

    Afterwards all is as before: in ``sys.modules`` and as attributes of packages, of which an
    import anew replaces both.
    """
    for name in sorted(sys.modules):
        if any(name == importer or name.startswith(f"{importer}.") for importer in importers):
            parent, _, child = name.rpartition(".")
            if hasattr(sys.modules.get(parent), child):
                monkeypatch.setattr(sys.modules[parent], child, sys.modules[name])
    for name in sorted(sys.modules, reverse=True):
        if any(name == importer or name.startswith(f"{importer}.") for importer in importers):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
