"""What the paper reports, to stand beside results of our own (method section 7).

Success after the initiation and the comparison of both arms are printed in the paper's tables and
text. Which variants its groups hold is not; they were recovered from the numbers of trials and
the χ² values it prints, which the same continuity-corrected test reproduces exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

from surmount.core.arrays import BoolArray, FloatArray

SOURCE = (
    "“Automatic Curriculum Determination for Deep Reinforcement Learning in Reconfigurable "
    "Robots”, IEEE Access, 2024"
)


@dataclass(frozen=True, kw_only=True)
class PaperGroup:
    """One group of variants in the paper.

    Attributes
    ----------
    name
        As the paper calls it.
    range_mm
        Its smallest and largest variant.
    recovered
        Whether the range follows from the paper's own numbers; otherwise it is assumed.
    after_initiation
        Success after the initiation, as printed (table 1).
    curriculum, control
        Successes and trials of both arms where the paper prints them.
    chi_square
        Continuity-corrected χ² of these two; ``None`` where not printed.
    more_successes
        Whether the paper finds more successes with the curriculum; otherwise no difference.
    """

    name: str
    range_mm: tuple[float, float]
    recovered: bool
    after_initiation: float
    curriculum: tuple[int, int] | None = None
    control: tuple[int, int] | None = None
    chi_square: float | None = None
    more_successes: bool = False

    def holds(self, sizes_mm: FloatArray) -> BoolArray:
        """Return which sizes belong to the group."""
        low, high = self.range_mm
        return (sizes_mm >= low) & (sizes_mm <= high)


@dataclass(frozen=True, kw_only=True)
class PaperResult:
    """The paper's result on one obstacle.

    Attributes
    ----------
    groups
        From easy to difficult.
    levels, networks
        Number of levels, and of networks per arm.
    first_level_steps
        Learning steps in all after which the first level ended; ``None`` where not told.
    successes
        Success of both arms in all groups together, as the paper says it.
    """

    groups: tuple[PaperGroup, ...]
    levels: int
    networks: int = 2
    first_level_steps: int | None = None
    successes: str | None = None


PAPER_RESULTS = {
    "narrow-channel": PaperResult(
        levels=1,
        successes="no difference (about 1800 / 1800)",
        groups=(
            PaperGroup(name="easy", range_mm=(260.0, 320.0), recovered=False, after_initiation=1.0),
            PaperGroup(
                name="difficult", range_mm=(180.0, 250.0), recovered=False, after_initiation=0.40
            ),
        ),
    ),
    "low-entrance": PaperResult(
        levels=1,
        groups=(
            PaperGroup(name="easy", range_mm=(100.0, 140.0), recovered=True, after_initiation=0.99),
            PaperGroup(
                name="difficult",
                range_mm=(55.0, 95.0),
                recovered=True,
                after_initiation=0.76,
                curriculum=(540, 540),
                control=(512, 540),
                chi_square=26.73,
                more_successes=True,
            ),
        ),
    ),
    "step": PaperResult(
        levels=3,
        first_level_steps=1_800_000,
        groups=(
            PaperGroup(name="easy", range_mm=(21.0, 33.0), recovered=True, after_initiation=0.94),
            PaperGroup(
                name="medium",
                range_mm=(34.0, 46.0),
                recovered=True,
                after_initiation=0.19,
                curriculum=(779, 780),
                control=(244, 780),
                chi_square=809.76,
                more_successes=True,
            ),
            PaperGroup(
                name="difficult",
                range_mm=(47.0, 50.0),
                recovered=True,
                after_initiation=0.0,
                curriculum=(239, 240),
                control=(1, 240),
                chi_square=468.07,
                more_successes=True,
            ),
        ),
    ),
}
"""By obstacle. The channel's ranges cannot be recovered: they are taken to divide at the start
pose's width (248 mm), as the entrance's divide at its height (94.5 mm)."""

SURVIVAL_CLAIM = "sooner with the curriculum in every group (log-rank test, p < 0.05)"
"""What the paper says of completion times on every obstacle."""


def paper_result(task: str) -> PaperResult | None:
    """Return what the paper reports of one of RSTAR's tasks, ``None`` of any other."""
    return None if ":" in task else PAPER_RESULTS.get(task.removeprefix("rstar/"))
