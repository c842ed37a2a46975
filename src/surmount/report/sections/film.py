"""Section: a hard variant in films, before, with and without the curriculum."""

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
    intro = Paragraph(text=f"{filmed[0].variant}, {kinds}: {filmed[0].rule}, {_speeds(filmed)}.")
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


def _speeds(filmed: tuple[FilmedTrial, ...]) -> str:
    slowest, fastest = (f"{extreme(film.speed for film in filmed):.2g}" for extreme in (min, max))
    span = slowest if slowest == fastest else f"{slowest} to {fastest}"
    return f"at {span} times real speed"
