"""A family of tasks: environments that differ in one or more task parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from surmount.core.arrays import FloatArray, IntArray
from surmount.envs.vector_env import TaskVectorEnv
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace

USUAL_INITIAL_STEPS = 500_000
"""Learning steps of the initiation, as for two of the paper's three obstacles (III-C)."""


@dataclass(frozen=True, kw_only=True)
class NoSettings:
    """Settings of environments that have none."""


class TaskFamily(ABC):
    """What the protocol needs to know of environments and their task parameters.

    Methods take the family's own settings, an instance of :attr:`settings`; they are part of an
    experiment's configuration, under ``env``.

    Attributes
    ----------
    name
        Under which the registry finds it, for example ``"rstar/step"`` or ``"my_module:make_env"``.
    title
        The same for people.
    settings
        A frozen dataclass with a default for every field.
    initial_steps
        Learning steps of the initiation at the paper's scale.
    calibrated
        What presets change for this family, by dotted keys of the experiment's configuration.
    diverged_remedy
        What to do where training ends because every episode diverges.
    """

    name: str
    title: str
    settings: type[Any] = NoSettings
    initial_steps: int = USUAL_INITIAL_STEPS
    calibrated: Mapping[str, Any] = MappingProxyType({})
    diverged_remedy: str = (
        "A reward or an observation is not finite: `surmount check` says which, of an environment "
        "of your own."
    )

    @abstractmethod
    def space(self, settings: Any) -> TaskSpace:
        """Return the task parameters, their ranges, the variants and what makes them harder."""

    def target(self, settings: Any) -> TaskDistribution | None:
        """Return the tasks that are wanted in the end; ``None`` for the whole range.

        Only teachers that move towards a target use it.
        """
        del settings
        return None

    def published_returns(self) -> Mapping[str, tuple[float, float]]:
        """Return what publications end at on the target tasks, from and to, by teacher.

        The mean discounted return of the policy as it draws its actions.
        """
        return {}

    def difficulty(self, variants: FloatArray) -> FloatArray | None:
        """Return how hard variants are known to be, ``(variant,)``, larger is harder.

        Only an oracle uses it, and only where the parameters do not tell.

        Parameters
        ----------
        variants
            Shape ``(variant, parameter)``.
        """
        del variants
        return None

    def right_groups(self, variants: FloatArray) -> tuple[tuple[str, ...], IntArray] | None:
        """Return what is known of the right grouping; ``None`` where nothing is.

        Parameters
        ----------
        variants
            Shape ``(variant, parameter)``.

        Returns
        -------
        tuple
            Names of the groups, and the group of each variant, ``(variant,)``.
        """
        del variants
        return None

    @abstractmethod
    def fingerprint(self, settings: Any) -> str:
        """Return a hash of what results depend on besides the settings: a model, a source file.

        Results of two fingerprints are never mixed.
        """

    @abstractmethod
    def cap_s(self, settings: Any) -> float:
        """Return the longest time that an episode may take, in s."""

    @abstractmethod
    def training_env(self, settings: Any, num_envs: int) -> TaskVectorEnv:
        """Build environments that begin anew in the step in which their episode ended."""

    @abstractmethod
    def trial_env(self, settings: Any, num_envs: int) -> TaskVectorEnv:
        """Build environments that begin as trials do, and stay as they are when an episode ends."""

    def draw_films(self, run: Path, say: Callable[[str], None]) -> None:
        """Draw films of a run into its folder, where the family knows how to draw itself.

        Parameters
        ----------
        run
            Output folder of a run.
        say
            Told of every film.
        """
        del run, say

    def claims(self, findings: Any) -> Sequence[Any]:
        """Return the claims of a paper on this family, each with what a run says to it.

        Parameters
        ----------
        findings
            Analysis, comparison and outcomes, :class:`surmount.report.evidence.Findings`.

        Returns
        -------
        Sequence
            Of :class:`surmount.report.verdicts.Claim`.
        """
        del findings
        return ()

    def page_sections(self, results: Any) -> Sequence[Any]:
        """Return sections that only this family's page has.

        Parameters
        ----------
        results
            What a run's page is made from, :class:`surmount.report.results.RunResults`.

        Returns
        -------
        Sequence
            Of :class:`surmount.report.document.parts.Section`.
        """
        del results
        return ()
