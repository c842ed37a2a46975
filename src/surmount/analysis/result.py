"""The result of an analysis: a curriculum with every number that led to it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from surmount.analysis.component_count import BICCurve
from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.cut import Cut
from surmount.analysis.dendrogram import Dendrogram
from surmount.analysis.features import FeatureMap, describe_variant
from surmount.analysis.groups import Merge
from surmount.analysis.mixture import Mixture
from surmount.analysis.reference import DistanceCheck
from surmount.analysis.result_reading import KIND, SCHEMA, analysis_fields
from surmount.analysis.sensitivity import SensitivityRow
from surmount.analysis.stability import Stability
from surmount.analysis.suspects import Suspect
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.axis import Axes
from surmount.core.configuration import to_record as config_to_record
from surmount.core.drawing import Chart, chart, drawn
from surmount.core.lines import Lines
from surmount.core.records import read_record, write_record
from surmount.tasks.curriculum import Curriculum, Group
from surmount.trials.trials import Trials

_SHOWN_NAMES = 12


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Analysis:
    """Everything from trials to curriculum, in the order of the method.

    Axis ``variant`` always means :attr:`variants`, in ascending order.

    Attributes
    ----------
    config
        The choices made.
    parameters
        Names of the task parameters with their units.
    features
        How logged features became the features of the mixtures.
    n_networks
        Networks whose trials these are.
    network_names
        Name of each; empty where networks have numbers only.
    variants
        Shape ``(variant, parameter)``.
    success_rate
        Mean success over the trials of all networks, shape ``(variant,)``.
    n_trials, n_recorded, stride
        Trials, logged control steps, and every how many of these steps one was used,
        shape ``(variant,)``.
    bic_variant
        Index of the variant on which the number of components was chosen.
    bic
        Its BIC curve (fig. 5); ``None`` where the number was given.
    bic_per_variant
        BIC curves of all variants where each chose its own number, else empty.
    mixtures
        One per variant, over ``features.names`` in these features' units.
    distances
        Unscented Hellinger distances (eq. 1), shape ``(variant, variant)``.
    check
        The distances beside a reference with error bars; ``None`` where this was not asked for.
    linkage
        SciPy's linkage matrix, shape ``(link, 4)`` (fig. 6).
    inconsistency
        Inconsistency coefficient of each link over the configured depth, shape ``(link,)``.
    inconsistency_depth_2
        The same over the customary depth 2.
    cut
        Which links divide, and why.
    merges
        Small groups merged into their neighbours, in this order.
    labels
        Index into :attr:`groups` of each variant, shape ``(variant,)``.
    curriculum
        Groups and levels.
    recorded, sampled
        Samples of the variant ``bic_variant``, and as many drawn from its mixture, to see the fit
        (fig. 5); shape ``(sample, feature)``.
    stability
        How sure the grouping is; ``None`` where the bootstrap was switched off.
    sensitivity
        The grouping with one choice changed at a time; empty where it was switched off.
    suspects
        Features that may not be behaviour, with the grouping without them.
    notes
        How the trials were read, where somebody must know it, in sentences.
    warnings
        Sentences on what a reader must know before trusting the result.
    """

    config: AnalysisConfig
    parameters: tuple[str, ...]
    features: FeatureMap
    n_networks: int
    network_names: tuple[str, ...]
    variants: FloatArray
    success_rate: FloatArray
    n_trials: IntArray
    n_recorded: IntArray
    stride: IntArray
    bic_variant: int
    bic: BICCurve | None
    bic_per_variant: tuple[BICCurve, ...]
    mixtures: tuple[Mixture, ...]
    distances: FloatArray
    check: DistanceCheck | None
    linkage: FloatArray
    inconsistency: FloatArray
    inconsistency_depth_2: FloatArray
    cut: Cut
    merges: tuple[Merge, ...]
    labels: IntArray
    curriculum: Curriculum
    recorded: FloatArray
    sampled: FloatArray
    stability: Stability | None
    sensitivity: tuple[SensitivityRow, ...]
    suspects: tuple[Suspect, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        """Return groups, levels and the verdict in a few lines; all numbers are in the fields."""
        from surmount.analysis.showing import text_of  # noqa: PLC0415 - which needs this class

        return text_of(self)

    def _repr_html_(self) -> str:
        """Return the same for a notebook."""
        from surmount.analysis.showing import html_of  # noqa: PLC0415 - which needs this class

        return html_of(self)

    def plot_dendrogram(self) -> Chart:
        """Draw how the variants join, their groups, and the cut (fig. 6).

        This and the methods below return Altair charts: a notebook shows them, ``save("a.svg")``
        writes them. They need the extra ``report``; without it a ``MissingExtraError`` says so.
        """
        return chart("dendrogram", self)

    def plot_distances(self) -> Chart:
        """Draw the Hellinger distances of every two variants, with the groups framed (fig. 6)."""
        return chart("distances", self)

    def plot_success(self) -> Chart:
        """Draw success on each variant, with boundaries of the bootstrap where there was one."""
        return chart("success", self)

    def plot_stability(self) -> Chart:
        """Draw how often every two variants were in one group when trials were drawn again.

        Raises
        ------
        InputError
            If the bootstrap was switched off.
        """
        return chart("stability", self)

    def plot_fit(self, variant: float | str | None = None, trials: Trials | None = None) -> Chart:
        """Draw features recorded on a variant beside features drawn from its mixture (fig. 5).

        Parameters
        ----------
        variant
            As :attr:`labels_of_variants` writes it; the one on which K was chosen where absent.
        trials
            Those of the analysis. It keeps recorded points of one variant, the one on which K was
            chosen: of others, without these trials, points of the mixture alone are drawn.

        Raises
        ------
        InputError
            If there is no such variant, or the trials are others.
        """
        return chart("fit", self, variant, trials)

    def explain(self) -> Lines:
        """Walk the evidence from trials to levels, in lines; see :func:`explain_analysis`."""
        from surmount.analysis.explanation import explain_analysis  # noqa: PLC0415 - as above

        return Lines("\n".join(explain_analysis(self)))

    def report(self, folder: Path | str) -> Path:
        """Write a page with everything above, and return where it is.

        See :func:`write_analysis_report`.
        """
        page: Path = drawn("report", self, Path(folder))
        return page

    @property
    def groups(self) -> tuple[Group, ...]:
        """Groups from easy to difficult."""
        return self.curriculum.groups

    @property
    def axes(self) -> Axes:
        """One per task parameter."""
        return self.curriculum.axes

    @property
    def in_a_row(self) -> bool:
        """Whether variants have neighbours: one task parameter, and no categories."""
        return len(self.parameters) == 1 and not self.axes[0].categorical

    def label(self, index: int | np.integer) -> str:
        """Return a variant as people write it: ``180``, ``flat`` or ``(180, 0.7)``."""
        return describe_variant(self.variants[index], self.axes)

    @property
    def labels_of_variants(self) -> list[str]:
        """All variants as people write them."""
        return [self.label(index) for index in range(len(self.variants))]

    @property
    def dendrogram(self) -> Dendrogram:
        """The linkage with its queries."""
        return Dendrogram(links=self.linkage)

    @property
    def trials_won(self) -> IntArray:
        """Successful trials of each variant, shape ``(variant,)``."""
        return np.rint(self.success_rate * self.n_trials).astype(np.int64)

    @property
    def networks(self) -> str:
        """How many networks there are, with the first names where they have names."""
        count = f"{self.n_networks} network{'' if self.n_networks == 1 else 's'}"
        if not self.network_names:
            return count
        more = ", …" if len(self.network_names) > _SHOWN_NAMES else ""
        return f"{count} ({', '.join(self.network_names[:_SHOWN_NAMES])}{more})"

    @property
    def not_converged(self) -> int:
        """Number of mixtures whose fit did not converge."""
        return sum(not mixture.converged for mixture in self.mixtures)

    @property
    def collapsed(self) -> int:
        """Number of components removed in all fits together."""
        return sum(mixture.fit.collapsed for mixture in self.mixtures if mixture.fit)

    def to_record(self) -> dict[str, Any]:
        """Return the JSON form."""
        record: dict[str, Any] = {"kind": KIND, "schema": SCHEMA}
        for field in dataclasses.fields(self):
            record[field.name] = _plain(getattr(self, field.name))
        return record

    @classmethod
    def from_record(
        cls, record: Mapping[str, Any], *, source: str = "The analysis record"
    ) -> Analysis:
        """Build from the JSON form.

        Raises
        ------
        InputError
            If the record is not an analysis of this schema, or is damaged.
        """
        return cls(**analysis_fields(cls, record, source))

    def save(self, path: Path | str) -> None:
        """Write the analysis as one JSON file, whole or not at all."""
        write_record(Path(path), self.to_record())

    @classmethod
    def load(cls, path: Path | str) -> Analysis:
        """Read an analysis written by :meth:`save`."""
        return cls.from_record(read_record(Path(path)), source=str(path))


def _plain(value: object) -> object:
    if isinstance(value, AnalysisConfig):
        return config_to_record(value)
    if isinstance(value, Mixture | Curriculum):
        return value.to_record()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple | list):
        return [_plain(item) for item in cast(tuple[object, ...], value)]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)
        }
    return value
