"""The analysis file: what is damaged is refused in a sentence, never half understood."""

from __future__ import annotations

import copy
import html
import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic_trials import SyntheticFamily

from surmount import Analysis, AnalysisConfig, determine_curriculum
from surmount.analysis.explanation import explain_analysis
from surmount.analysis.trust import describe_trust
from surmount.core.errors import InputError, SurmountError

FAMILY = SyntheticFamily(sizes=(3, 3), behaviours=(0, 1), separation=9.0, trials=6, steps=30)
CONFIG = AnalysisConfig(
    components=2, restarts=1, bootstrap=2, bootstrap_samples=50, check_distances=True
)
RECORD = json.loads(json.dumps(determine_curriculum(FAMILY.generate(), CONFIG).to_record()))


def paths(node, prefix=(), depth=4):
    if prefix:
        yield prefix
    if depth == 0:
        return
    items = enumerate(node[:2]) if isinstance(node, list) else getattr(node, "items", tuple)()
    for key, child in items:
        yield from paths(child, (*prefix, key), depth - 1)


PATHS = list(paths(RECORD))
junk = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 10**20),
    st.integers(10**400, 10**401),
    st.floats(),
    st.text(max_size=4),
    st.sampled_from([[], {}, [[]], [1, [2]], ["x"]]),
)


def test_saving_and_loading_gives_the_same_analysis(tmp_path: Path):
    Analysis.from_record(RECORD).save(tmp_path / "analysis.json")
    assert Analysis.load(tmp_path / "analysis.json").to_record() == RECORD


def test_another_schema_is_refused_by_its_number():
    with pytest.raises(InputError, match="schema 99"):
        Analysis.from_record(RECORD | {"schema": 99})


@settings(max_examples=200)
@given(path=st.sampled_from(PATHS), value=junk, drop=st.booleans())
def test_any_damage_is_refused_or_still_explains_itself(path, value, drop):
    record = copy.deepcopy(RECORD)
    node = record
    for key in path[:-1]:
        node = node[key]
    if drop:
        del node[path[-1]]
    else:
        node[path[-1]] = value
    try:
        loaded = Analysis.from_record(record)
    except SurmountError as error:
        remedy = error.remedy
    else:
        remedy = explain_analysis(loaded)
    assert remedy


def test_an_analysis_is_shown_by_its_groups_levels_and_verdict():
    analysis = Analysis.from_record(RECORD)
    shown = repr(analysis)
    assert len(shown) < 1000
    assert shown.startswith("Analysis: 6 variants tried by 2 networks")
    verdict = describe_trust(analysis)[0]
    for said in (shown, analysis._repr_html_()):
        assert all(group.name in said for group in analysis.groups)
    assert shown.splitlines()[-1] == verdict
    assert html.escape(verdict) in analysis._repr_html_()


def test_names_in_a_notebook_are_text_and_no_markup():
    group = replace(Analysis.from_record(RECORD).groups[0], name="<b>")
    curriculum = Analysis.from_record(RECORD).curriculum
    renamed = replace(
        curriculum,
        groups=(group, *curriculum.groups[1:]),
        levels=(),
    )
    analysis = replace(Analysis.from_record(RECORD), curriculum=renamed)
    assert "<td>&lt;b&gt;</td>" in analysis._repr_html_()
