"""Which variant is filmed beside the hardest: the one on which the arms differ most."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.report.document.text import percent
from surmount.report.outcomes import read_outcomes
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import ARMS, CONTROL, CURRICULUM, TRIALS, per_network

TITLE = "The variant on which the arms differ most"
ALIKE = 1e-9
"""Differences of success that are no more than this apart are equal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ArmsApart:
    """The variant on which both arms' success in the tests is furthest apart.

    Attributes
    ----------
    variant
        Shape ``(parameter,)``.
    curriculum, control
        Mean success of the arms on it, over networks.
    """

    variant: FloatArray
    curriculum: float
    control: float

    @property
    def rule(self) -> str:
        """Return how it was chosen, as a sentence for the page."""
        return (
            "Chosen by the largest difference in mean success over networks between the arms in "
            f"the tests ({percent(self.curriculum)} with the curriculum, {percent(self.control)} "
            "without it), of equals the hardest."
        )

    def is_on(self, variant: FloatArray) -> bool:
        """Whether it is a given variant, ``(parameter,)``."""
        return bool(np.allclose(self.variant, variant))


@dataclass(frozen=True, kw_only=True, eq=False)
class Shown:
    """A variant to film, ``(parameter,)``.

    Attributes
    ----------
    variant
        Which one.
    title, choice
        What it is called, and why it is shown; the latter empty where the title says so.
    kinds
        Of which networks, by what they had learnt.
    is_second
        Whether it is the one beside that which is shown of all networks.
    """

    variant: FloatArray
    title: str
    choice: str
    kinds: tuple[str, ...]
    is_second: bool


def shown_variants(
    first: FloatArray, title: str, apart: ArmsApart | None, told: Callable[[FloatArray], str]
) -> list[Shown]:
    """Return one variant of all networks, and of both arms where they differ most, if elsewhere.

    Parameters
    ----------
    first, title
        The variant that is shown of all, ``(parameter,)``, and what it is called.
    apart
        Where the arms differ most, if that is known.
    told
        Says a variant, ``(parameter,)``, in words.
    """
    is_first = apart is not None and apart.is_on(first)
    choice = "On it the arms differ most, too." if is_first else ""
    shown = [Shown(variant=first, title=title, choice=choice, kinds=(*TRIALS,), is_second=False)]
    if apart is not None and not is_first:
        title = f"{TITLE}, {told(apart.variant)}"
        shown.append(
            Shown(variant=apart.variant, title=title, choice=apart.rule, kinds=ARMS, is_second=True)
        )
    return shown


def arms_apart(
    run: RunFolder, networks: int, difficulty: Callable[[FloatArray], FloatArray]
) -> ArmsApart | None:
    """Return where the arms differ most; ``None`` before all tests, and where they never differ.

    Parameters
    ----------
    run
        The run.
    networks
        Of the run; the tests of all must be finished.
    difficulty
        Returns how hard variants of shape ``(variant, parameter)`` are, shape ``(variant,)``.
    """
    stages = {
        arm: [per_network(TRIALS[arm], network) for network in range(networks)] for arm in ARMS
    }
    if not all(name in run.stages for names in stages.values() for name in names):
        return None
    found = {
        arm: read_outcomes(run.stages[name] for name in names) for arm, names in stages.items()
    }
    variants = np.unique(found[CURRICULUM].variant, axis=0)
    curriculum, control = (found[arm].scores().mean(axis=0) for arm in (CURRICULUM, CONTROL))
    index = most_apart(curriculum - control, difficulty(variants))
    if index is None:
        return None
    return ArmsApart(
        variant=variants[index],
        curriculum=float(curriculum[index]),
        control=float(control[index]),
    )


def most_apart(differences: FloatArray, difficulty: FloatArray) -> int | None:
    """Return the index of the largest difference, of equals the hardest, of these the last.

    Parameters
    ----------
    differences
        Of both arms' mean success, whichever is ahead, shape ``(variant,)``.
    difficulty
        Shape ``(variant,)``.

    Returns
    -------
    int or None
        ``None`` where no variant tells the arms apart.
    """
    sizes = np.abs(differences)
    if sizes.max() <= ALIKE:
        return None
    tied = np.flatnonzero(sizes >= sizes.max() - ALIKE)
    hardest = difficulty[tied] == difficulty[tied].max()
    return int(tied[hardest][-1])
