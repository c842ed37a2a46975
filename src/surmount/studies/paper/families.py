"""RSTAR's obstacles with what the paper reports of them beside each run's own results."""

from __future__ import annotations

from typing import Any

from surmount.envs.family import TaskFamily
from surmount.rstar.all_obstacles import AllObstaclesFamily
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.family import ObstacleFamily
from surmount.rstar.shuffled import ShuffledFamily


class PaperFamily(ObstacleFamily):
    """One of RSTAR's obstacles whose page has a section with the paper's numbers."""

    def claims(self, findings: Any) -> tuple[Any, ...]:
        """Return the paper's claims, one by one, with what a run says to each."""
        from surmount.studies.paper.claims import claims_of  # noqa: PLC0415 - SciPy's statistics

        return claims_of(self.name, findings)

    def page_sections(self, results: Any) -> list[Any]:
        """Return the paper's own numbers beside those of a run."""
        from surmount.studies.paper.section import paper_section  # noqa: PLC0415 - draws figures

        section = paper_section(results)
        return [] if section is None else [section]


FAMILIES: dict[str, TaskFamily] = {
    **{name: PaperFamily(obstacle) for name, obstacle in OBSTACLES.items()},
    "shuffled": ShuffledFamily(),
    "all": AllObstaclesFamily(),
}
"""What the entry point ``rstar`` registers, by the name of the obstacle."""
