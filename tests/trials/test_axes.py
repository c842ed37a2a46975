"""Tables of trials whose variants are names, whole numbers, or logarithmic."""

import numpy as np
import pytest

from surmount.core.axis import CONTINUOUS, Axis
from surmount.core.errors import InputError
from surmount.trials.table import read_trials, trials_from_table, write_trials
from surmount.trials.trials import Trials

KINDS = (
    Axis(kind="categorical", names=("flat", "stairs", "slope")),
    Axis(kind="integer"),
    Axis(kind="logarithmic"),
)


def table(**changes):
    columns = {
        "variant.terrain": ["stairs", "flat", "stairs", "slope"],
        "variant.n": [1, 2, 1, 3],
        "network": [0] * 4,
        "trial": [0, 0, 1, 0],
        "success": [1, 0, 1, 0],
        "x_m": [0.1, 0.2, 0.3, 0.4],
    }
    return {name: values for name, values in (columns | changes).items() if values is not None}


def mixed_trials() -> Trials:
    return Trials(
        parameters=("terrain", "n", "friction"),
        feature_names=("x_m",),
        variant=np.array([[2, 1, 1e-3], [0, 3, 1.0]]),
        network=np.zeros(2, np.int64),
        repetition=np.zeros(2, np.int64),
        success=np.array([True, False]),
        starts=np.array([0, 2, 3]),
        features=np.array([[0.1], [0.2], [0.3]]),
        axes=KINDS,
    )


def test_a_text_variant_is_a_category():
    trials = trials_from_table(table())
    assert trials.axes == (Axis(kind="categorical", names=("flat", "slope", "stairs")), CONTINUOUS)
    assert trials.n_trials == 4
    variants, _ = trials.variants()
    assert [trials.axes[0].text(one) for one in variants[:, 0]] == ["flat", "slope", "stairs"]


def test_a_text_variant_alone_is_a_category_in_csv(tmp_path):
    path = tmp_path / "trials.csv"
    path.write_text(
        "variant,network,trial,success,x_m\nmud,0,0,1,0.1\nice,0,0,0,0.2\n", encoding="utf-8"
    )
    trials = read_trials(path)
    assert trials.axes[0].names == ("ice", "mud")
    assert trials.variant[:, 0].tolist() == [1, 0]


@pytest.mark.parametrize(
    ("terrain", "sentence"),
    [
        (["stairs", "", "stairs", "slope"], "`variant.terrain` is missing"),
        (["1", "2", "2O", "3"], "`variant.terrain` is not a number"),
        (["a\x1b", "b", "b", "c"], "cannot be printed"),
    ],
)
def test_what_is_neither_names_nor_numbers_is_refused(terrain, sentence):
    with pytest.raises(InputError, match=sentence):
        trials_from_table(table(**{"variant.terrain": terrain}))


def test_parquet_keeps_kinds_and_the_order_of_categories(tmp_path):
    write_trials(tmp_path / "trials.parquet", mixed_trials())
    again = read_trials(tmp_path / "trials.parquet")
    assert again.axes == KINDS
    np.testing.assert_array_equal(again.variant, mixed_trials().variant)


def test_csv_keeps_names_and_the_rest_can_be_declared(tmp_path):
    write_trials(tmp_path / "trials.csv", mixed_trials())
    assert (tmp_path / "trials.csv").read_text().splitlines()[1].startswith("slope,1,0.001,")
    read = read_trials(tmp_path / "trials.csv")
    assert [axis.kind for axis in read.axes] == ["categorical", "continuous", "continuous"]
    assert read.axes[0].names == ("flat", "slope")
    again = read.declared({"n": "integer", "friction": "logarithmic"}).on(KINDS)
    assert again.axes == KINDS
    np.testing.assert_array_equal(again.variant, mixed_trials().variant)


def test_trials_with_other_categories_are_joined_by_name():
    first = trials_from_table(table())
    second = trials_from_table(table(**{"variant.terrain": ["mud", "mud", "flat", "flat"]}))
    joined = Trials.concatenate([first, second])
    names = [joined.axes[0].value(one) for one in joined.variant[:, 0]]
    assert names == ["stairs", "flat", "stairs", "slope", "mud", "mud", "flat", "flat"]


def test_numbers_can_be_declared_categories_and_are_named_as_they_are_written():
    trials = trials_from_table(table(**{"variant.terrain": [3, 10, 3, 7]}))
    assert trials.declared({"terrain": "categorical"}).axes[0].names == ("3", "7", "10")
    with pytest.raises(InputError, match="no task parameter `mass`"):
        trials.declared({"mass": "integer"})
    with pytest.raises(InputError, match=r"`n` is integer and cannot be 1\.5"):
        trials_from_table(table(**{"variant.n": [1, 1.5, 1, 3]})).declared({"n": "integer"})
