"""Task spaces with axes of every kind."""

import numpy as np
import pytest

from surmount.core.axis import CONTINUOUS, Axis
from surmount.core.errors import InputError
from surmount.tasks.cells import TaskCells, cells
from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions
from surmount.tasks.space import TaskSpace, harder_by_success


def mixed_space() -> TaskSpace:
    return TaskSpace.grid(
        width_m=[0.5, 1.0],
        friction=np.logspace(-3, 0, 4),
        n_obstacles=[4, 1, 2],
        terrain=["stairs", "flat"],
        axes={"friction": "logarithmic"},
    )


def test_a_grid_tells_kinds_and_gives_tasks_as_environments_want_them():
    space = mixed_space()
    assert [axis.kind for axis in space.axes] == [
        "continuous",
        "logarithmic",
        "integer",
        "categorical",
    ]
    assert space.variants.shape == (2 * 4 * 3 * 2, 4)
    task = space.named(space.variants[0])
    assert task == {
        "width_m": 0.5,
        "friction": pytest.approx(1e-3),
        "n_obstacles": 1,
        "terrain": "stairs",
    }
    assert isinstance(task["n_obstacles"], int)
    assert space.text(space.variants[-1]) == "1, 1, 4, flat"


def test_draws_are_even_on_the_scale_of_each_axis():
    tasks = mixed_space().whole_range.sample(np.random.default_rng(0), 30_000)
    np.testing.assert_allclose(np.median(tasks[:, 0]), 0.75, atol=0.01)
    np.testing.assert_allclose(np.median(tasks[:, 1]), 10**-1.5, rtol=0.1)
    assert np.unique(tasks[:, 2]).tolist() == [1, 2, 3, 4]
    np.testing.assert_allclose(np.bincount(tasks[:, 2].astype(int))[1:] / 30_000, 0.25, atol=0.01)
    np.testing.assert_allclose(np.bincount(tasks[:, 3].astype(int)) / 30_000, 0.5, atol=0.012)


def test_cells_of_a_mixed_grid_tile_it():
    space = mixed_space()
    grid = TaskCells(space.parameters, space.variants, space.axes)
    tasks = space.whole_range.sample(np.random.default_rng(1), 500)
    inside = ((grid.lower[:, None] <= tasks) & (tasks <= grid.upper[:, None])).all(axis=2)
    assert (inside.sum(axis=0) == 1).all()
    drawn = grid.distribution(np.eye(grid.count)[5]).sample(np.random.default_rng(2), 100)
    assert {grid.locate(task) for task in drawn} == {5}


def test_scattered_variants_have_boxes_that_share_no_whole_number_and_no_category():
    axes = (Axis(kind="integer"), Axis(kind="categorical", names=("a", "b")))
    variants = np.array([[0.0, 0], [2, 0], [9, 0], [1, 1]])
    lower, upper = cells(variants, axes)
    assert ((lower <= variants) & (variants <= upper)).all()
    points = np.array([[n, kind] for n in range(10) for kind in (0, 1)])
    inside = ((lower[:, None] <= points) & (points <= upper[:, None])).all(axis=2)
    assert inside.sum(axis=0).max() == 1


def test_shares_of_regions_are_taken_on_the_scale():
    friction = TaskDistribution.uniform(
        ("friction",), np.array([1e-4]), np.array([1.0]), (Axis(kind="logarithmic"),)
    )
    regions = Regions(
        names=("low", "high"),
        lower=(np.array([[1e-4]]), np.array([[1e-1]])),
        upper=(np.array([[1e-1]]), np.array([[1.0]])),
    )
    np.testing.assert_allclose(regions.shares(friction), [0.75, 0.25])
    whole = TaskDistribution.uniform(
        ("n",), np.array([1.0]), np.array([4.0]), (Axis(kind="integer"),)
    )
    regions = Regions(
        names=("one", "more"),
        lower=(np.array([[1.0]]), np.array([[2.0]])),
        upper=(np.array([[1.0]]), np.array([[4.0]])),
    )
    np.testing.assert_allclose(regions.shares(whole), [0.25, 0.75])


def test_a_distribution_survives_its_record_and_an_old_record_is_continuous():
    whole = mixed_space().whole_range
    again = TaskDistribution.from_record(whole.to_record())
    assert again.axes == whole.axes
    record = TaskDistribution.uniform(("a",), np.zeros(1), np.ones(1)).to_record()
    assert "axes" not in record
    assert TaskDistribution.from_record(record).axes == (CONTINUOUS,)


def curriculum_of_kinds() -> Curriculum:
    """Two groups over whole numbers and categories."""
    space = TaskSpace.grid(n=[1, 2], terrain=["flat", "stairs", "slope"])
    lower, upper = cells(space.variants, space.axes)
    easy = [0, 2, 3]
    return Curriculum(
        parameters=space.parameters,
        groups=tuple(
            Group(
                name=name,
                variants=space.variants[members],
                success_rate=rate,
                boxes=tuple(Box(lower=lower[i], upper=upper[i], weight=1.0) for i in members),
            )
            for name, members, rate in [("easy", easy, 0.9), ("difficult", [1, 4, 5], 0.1)]
        ),
        levels=(Level(dominant="difficult", weights=(0.25, 0.75)),),
        success_threshold=0.95,
        axes=space.axes,
    )


def test_a_curriculum_with_axes_is_read_as_it_was_written(tmp_path):
    made = curriculum_of_kinds()
    made.save(tmp_path / "curriculum.json")
    text = (tmp_path / "curriculum.json").read_text(encoding="utf-8")
    assert '"schema": 2' in text
    assert '[1, "stairs"]' in text
    again = Curriculum.load(tmp_path / "curriculum.json")
    assert again.axes == made.axes
    assert again.to_record() == made.to_record()


def test_a_level_draws_the_kinds_of_its_groups():
    made = curriculum_of_kinds()
    tasks = made.sample(0, np.random.default_rng(0), 4_000)
    owner = made.groups_of(tasks)
    assert set(owner.tolist()) == {0, 1}
    np.testing.assert_allclose((owner == 1).mean(), 0.75, atol=0.03)


def test_a_curriculum_of_continuous_axes_is_written_as_before():
    record = {
        "kind": "surmount curriculum",
        "schema": 1,
        "parameters": ["a"],
        "success_threshold": 0.95,
        "groups": [
            {"name": "all", "success_rate": 0.5, "variants": [[1.0], [2.0]],
             "boxes": [{"lower": [1.0], "upper": [2.0], "weight": 2.0}]}
        ],
        "levels": [],
    }  # fmt: skip
    made = Curriculum.from_record(record)
    assert made.axes == (CONTINUOUS,)
    assert made.to_record() == record


@pytest.mark.parametrize(
    ("axes", "sentence"),
    [
        ({"b": {"kind": "integer"}}, "names 'b', which is no parameter"),
        ({"a": {"kind": "ordinal"}}, "no kind of axis 'ordinal'"),
        ({"a": "integer"}, "`axes.a` is not a table"),
        ({"a": {"kind": "integer", "sort": 1}}, "has a key 'sort'"),
        ({"a": {"kind": "integer"}}, r"lists of 1 values \(a whole number\)"),
        ({"a": {"kind": "categorical", "names": ["x"]}}, r"\(one of x\)"),
        ([], "`axes` is not a table"),
    ],
)
def test_problems_of_axes_are_named(axes, sentence):
    record = {
        "kind": "surmount curriculum",
        "schema": 2,
        "parameters": ["a"],
        "axes": axes,
        "success_threshold": 0.95,
        "groups": [
            {"name": "all", "success_rate": 0.5, "variants": [[1.5]],
             "boxes": [{"lower": [1.0], "upper": [2.0], "weight": 2.0}]}
        ],
        "levels": [],
    }  # fmt: skip
    with pytest.raises(InputError, match=sentence):
        Curriculum.from_record(record)


def test_a_curriculum_moves_to_the_axes_of_an_environment_by_name():
    made = curriculum_of_kinds()
    other = (Axis(kind="integer"), Axis(kind="categorical", names=("slope", "flat", "stairs")))
    moved = made.on(other)
    assert [made.text(one) for one in made.groups[0].variants] == [
        moved.text(one) for one in moved.groups[0].variants
    ]
    with pytest.raises(InputError, match="does not lie on other axes"):
        made.on((Axis(kind="integer"), Axis(kind="categorical", names=("slope", "flat"))))


def test_kinds_can_be_declared_afterwards():
    space = TaskSpace.grid(n=[1.0, 3.0], friction=[0.01, 1.0]).declared(
        {"n": "categorical", "friction": "logarithmic"}
    )
    assert space.named(space.variants[-1]) == {"n": "3", "friction": 1.0}
    assert space.upper.tolist() == [1.0, 1.0]
    with pytest.raises(InputError, match="no parameter `m`"):
        space.declared({"m": "integer"})
    with pytest.raises(InputError, match="`terrain` is integer and cannot be"):
        mixed_space().declared({"terrain": "integer"})


def test_a_variant_is_given_by_names_or_by_what_stands_for_them():
    space = mixed_space()
    task = space.task([0.5, 0.1, 2, "flat"])
    assert space.task(task.tolist()).tolist() == task.tolist() == [0.5, 0.1, 2, 1]
    with pytest.raises(InputError, match="'mud' as `terrain`"):
        space.task([0.5, 0.1, 2, "mud"])
    with pytest.raises(InputError, match=r"2\.5 as `n_obstacles`"):
        space.task([0.5, 0.1, 2.5, "flat"])


def test_difficulty_is_ranked_on_the_scale():
    space = TaskSpace.grid(
        a=[1.0, 10.0, 100.0],
        terrain=["x", "y"],
        axes={"a": "logarithmic"},
        harder={"a": 1, "terrain": 1},
    )
    order = TaskCells(space.parameters, space.variants, space.axes).by_difficulty((1, 1))
    assert [space.text(space.variants[i]) for i in order] == [
        "1, x",
        "10, x",
        "1, y",
        "100, x",
        "10, y",
        "100, y",
    ]
    falling = np.array([0.9, 0.9, 0.5, 0.5, 0.1, 0.1])
    assert harder_by_success(space.variants, falling, space.axes) == (1, 1)
