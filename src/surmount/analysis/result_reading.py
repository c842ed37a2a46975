"""Reading an analysis from its JSON form: every part checked, so that no later step stumbles."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from scipy.cluster import hierarchy

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.configuration import from_record
from surmount.core.errors import InputError, SurmountError
from surmount.core.reading import read_fields
from surmount.tasks.curriculum import Curriculum

KIND = "surmount analysis"
SCHEMA = 2
_ABSENT: Mapping[str, Any] = {"network_names": [], "suspects": [], "notes": []}
"""What records of before lack, and what its absence means."""
_REMEDY = "Write it again with `surmount analyze`."


def analysis_fields(kind: type[object], record: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return the fields of ``kind``, :class:`surmount.analysis.result.Analysis`.

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
        fields = read_fields(
            kind,
            {**_ABSENT, **record},
            built={
                "config": from_record(AnalysisConfig, record["config"]),
                "curriculum": Curriculum.from_record(record["curriculum"]),
            },
        )
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
    if not ((fields["distances"] >= 0.0) & (fields["distances"] <= 1.0)).all():
        return "a distance lies outside 0 to 1"
    curves = [curve for curve in (fields["bic"], *fields["bic_per_variant"]) if curve is not None]
    if any(
        len({len(c.components), len(c.values), len(c.converged)}) != 1
        or not {c.minimum, c.chosen} <= set(c.components)
        for c in curves
    ):
        return "a BIC curve is malformed"
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
