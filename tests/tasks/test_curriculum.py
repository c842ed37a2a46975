"""Curricula: sampling, the file, and what editing it by hand may and may not do."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surmount.core.errors import InputError
from surmount.tasks.curriculum import Box, Curriculum, Group, Level


def box(low, high, weight=1.0):
    return Box(lower=np.array([low]), upper=np.array([high]), weight=weight)


def curriculum() -> Curriculum:
    return Curriculum(
        parameters=("height_mm",),
        groups=(
            Group(
                name="easy",
                variants=np.array([[21.0], [22.0], [40.0]]),
                success_rate=0.94,
                boxes=(box(21.0, 25.0, 2.0), box(39.0, 41.0, 1.0)),
            ),
            Group(
                name="difficult",
                variants=np.array([[30.0], [31.0]]),
                success_rate=0.1,
                boxes=(box(25.0, 39.0),),
            ),
        ),
        levels=(Level(dominant="difficult", weights=(0.3, 0.7)),),
        success_threshold=0.95,
    )


def test_levels_draw_groups_by_their_weights_and_runs_by_their_variants():
    n = 40_000
    tasks = curriculum().sample(0, np.random.default_rng(0), n)[:, 0]
    shares = [np.mean(tasks < 25), np.mean((tasks >= 25) & (tasks < 39)), np.mean(tasks >= 39)]
    # Standard errors are below 0.0025; five of them.
    np.testing.assert_allclose(shares, [0.2, 0.7, 0.1], atol=0.0125)


def test_saving_and_loading_gives_the_same_curriculum(tmp_path: Path):
    curriculum().save(tmp_path / "c.json")
    assert Curriculum.load(tmp_path / "c.json").to_record() == curriculum().to_record()


def test_the_file_keeps_each_point_on_one_line(tmp_path: Path):
    curriculum().save(tmp_path / "c.json")
    text = (tmp_path / "c.json").read_text()
    assert '"lower": [25.0]' in text
    assert json.loads(text) == curriculum().to_record()


def test_editing_the_file_by_hand_works(tmp_path: Path):
    path = tmp_path / "c.json"
    curriculum().save(path)
    text = path.read_text().replace('"easy": 0.3', '"easy": 0.25').replace("0.7", "0.75")
    path.write_text(text)
    assert Curriculum.load(path).levels[0].weights == (0.25, 0.75)


def test_a_group_that_a_level_leaves_out_weighs_nothing():
    record = curriculum().to_record()
    record["levels"][0]["weights"] = {"difficult": 1.0}
    assert Curriculum.from_record(record).levels[0].weights == (0.0, 1.0)


def test_every_mistake_of_a_hand_is_named_at_once():
    record = curriculum().to_record()
    record["groups"][0]["success_rate"] = 94
    record["groups"][1]["boxes"][0]["lower"] = [50.0]
    record["levels"][0]["dominant"] = "dificult"
    record["levels"][0]["weights"]["easy"] = 0.4
    with pytest.raises(InputError) as caught:
        Curriculum.from_record(record, source="c.json")
    text = str(caught.value)
    assert "`groups[0].success_rate` is not a number from 0 to 1" in text
    assert "`groups[1].boxes[0]` has a lower bound above its upper bound" in text
    assert "`levels[0].dominant` is 'dificult', which is no group" in text
    assert "sum to 1.1, not to 1" in text


@pytest.mark.parametrize(
    ("place", "key"),
    [
        ((), "succes_threshold"),
        (("groups", 1), "colour"),
        (("groups", 0, "boxes", 0), "wieght"),
        (("levels", 0), "min_steps"),
    ],
)
def test_a_key_that_saving_would_lose_is_refused(place: tuple[str | int, ...], key: str):
    record = curriculum().to_record()
    node = record
    for step in place:
        node = node[step]
    node[key] = 1
    with pytest.raises(InputError, match=f"has a key '{key}'"):
        Curriculum.from_record(record)


def test_a_curriculum_without_levels_is_sound_and_has_no_level_to_draw():
    record = curriculum().to_record()
    record["levels"] = []
    loaded = Curriculum.from_record(record)
    assert loaded.n_levels == 0
    with pytest.raises(InputError, match="no level 0"):
        loaded.sample(0, np.random.default_rng(0), 1)


def test_group_of_finds_recorded_variants_only():
    assert curriculum().group_of(np.array([40.0])) == 0
    assert curriculum().group_of(np.array([31.0])) == 1
    assert curriculum().group_of(np.array([26.0])) is None
    trials = np.array([[31.0], [40.0], [26.0], [40.0]])
    assert curriculum().groups_of(trials).tolist() == [1, 0, -1, 0]


def paths(node, prefix=()):
    yield prefix
    items = (
        node.items()
        if isinstance(node, dict)
        else enumerate(node)
        if isinstance(node, list)
        else ()
    )
    for key, child in items:
        yield from paths(child, (*prefix, key))


PATHS = [path for path in paths(curriculum().to_record()) if path]
junk = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.integers(10**400, 10**401),
    st.floats(),
    st.text(max_size=5),
    st.just([]),
    st.just({}),
    st.lists(st.floats(), max_size=3),
)


@settings(max_examples=200)
@given(path=st.sampled_from(PATHS), value=junk, drop=st.booleans())
def test_any_change_loads_soundly_or_is_refused_with_a_remedy(path, value, drop):
    record = copy.deepcopy(curriculum().to_record())
    node = record
    for key in path[:-1]:
        node = node[key]
    if drop:
        del node[path[-1]]
    else:
        node[path[-1]] = value
    try:
        loaded = Curriculum.from_record(record)
    except InputError:
        return
    for level in range(loaded.n_levels):
        assert np.isfinite(loaded.sample(level, np.random.default_rng(0), 10)).all()


@settings(max_examples=60)
@given(st.text(max_size=60) | st.recursive(junk, lambda x: st.lists(x, max_size=3)).map(json.dumps))
def test_any_text_is_refused_in_a_sentence(tmp_path_factory, text):
    path = tmp_path_factory.mktemp("fuzz") / "c.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError):
        Curriculum.load(path)


@pytest.mark.parametrize("weight", [5e-324, 1e-300, 1e-13])
def test_a_weight_that_vanishes_in_products_is_refused(weight: float):
    """Nothing would be drawn from it, and shares of its box would be NaN."""
    record = curriculum().to_record()
    for box_record in record["groups"][0]["boxes"]:
        box_record["weight"] = weight
    with pytest.raises(InputError, match="weight between 0 and"):
        Curriculum.from_record(record)
    record = curriculum().to_record()
    names = list(record["levels"][0]["weights"])
    record["levels"][0]["weights"] = {names[0]: 1.0, names[1]: weight}
    with pytest.raises(InputError, match="weight between 0 and"):
        Curriculum.from_record(record)
