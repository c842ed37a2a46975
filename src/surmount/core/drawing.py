"""The door to pictures: what draws is found by its name when it is asked for (ADR 90).

Analysis and curricula need no plotting package, and the rooms they are in import none. Their
``plot`` methods call what draws, which lies above them, through here, as programs find the packages
that bring tasks.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Protocol, cast

from surmount.core.extras import missing_extra

DRAWING = "surmount.report.plots"
"""The module whose functions draw."""


class Chart(Protocol):
    """A picture: an Altair chart, which a notebook shows and Altair's functions change further."""

    def save(self, fp: str, format: Any = None) -> None:  # noqa: A002 - Altair's name
        """Write it to a file: ``.svg``, ``.png``, ``.html`` or ``.json`` by its name."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """Return its Vega-Lite specification."""
        ...

    def show(self) -> None:
        """Open it in a browser or notebook."""
        ...


def drawn(what: str, *arguments: object) -> Any:
    """Return what a function of the drawing module makes of some arguments.

    Raises
    ------
    MissingExtraError
        If the extra ``report`` is not installed.
    """
    try:
        draw = getattr(import_module(DRAWING), what)
        return draw(*arguments)
    except ModuleNotFoundError as error:
        known = missing_extra(error)
        if known is None:
            raise
        raise known from error


def chart(what: str, *arguments: object) -> Chart:
    """Return a chart by the name of the function that draws it; see :func:`drawn`."""
    return cast(Chart, drawn(what, *arguments))
