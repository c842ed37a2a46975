"""What the paper reports, to stand beside a run's own numbers (method section 7).

Success after the initiation and the comparison of both arms are printed in the paper's tables and
text. Which variants its groups hold is not; they were recovered from the numbers of trials and
the χ² values it prints, which the same continuity-corrected test reproduces exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

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
    variants
        Its range, recovered; empty where unknown.
    after_initiation
        Success after the initiation, as printed.
    curriculum, control
        Successes and trials of both arms where the paper prints them.
    chi_square
        Continuity-corrected χ² of these two; ``None`` where not printed.
    verdict
        What the paper says of the difference.
    """

    name: str
    variants: str
    after_initiation: str
    curriculum: tuple[int, int] | None = None
    control: tuple[int, int] | None = None
    chi_square: float | None = None
    verdict: str = "no difference"


@dataclass(frozen=True, kw_only=True)
class PaperResult:
    """The paper's result on one obstacle: groups from easy to difficult, and number of levels."""

    groups: tuple[PaperGroup, ...]
    levels: int
    networks: int = 2


PAPER_RESULTS = {
    "narrow-channel": PaperResult(
        levels=1,
        groups=(
            PaperGroup(name="easy", variants="", after_initiation="100 %"),
            PaperGroup(name="difficult", variants="", after_initiation="40 %"),
        ),
    ),
    "low-entrance": PaperResult(
        levels=1,
        groups=(
            PaperGroup(name="easy", variants="100–140 mm (9)", after_initiation="99 %"),
            PaperGroup(
                name="difficult",
                variants="55–95 mm (9)",
                after_initiation="76 %",
                curriculum=(540, 540),
                control=(512, 540),
                chi_square=26.73,
                verdict="more successes with curriculum",
            ),
        ),
    ),
    "step": PaperResult(
        levels=3,
        groups=(
            PaperGroup(name="easy", variants="21–33 mm (13)", after_initiation="94 %"),
            PaperGroup(
                name="medium",
                variants="34–46 mm (13)",
                after_initiation="19 %",
                curriculum=(779, 780),
                control=(244, 780),
                chi_square=809.76,
                verdict="more successes with curriculum",
            ),
            PaperGroup(
                name="difficult",
                variants="47–50 mm (4)",
                after_initiation="about 0 %",
                curriculum=(239, 240),
                control=(1, 240),
                chi_square=468.07,
                verdict="more successes with curriculum",
            ),
        ),
    ),
}
"""By obstacle."""

SURVIVAL_CLAIM = "sooner with the curriculum in every group (log-rank test, p < 0.05)"
"""What the paper says of completion times on every obstacle."""
