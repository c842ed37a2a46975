"""Configurations load strictly: what is not understood is an error with a remedy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surmount.core.configuration import (
    absent,
    completed,
    differences,
    dotted_keys,
    from_record,
    key_record,
    override,
    read_overrides,
    to_record,
)
from surmount.core.errors import ConfigError
from surmount.experiment.presets import preset


@dataclass(frozen=True, kw_only=True)
class Inner:
    rate: float = 0.1
    kind: Literal["a", "b"] = "a"
    layers: tuple[int, ...] = (2, 3)
    span: tuple[float, float] = (0.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class Outer:
    name: str = "x"
    steps: int = 10
    flag: bool = False
    limit: float | None = None
    inner: Inner = field(default_factory=Inner)


def test_a_record_builds_the_configuration_it_came_from():
    config = override(Outer(), {"inner.layers": "[4, 5]", "limit": 2, "inner.span": [1, 2]})
    assert from_record(Outer, to_record(config)) == config
    assert config.inner.layers == (4, 5)
    assert config.inner.span == (1.0, 2.0)
    assert config.limit == 2.0


def test_dotted_keys_reach_every_leaf():
    assert dotted_keys(Outer) == [
        "name", "steps", "flag", "limit",
        "inner.rate", "inner.kind", "inner.layers", "inner.span",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("key", "meant"),
    [("inner.rte", "inner.rate"), ("rate", "inner.rate"), ("stepz", "steps"), ("inner", "inner.")],
)
def test_an_unknown_key_names_the_nearest_valid_one(key, meant):
    with pytest.raises(ConfigError, match=f"Unknown configuration key `{key}`") as caught:
        override(Outer(), {key: 1})
    assert f"`{meant}" in caught.value.remedy


@pytest.mark.parametrize(
    ("key", "value", "names"),
    [
        ("steps", "many", "`steps` is 'many'"),
        ("steps", "1.5", "`steps` is 1.5"),
        ("steps", "true", "`steps` is True"),
        ("inner.rate", "[1]", "`inner.rate` is"),
        ("inner.kind", "c", "`inner.kind` is 'c'"),
        ("inner.span", "[1]", "`inner.span` is"),
        ("flag", "1", "`flag` is 1"),
        ("limit", "high", "`limit` is 'high'"),
    ],
)
def test_a_value_of_the_wrong_type_is_refused_with_its_key(key, value, names):
    with pytest.raises(ConfigError) as caught:
        override(Outer(), {key: value})
    assert names in caught.value.message
    assert caught.value.remedy


def test_whole_numbers_may_be_written_with_an_exponent():
    assert override(Outer(), {"steps": "5e5"}).steps == 500_000


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("c.toml", 'name = "y"\n[inner]\nrate = 0.5\n'),
        ("c.toml", 'name = "y"\ninner.rate = 0.5\n'),
        ("c.json", '{"name": "y", "inner": {"rate": 0.5}}'),
    ],
)
def test_files_give_the_same_overrides_as_the_command_line(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    assert override(Outer(), read_overrides(path)) == override(
        Outer(), {"name": "y", "inner.rate": "0.5"}
    )


@pytest.mark.parametrize(
    ("name", "content"),
    [("c.toml", b"= 3"), ("c.json", b"{"), ("c.json", b"[1]"), ("c.toml", b"\xff\xfe")],
)
def test_a_damaged_file_is_refused_by_name(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=name):
        read_overrides(path)


def test_differences_name_the_keys():
    changed = override(Outer(), {"inner.rate": 0.2})
    assert differences(to_record(Outer()), to_record(changed)) == {"inner.rate": (0.1, 0.2)}


@given(st.dictionaries(st.text(max_size=12), st.text(max_size=12), max_size=3))
def test_any_override_is_taken_or_refused_in_a_sentence(changes):
    refusal = None
    try:
        override(Outer(), changes)
    except ConfigError as error:
        refusal = error
    valid = set(dotted_keys(Outer))
    assert refusal is not None or changes.keys() <= valid
    assert refusal is None or (refusal.message and refusal.remedy)


@pytest.mark.parametrize("value", [10**400, -(10**19), 1e300])
def test_numbers_beyond_any_meaning_are_refused(value):
    with pytest.raises(ConfigError):
        override(preset("step", "smoke"), {"seed": value})
    with pytest.raises(ConfigError):
        override(preset("step", "smoke"), {"env.episode_s": value})


@dataclass(frozen=True, kw_only=True)
class Later:
    old: int = 1
    same: float | None = field(default=None, metadata=absent(None))
    measure: Literal["step", "episode"] = field(default="episode", metadata=absent("step"))
    pair: tuple[int, ...] = field(default=(1, 2), metadata=absent((0,)))
    part: Inner = field(default_factory=lambda: Inner(rate=0.5), metadata=absent(Inner()))


@dataclass(frozen=True, kw_only=True)
class AroundLater:
    later: Later = field(default_factory=Later)


BEFORE = Later(same=None, measure="step", pair=(0,), part=Inner())
"""What a record meant that was written before there was more than ``old``."""


def test_a_record_without_later_fields_means_what_was_done_before_them():
    assert from_record(AroundLater, {"later": {"old": 1}}).later == BEFORE
    assert from_record(AroundLater, {}).later == Later()
    assert completed(AroundLater, {"later": {"old": 3}}) == {
        "later": to_record(Later(**(vars(BEFORE) | {"old": 3})))
    }


def test_keys_leave_later_fields_out_where_they_are_as_before():
    assert key_record(AroundLater(later=BEFORE)) == {"later": {"old": 1}}
    assert key_record(Later()) == {
        "old": 1, "measure": "episode", "pair": [1, 2], "part": to_record(Inner(rate=0.5)),
    }  # fmt: skip


@given(
    st.builds(
        Later,
        old=st.integers(0, 9),
        same=st.none() | st.floats(0, 1),
        measure=st.sampled_from(["step", "episode"]),
        pair=st.sampled_from([(0,), (1, 2), ()]),
        part=st.builds(Inner, rate=st.sampled_from([0.1, 0.5])),
    )
)
def test_both_records_of_a_configuration_build_it_again(config):
    assert from_record(Later, key_record(config)) == config
    assert from_record(Later, to_record(config)) == config


def test_one_changed_later_field_stays_in_the_key():
    assert key_record(AroundLater(later=Later(**(vars(BEFORE) | {"same": 0.5})))) == {
        "later": {"old": 1, "same": 0.5}
    }
