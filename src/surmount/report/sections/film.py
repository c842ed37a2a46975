"""Section: the hardest variant in films, before, with and without the curriculum."""

from __future__ import annotations

from surmount.report.document.parts import Film, Films, Paragraph, Section
from surmount.report.document.text import listed
from surmount.report.films import FilmedTrial
from surmount.workflow.run_layout import CONTROL, CURRICULUM, INITIATION

WORDS = {
    INITIATION: "After the initiation",
    CURRICULUM: "With the curriculum",
    CONTROL: "Without it",
}


def film_section(filmed: tuple[FilmedTrial, ...]) -> Section | None:
    """Show the films; ``None`` where there are none."""
    if not filmed:
        return None
    kinds = listed([WORDS[film.kind].lower() for film in filmed])
    intro = Paragraph(
        text=f"The hardest variant, {filmed[0].size_mm:g} mm, {kinds}: always the first trial of "
        f"the first network, whatever happened in it, at {filmed[0].speed:g} times real speed."
    )
    films = Films(
        films=tuple(
            Film(
                title=WORDS[film.kind],
                caption=(
                    f"{film.outcome[:1].upper()}{film.outcome[1:]}.",
                    f"This network succeeded in {film.successes} of {film.trials} trials of it.",
                    f"Shown: {film.caption}.",
                ),
                mp4=film.mp4,
                png=film.png,
            )
            for film in filmed
        )
    )
    return Section(anchor="films", title="To look at", blocks=(intro, films))
