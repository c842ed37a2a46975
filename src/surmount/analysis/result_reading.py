"""Reading an analysis from its JSON form: every part checked, so that no later step stumbles."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from scipy.cluster import hierarchy

from surmount.analysis.component_count import BICCurve
from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.cut import Cut
from surmount.analysis.features import FeatureMap
from surmount.analysis.fitting import Scaling
from surmount.analysis.groups import Merge
from surmount.analysis.mixture import Mixture
from surmount.analysis.reference import DistanceCheck
from surmount.analysis.sensitivity import SensitivityRow
from surmount.analysis.stability import Stability
from surmount.analysis.suspects import Suspect
from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.configuration import from_record
from surmount.core.errors import InputError, SurmountError
from surmount.tasks.curriculum import Curriculum

KIND = "surmount analysis"
SCHEMA = 2
_REMEDY = "Write it again with `surmount analyze`."
Part = TypeVar("Part")


def read_fields(record: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return the fields of an :class:`surmount.analysis.result.Analysis`.

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
        json.dumps(record, allow_nan=False)
        fields = _fields(record)
        problem = _mismatch(fields)
    except SurmountError as error:
        raise InputError(f"{source} is damaged: {error.message}", remedy=_REMEDY) from error
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError) as error:
        raise InputError(
            f"{source} is damaged ({type(error).__name__}: {error}).", remedy=_REMEDY
        ) from error
    if problem:
        raise InputError(f"{source} is damaged: {problem}.", remedy=_REMEDY)
    return fields


def _distances(values: Any) -> FloatArray:
    """Return Hellinger distances, which lie between 0 and 1."""
    distances = _floats(values, 2)
    if not ((distances >= 0.0) & (distances <= 1.0)).all():
        raise ValueError("a distance lies outside 0 to 1")
    return distances


def _fields(record: Mapping[str, Any]) -> dict[str, Any]:
    features, cut = record["features"], record["cut"]
    return {
        "config": from_record(AnalysisConfig, record["config"]),
        "parameters": _texts(record["parameters"]),
        "features": FeatureMap(
            logged=_texts(features["logged"]),
            dropped=_texts(features["dropped"]),
            names=_texts(features["names"]),
            centre=_floats(features["centre"], 1),
            matrix=_floats(features["matrix"], 2),
            scaling=Scaling(
                centre=_floats(features["scaling"]["centre"], 1),
                scale=_floats(features["scaling"]["scale"], 1),
            ),
            explained_variance=float(features["explained_variance"]),
        ),
        "n_networks": _integer(record["n_networks"]),
        "network_names": _texts(record.get("network_names", [])),
        "variants": _floats(record["variants"], 2),
        "success_rate": _floats(record["success_rate"], 1),
        "n_trials": _integers(record["n_trials"]),
        "n_recorded": _integers(record["n_recorded"]),
        "stride": _integers(record["stride"]),
        "bic_variant": _integer(record["bic_variant"]),
        "bic": None if record["bic"] is None else _curve(record["bic"]),
        "bic_per_variant": tuple(_curve(curve) for curve in record["bic_per_variant"]),
        "mixtures": tuple(Mixture.from_record(mixture) for mixture in record["mixtures"]),
        "distances": _distances(record["distances"]),
        "check": None if record["check"] is None else _check(record["check"]),
        "linkage": _floats(record["linkage"], 2),
        "inconsistency": _floats(record["inconsistency"], 1),
        "inconsistency_depth_2": _floats(record["inconsistency_depth_2"], 1),
        "cut": Cut(
            method=_text(cut["method"]),
            cut_off=float(cut["cut_off"]),
            statistic=_floats(cut["statistic"], 1),
            divided=_switches(cut["divided"]),
            labels=_integers(cut["labels"]),
        ),
        "merges": tuple(_part(Merge, merge) for merge in record["merges"]),
        "labels": _integers(record["labels"]),
        "curriculum": Curriculum.from_record(record["curriculum"]),
        "recorded": _floats(record["recorded"], 2),
        "sampled": _floats(record["sampled"], 2),
        "stability": None if record["stability"] is None else _stability(record["stability"]),
        "sensitivity": tuple(_part(SensitivityRow, row) for row in record["sensitivity"]),
        "suspects": tuple(_part(Suspect, one) for one in record.get("suspects", [])),
        "notes": _texts(record.get("notes", [])),
        "warnings": _texts(record["warnings"]),
    }


def _part(cls: type[Part], record: Any) -> Part:
    if not isinstance(record, Mapping):
        raise TypeError(f"a {cls.__name__} is malformed")
    return from_record(cls, record)


def _curve(record: Any) -> BICCurve:
    curve = _part(BICCurve, record)
    sizes = {len(curve.components), len(curve.values), len(curve.converged)}
    if len(sizes) != 1 or not {curve.minimum, curve.chosen} <= set(curve.components):
        raise ValueError("a BIC curve is malformed")
    return curve


def _check(record: Mapping[str, Any]) -> DistanceCheck:
    return DistanceCheck(
        reference=_floats(record["reference"], 2),
        standard_error=_floats(record["standard_error"], 2),
    )


def _stability(record: Mapping[str, Any]) -> Stability:
    counts = tuple((_integer(count), float(share)) for count, share in record["group_counts"])
    return Stability(
        replicates=_integer(record["replicates"]),
        co_membership=_floats(record["co_membership"], 2),
        group_counts=counts,
        same_count=float(record["same_count"]),
        boundaries=_floats(record["boundaries"], 1),
        agreement=float(record["agreement"]),
    )


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is no text")
    return value


def _texts(value: Any) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise TypeError("a list of texts is malformed")
    return tuple(_text(item) for item in value)


def _integer(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{value!r} is no whole number")
    return value


def _integers(value: Any) -> IntArray:
    return np.asarray([_integer(item) for item in value], dtype=np.int64)


def _switches(value: Any) -> BoolArray:
    if not all(isinstance(item, bool) for item in value):
        raise TypeError("a list of true and false is malformed")
    return np.asarray(value, dtype=np.bool_)


def _floats(value: Any, ndim: int) -> FloatArray:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != ndim or not np.isfinite(array).all():
        raise ValueError(f"a table of {ndim} axes is malformed")
    return array


def _mismatch(fields: Mapping[str, Any]) -> str | None:
    """Return how the parts of an analysis do not fit each other, or ``None``."""
    n, d = fields["variants"].shape[0], len(fields["features"].names)
    cut, stability, features = fields["cut"], fields["stability"], fields["features"]
    mixtures = fields["mixtures"]
    wanted: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
        "variants": (fields["variants"].shape, (max(n, 2), len(fields["parameters"]))),
        "mixtures": ((len(mixtures),), (n,)),
        "distances": (fields["distances"].shape, (n, n)),
        "linkage": (fields["linkage"].shape, (n - 1, 4)),
        "features": (features.matrix.shape, (len(features.logged), d)),
        "features.centre": (features.centre.shape, (len(features.logged),)),
        "features.scaling": (features.scaling.scale.shape, (d,)),
        "recorded": (fields["recorded"].shape[1:], (d,)),
        "sampled": (fields["sampled"].shape[1:], (d,)),
        "cut.labels": (cut.labels.shape, (n,)),
        "cut.statistic": (cut.statistic.shape, (n - 1,)),
        "cut.divided": (cut.divided.shape, (n - 1,)),
    }
    for name in ("success_rate", "n_trials", "n_recorded", "stride", "labels"):
        wanted[name] = (fields[name].shape, (n,))
    for name in ("inconsistency", "inconsistency_depth_2"):
        wanted[name] = (fields[name].shape, (n - 1,))
    if fields["check"] is not None:
        wanted["check"] = (fields["check"].reference.shape, (n, n))
        wanted["check.standard_error"] = (fields["check"].standard_error.shape, (n, n))
    if stability is not None:
        wanted["stability"] = (stability.co_membership.shape, (n, n))
        wanted["stability.boundaries"] = (stability.boundaries.shape, (n - 1,))
    bad = [name for name, (found, right) in wanted.items() if found != right]
    if bad:
        return f"the shapes of {', '.join(bad)} do not fit {n} variants"
    if fields["n_networks"] < 1:
        return "`n_networks` is not positive"
    if not hierarchy.is_valid_linkage(fields["linkage"]):
        return "`linkage` is not a dendrogram"
    if any(mixture.fit is None or mixture.n_features != d for mixture in mixtures):
        return f"a mixture is not a fit over {d} features"
    indices = [i for merge in fields["merges"] for i in (*merge.members, *merge.into)]
    indices.append(fields["bic_variant"])
    if not all(0 <= index < n for index in indices):
        return f"an index is not among {n} variants"
    groups = range(len(fields["curriculum"].groups))
    if set(fields["labels"].tolist()) != set(groups):
        return "`labels` do not fit the groups of the curriculum"
    return None
