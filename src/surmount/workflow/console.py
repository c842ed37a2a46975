"""Rich's console for texts of others: control characters are shown instead of obeyed."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from surmount.core.printing import escaped


class SafeConsole(Console):
    """A console that obeys its own control codes and nobody else's."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Render, with every character that acts on a terminal as its number."""
        for segment in super().render(renderable, options):
            if segment.control or escaped(segment.text) == segment.text:
                yield segment
            else:
                yield Segment(escaped(segment.text), segment.style)
