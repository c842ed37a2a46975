"""Section: films of the hardest variant, and of the one on which the arms differ most."""

from __future__ import annotations

from surmount.report.document.parts import Block, Film, Films, Paragraph, Section
from surmount.report.document.text import listed
from surmount.report.films import FilmedTrial
from surmount.workflow.run_layout import CONTROL, CURRICULUM, INITIATION

WORDS = {
    INITIATION: "After the initiation",
    CURRICULUM: "With the curriculum",
    CONTROL: "Without it",
}


def film_section(filmed: tuple[FilmedTrial, ...]) -> Section | None:
    """Show the films, variant by variant; ``None`` where there are none."""
    if not filmed:
        return None
    variants = dict.fromkeys(film.variant for film in filmed)
    blocks: list[Block] = []
    for variant in variants:
        alike = tuple(film for film in filmed if film.variant == variant)
        blocks += [_introduction(alike), Films(films=tuple(_film(film) for film in alike))]
    return Section(anchor="films", title="To look at", blocks=tuple(blocks))


def _introduction(filmed: tuple[FilmedTrial, ...]) -> Paragraph:
    first, kinds = filmed[0], listed([WORDS[film.kind].lower() for film in filmed])
    chosen = f" {first.choice}" if first.choice else ""
    return Paragraph(text=f"{first.variant}, {kinds}: {first.rule}, {_speeds(filmed)}.{chosen}")


def _film(film: FilmedTrial) -> Film:
    return Film(
        title=WORDS[film.kind],
        caption=(
            f"{film.outcome[:1].upper()}{film.outcome[1:]}.",
            f"This network succeeded in {film.successes} of {film.trials} trials of it.",
            f"Shown: {film.caption}.",
        ),
        mp4=film.mp4,
        png=film.png,
    )


def _speeds(filmed: tuple[FilmedTrial, ...]) -> str:
    slowest, fastest = (f"{extreme(film.speed for film in filmed):.2g}" for extreme in (min, max))
    span = slowest if slowest == fastest else f"{slowest} to {fastest}"
    return f"at {span} times real speed"
