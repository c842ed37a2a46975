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
from surmount.analysis.fitting import Scaling
from surmount.analysis.groups import Merge
from surmount.analysis.sensitivity import SensitivityRow
from surmount.analysis.stability import Stability
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.configuration import from_record as config_from_record
from surmount.core.configuration import to_record as config_to_record
from surmount.core.curriculum import Curriculum, Group
from surmount.core.errors import InputError
from surmount.core.mixture import Mixture
from surmount.core.records import read_record, write_record

KIND = "surmount analysis"
SCHEMA = 1


@dataclass(frozen=True, kw_only=True, eq=False)
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
    warnings
        Sentences on what a reader must know before trusting the result.
    """

    config: AnalysisConfig
    parameters: tuple[str, ...]
    features: FeatureMap
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
    warnings: tuple[str, ...]

    @property
    def groups(self) -> tuple[Group, ...]:
        """Groups from easy to difficult."""
        return self.curriculum.groups

    @property
    def dendrogram(self) -> Dendrogram:
        """The linkage with its queries."""
        return Dendrogram(links=self.linkage)

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
        if record.get("kind") != KIND or record.get("schema") != SCHEMA:
            raise InputError(
                f"{source} is not an analysis of schema {SCHEMA} (kind {record.get('kind')!r}, "
                f"schema {record.get('schema')!r}).",
                remedy="Give an analysis.json written by this version of Surmount.",
            )
        try:
            analysis = _build(record)
        except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
            raise InputError(
                f"{source} is damaged ({type(error).__name__}: {error}).",
                remedy="Write it again with `surmount analyze`.",
            ) from error
        _check_shapes(analysis, source)
        return analysis

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


def _floats(value: object, ndim: int) -> FloatArray:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != ndim or not np.isfinite(array).all():
        raise ValueError(f"a table of {ndim} axes is malformed")
    return array


def _integers(value: object) -> IntArray:
    array = np.asarray(value)
    if array.ndim != 1 or (array.size and array.dtype.kind != "i"):
        raise ValueError("a list of integers is malformed")
    return array.astype(np.int64)


def _build(record: Mapping[str, Any]) -> Analysis:
    features, cut = record["features"], record["cut"]
    return Analysis(
        config=config_from_record(AnalysisConfig, record["config"]),
        parameters=tuple(record["parameters"]),
        features=FeatureMap(
            logged=tuple(features["logged"]),
            dropped=tuple(features["dropped"]),
            names=tuple(features["names"]),
            centre=_floats(features["centre"], 1),
            matrix=_floats(features["matrix"], 2),
            scaling=Scaling(
                centre=_floats(features["scaling"]["centre"], 1),
                scale=_floats(features["scaling"]["scale"], 1),
            ),
            explained_variance=float(features["explained_variance"]),
        ),
        variants=_floats(record["variants"], 2),
        success_rate=_floats(record["success_rate"], 1),
        n_trials=_integers(record["n_trials"]),
        n_recorded=_integers(record["n_recorded"]),
        stride=_integers(record["stride"]),
        bic_variant=int(record["bic_variant"]),
        bic=None if record["bic"] is None else _curve(record["bic"]),
        bic_per_variant=tuple(_curve(curve) for curve in record["bic_per_variant"]),
        mixtures=tuple(Mixture.from_record(mixture) for mixture in record["mixtures"]),
        distances=_floats(record["distances"], 2),
        linkage=_floats(record["linkage"], 2),
        inconsistency=_floats(record["inconsistency"], 1),
        inconsistency_depth_2=_floats(record["inconsistency_depth_2"], 1),
        cut=Cut(
            method=str(cut["method"]),
            cut_off=float(cut["cut_off"]),
            statistic=_floats(cut["statistic"], 1),
            divided=np.asarray(cut["divided"], dtype=np.bool_),
            labels=_integers(cut["labels"]),
        ),
        merges=tuple(
            Merge(
                members=tuple(merge["members"]),
                into=tuple(merge["into"]),
                height=float(merge["height"]),
                limit=int(merge["limit"]),
            )
            for merge in record["merges"]
        ),
        labels=_integers(record["labels"]),
        curriculum=Curriculum.from_record(record["curriculum"]),
        recorded=_floats(record["recorded"], 2),
        sampled=_floats(record["sampled"], 2),
        stability=None if record["stability"] is None else _stability(record["stability"]),
        sensitivity=tuple(
            SensitivityRow(
                choice=str(row["choice"]),
                value=str(row["value"]),
                n_groups=int(row["n_groups"]),
                agreement=float(row["agreement"]),
            )
            for row in record["sensitivity"]
        ),
        warnings=tuple(str(warning) for warning in record["warnings"]),
    )


def _curve(record: Mapping[str, Any]) -> BICCurve:
    return BICCurve(
        components=tuple(int(value) for value in record["components"]),
        values=tuple(float(value) for value in record["values"]),
        converged=tuple(bool(value) for value in record["converged"]),
        minimum=int(record["minimum"]),
        chosen=int(record["chosen"]),
        plateau=float(record["plateau"]),
    )


def _stability(record: Mapping[str, Any]) -> Stability:
    return Stability(
        replicates=int(record["replicates"]),
        co_membership=_floats(record["co_membership"], 2),
        group_counts=tuple((int(count), float(share)) for count, share in record["group_counts"]),
        same_count=float(record["same_count"]),
        boundaries=_floats(record["boundaries"], 1),
        agreement=float(record["agreement"]),
    )


def _check_shapes(analysis: Analysis, source: str) -> None:
    n = analysis.variants.shape[0]
    wanted: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
        "variants": (analysis.variants.shape, (n, len(analysis.parameters))),
        "success_rate": (analysis.success_rate.shape, (n,)),
        "n_trials": (analysis.n_trials.shape, (n,)),
        "n_recorded": (analysis.n_recorded.shape, (n,)),
        "stride": (analysis.stride.shape, (n,)),
        "mixtures": ((len(analysis.mixtures),), (n,)),
        "distances": (analysis.distances.shape, (n, n)),
        "linkage": (analysis.linkage.shape, (n - 1, 4)),
        "inconsistency": (analysis.inconsistency.shape, (n - 1,)),
        "inconsistency_depth_2": (analysis.inconsistency_depth_2.shape, (n - 1,)),
        "cut.statistic": (analysis.cut.statistic.shape, (n - 1,)),
        "cut.divided": (analysis.cut.divided.shape, (n - 1,)),
        "cut.labels": (analysis.cut.labels.shape, (n,)),
        "labels": (analysis.labels.shape, (n,)),
    }
    bad = [name for name, (found, right) in wanted.items() if found != right]
    in_range = 0 <= analysis.bic_variant < n and set(analysis.labels.tolist()) == set(
        range(len(analysis.groups))
    )
    if bad or not in_range:
        raise InputError(
            f"{source} is damaged: {', '.join(bad) or 'labels'} do not fit {n} variants.",
            remedy="Write it again with `surmount analyze`.",
        )
