import json

import numpy as np
import pytest

from surmount.core.errors import InputError
from surmount.stats.detectable import detectable_difference
from surmount.stats.differences import network_difference
from surmount.stats.mixed import mixed_model, network_contrasts

NAMES = {"response": "y", "group": "group", "method": "method", "subject": "network"}


def table(rows):
    return dict(zip(("group", "method", "network", "y"), zip(*rows, strict=True), strict=True))


def balanced(differences, repetitions=4):
    """Rows in which network i has exactly ``differences[i]`` between the two arms."""
    rng = np.random.default_rng(5)
    noise = rng.normal(size=repetitions)
    noise -= noise.mean()
    return table(
        [
            ("hard", method, f"n{index}", 10.0 * index + own * (method == "curriculum") + jitter)
            for index, own in enumerate(differences)
            for method in ("control", "curriculum")
            for jitter in noise
        ]
    )


def test_each_network_has_its_own_difference_with_mean_spread_range_and_sign():
    (found,) = network_contrasts(
        balanced([-3.0, -1.0, 0.5, -4.5]), **NAMES, methods=["curriculum", "control"]
    )
    assert (found.group, found.method, found.reference) == ("hard", "curriculum", "control")
    assert found.networks == ("n0", "n1", "n2", "n3")
    assert found.differences == pytest.approx([-3.0, -1.0, 0.5, -4.5], abs=1e-12)
    assert found.mean == pytest.approx(-2.0, abs=1e-12)
    assert found.sd == pytest.approx(np.sqrt((1 + 1 + 6.25 + 6.25) / 3), abs=1e-12)
    assert (found.lowest, found.highest) == pytest.approx((-4.5, 0.5), abs=1e-12)
    assert found.same_sign == 3
    assert (found.left_out, found.reason) == ((), None)
    json.dumps(found.to_record(), allow_nan=False)


def test_in_a_balanced_table_the_mean_is_the_mixed_models_and_only_its_error_differs():
    rows = balanced([-8.0, 2.0, 5.0, 6.0, -1.0], repetitions=200)
    (spread,) = network_contrasts(rows, **NAMES)
    (contrast,) = mixed_model(rows, **NAMES).contrasts
    assert spread.mean == pytest.approx(contrast.estimate, abs=1e-9)
    # Networks differ by more than the trials of one: what the model's error does not know.
    over_networks = spread.sd / np.sqrt(5)
    assert over_networks > 5 * contrast.std_error


def test_the_spread_is_that_of_the_paired_t_test_and_feeds_what_it_could_have_found():
    rows = balanced([-8.0, 2.0, 5.0, 6.0, -1.0])
    (spread,) = network_contrasts(rows, **NAMES)
    test = network_difference(spread.differences, np.zeros(5), paired=True)
    assert test.t == pytest.approx(spread.mean / (spread.sd / np.sqrt(5)), rel=1e-9)
    found = detectable_difference(spread.sd, len(spread.networks)).difference
    assert found > test.upper - test.estimate  # more than half of the interval: 80 %, not 50 %


def test_contrasts_stand_in_the_order_of_the_mixed_models():
    rng = np.random.default_rng(6)
    rows = table(
        [
            (group, method, network, rng.normal())
            for group in ("easy", "hard")
            for method in ("a", "b", "c")
            for network in (1, 2, 3)
            for _ in range(2)
        ]
    )
    order = {"groups": ["hard", "easy"], "methods": ["c", "a", "b"]}
    found = network_contrasts(rows, **NAMES, **order)
    expected = mixed_model(rows, **NAMES, **order).contrasts
    assert [(c.group, c.method, c.reference) for c in found] == [
        (c.group, c.method, c.reference) for c in expected
    ]


def test_networks_without_both_arms_are_named_and_one_pair_has_no_spread():
    rows = [("easy", "a", "n1", 1.0), ("easy", "b", "n1", 3.0), ("easy", "b", "n2", 4.0)]
    (found,) = network_contrasts(table(rows), **NAMES)
    assert (found.networks, found.left_out) == (("n1",), ("n2",))
    assert (found.mean, found.sd, found.same_sign) == (-2.0, None, 1)
    assert "fewer than two networks" in found.reason
    (empty,) = network_contrasts(table(rows[1:]), **NAMES, methods=["a", "b"])
    assert (empty.differences, empty.mean, empty.lowest, empty.same_sign) == ((), None, None, 0)
    json.dumps(empty.to_record(), allow_nan=False)


def test_networks_that_differ_by_rounding_alone_have_no_spread():
    rows = table(
        [
            ("g", method, network, base + step)
            for network, base in (("n1", 0.1), ("n2", 0.7), ("n3", 1e3))
            for method, step in (("a", 0.2), ("b", 0.0))
        ]
    )
    (found,) = network_contrasts(rows, **NAMES)
    assert len(set(found.differences)) > 1
    assert (found.sd, found.same_sign) == (0.0, 3)


def test_bad_columns_are_named():
    with pytest.raises(InputError, match="no column `y`"):
        network_contrasts({"group": ["a"]}, **NAMES)
