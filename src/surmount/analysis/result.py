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
from surmount.analysis.features import FeatureMap
from surmount.analysis.groups import Merge
from surmount.analysis.mixture import Mixture
from surmount.analysis.reference import DistanceCheck
from surmount.analysis.result_reading import KIND, SCHEMA, analysis_fields
from surmount.analysis.sensitivity import SensitivityRow
from surmount.analysis.stability import Stability
from surmount.analysis.suspects import Suspect
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.configuration import to_record as config_to_record
from surmount.core.records import read_record, write_record
from surmount.tasks.curriculum import Curriculum, Group

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

    @property
    def groups(self) -> tuple[Group, ...]:
        """Groups from easy to difficult."""
        return self.curriculum.groups

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
