"""Cuts: groups are found where similarities change abruptly, and only there."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.metrics import adjusted_rand_score, silhouette_score
from strategies import seeds
from synthetic_trials import SyntheticFamily

from surmount import AnalysisConfig
from surmount.analysis.agreement import adjusted_rand
from surmount.analysis.cut import abruptness, cut_dendrogram, mean_silhouette, separation
from surmount.analysis.dendrogram import build_dendrogram
from surmount.analysis.features import variant_samples
from surmount.analysis.fitting import FitSamples, mixture_of
from surmount.analysis.hellinger import hellinger_matrix
from surmount.analysis.sensitivity import group_variants

LINKAGES = ("average", "complete", "single", "weighted", "ward")


def from_positions(positions, noise=0.0, seed=0):
    """Distances of unit Gaussians at positions on a line, with a floor as estimates have."""
    positions = np.asarray(positions, dtype=float)
    shift = np.abs(positions[:, None] - positions)
    jitter = 1.0 + noise * np.random.default_rng(seed).standard_normal(shift.shape)
    shift = np.hypot(shift, 0.8 * np.triu(jitter, 1) + 0.8 * np.triu(jitter, 1).T)
    np.fill_diagonal(shift, 0.0)
    return np.sqrt(1.0 - np.exp(-np.square(shift) / 8.0))


def test_separation_of_gaussians_is_proportional_to_their_shift():
    shift = np.array([0.5, 1.0, 4.0, 10.0])
    hellinger = np.sqrt(1.0 - np.exp(-np.square(shift) / 8.0))
    np.testing.assert_allclose(separation(hellinger), shift / np.sqrt(8.0), rtol=1e-9)


@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("sizes", [(5, 5), (3, 12), (4, 4, 4), (3, 3, 3, 3, 3, 3), (10, 4, 7)])
def test_jumps_between_runs_divide_for_every_linkage(linkage, sizes):
    positions, truth = [], []
    for run, size in enumerate(sizes):
        positions += [12.0 * run + 0.4 * place for place in range(size)]
        truth += [run] * size
    config = AnalysisConfig(linkage=linkage)
    found = group_variants(from_positions(positions, noise=0.1), config)
    assert found.tolist() == truth


@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("step", [0.0, 0.3, 1.0, 3.0])
def test_steady_drift_is_not_divided(linkage, step):
    distances = from_positions(step * np.arange(18), noise=0.1)
    assert group_variants(distances, AnalysisConfig(linkage=linkage)).max() == 0


@given(seed=seeds, n=st.integers(3, 15))
@settings(max_examples=50)
def test_grouping_does_not_depend_on_the_order_of_variants(seed, n):
    rng = np.random.default_rng(seed)
    distances = from_positions(10.0 * rng.integers(0, 3, n) + rng.random(n), noise=0.05, seed=seed)
    order = rng.permutation(n)
    plain = group_variants(distances, AnalysisConfig())
    shuffled = group_variants(distances[np.ix_(order, order)], AnalysisConfig())
    assert adjusted_rand(plain[order], shuffled) == 1.0


def test_abruptness_of_two_runs_is_the_ratio_of_the_gaps():
    distances = from_positions([0.0, 1.0, 2.0, 20.0, 21.0, 22.0])
    dendrogram = build_dendrogram(distances, "single")
    apart = separation(distances)
    expected = apart[2, 3] / apart[0, 1]
    assert abruptness(dendrogram, distances)[-1] == pytest.approx(expected, rel=1e-9)


def test_abruptness_compares_with_the_lower_quartile_of_the_tighter_side():
    # Gaps 1, 2, 4 on the one side and 6, 6 on the other, 30 between them, without a floor.
    positions = np.array([0.0, 1.0, 3.0, 7.0, 37.0, 43.0, 49.0])
    distances = np.sqrt(1.0 - np.exp(-np.square((positions[:, None] - positions) / 20.0)))
    found = abruptness(build_dendrogram(distances, "single"), distances)
    assert found[-1] == pytest.approx(30.0 / np.quantile([1.0, 2.0, 4.0], 0.25), rel=1e-9)
    assert sorted(found)[:4] == [0.0] * 4  # two variants, or two and one


def test_variants_half_way_do_not_hide_an_abrupt_change():
    plateaus = [0.3 * np.arange(8.0), 12.0 + 0.3 * np.arange(8.0)]
    between = np.array([3.7, 5.7, 8.2, 10.4])
    distances = from_positions(np.concatenate([plateaus[0], between, plateaus[1]]), noise=0.05)
    found = group_variants(distances, AnalysisConfig())
    assert found[:8].tolist() == [0] * 8
    assert found[12:].tolist() == [1] * 8


def groups_of(family):
    config = AnalysisConfig(components=8, restarts=1, max_samples=2_000)
    data = variant_samples(family.generate(), config)
    fits = [FitSamples(samples).fit(8, config, 0) for samples in data.samples]
    mixtures = [mixture_of(fit, data.features.scaling, config, 8) for fit in fits]
    return group_variants(hellinger_matrix(mixtures), config)


@pytest.mark.parametrize("network_shift", [0.0, 2.0])
def test_a_transition_of_single_trials_from_success_to_stuck_parts_its_plateaus(network_shift):
    family = SyntheticFamily(
        sizes=(12, 14),
        behaviours=(0, 1),
        separation=8.0,
        transition=3.0,
        network_shift=network_shift,
        stuck=(1,),
        trials=16,
        seed=4,
    )
    known = family.labels >= 0
    assert 2 <= np.sum(~known) <= 6  # three by the width, more where the networks differ
    assert adjusted_rand(groups_of(family)[known], family.labels[known]) == 1.0


def test_a_robot_stuck_on_every_variant_behaves_in_one_way():
    family = SyntheticFamily(sizes=(15,), behaviours=(0,), stuck=(0,), trials=8, seed=4)
    assert groups_of(family).max() == 0


def test_trials_in_a_transition_take_either_behaviour_with_sliding_frequency():
    family = SyntheticFamily(
        sizes=(6, 6), behaviours=(0, 1), transition=4.0, network_shift=2.0, stuck=(1,), trials=400
    )
    trials = family.generate()
    passed = np.mean(trials.lengths.reshape(12, 200, 2) == 150, axis=1)  # (variant, network)
    # Halfway at 4.5 and 6.5, one fifth per variant; 4 standard errors of 200 trials are 0.14.
    for network, centre in enumerate((4.5, 6.5)):
        expected = np.clip(0.5 + (np.arange(12) - centre) / 5.0, 0.0, 1.0)
        np.testing.assert_allclose(passed[:, network], expected, atol=0.14)


def test_networks_take_the_trials_in_turn_and_pass_at_places_spread_over_the_shift():
    family = SyntheticFamily(
        sizes=(6, 6),
        behaviours=(0, 1),
        networks=3,
        network_shift=4.0,
        stuck=(1,),
        own_behaviours=True,
        trials=6,
        steps=40,
    )
    trials = family.generate()
    np.testing.assert_array_equal(np.bincount(trials.network), [24, 24, 24])
    np.testing.assert_array_equal(np.bincount(trials.repetition), [36, 36])
    passed = np.mean(trials.lengths.reshape(12, 2, 3) == 60, axis=1)  # stuck until the time is up
    # The boundary at 5.5 is shifted by -2, 0 and 2 variants, without a transition: all at once.
    for network, boundary in enumerate((3.5, 5.5, 7.5)):
        np.testing.assert_array_equal(passed[:, network], np.arange(12) > boundary)


def test_identical_recordings_do_not_make_everything_abrupt():
    distances = np.zeros((6, 6))
    assert group_variants(distances, AnalysisConfig()).max() == 0


def test_no_scatter_between_alike_variants_is_an_abrupt_change():
    # Two runs of five, 0.02 apart inside and 0.2 from each other: nearly the same behaviour.
    place = np.r_[0.02 * np.arange(5), 0.28 + 0.02 * np.arange(5)]
    distances = np.abs(place[:, None] - place)
    assert group_variants(distances, AnalysisConfig(alike_distance=0.0)).max() == 1
    assert group_variants(distances, AnalysisConfig()).max() == 0


def test_an_alike_distance_is_the_smallest_usual_gap():
    distances = from_positions([0.0, 0.2, 0.4, 20.0, 20.2, 20.4])
    dendrogram = build_dendrogram(distances, "single")
    found = abruptness(dendrogram, distances, 0.3)[-1]
    # −ln(1 − D²) of D = 0.3 is −ln 0.91.
    expected = separation(distances)[2, 3] / np.sqrt(-np.log(0.91))
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("seed", [1, 2])
def test_long_recordings_of_drifting_behaviours_keep_their_groups(seed):
    # Sixty trials a variant: gaps within groups are small, and their scatter is what remains.
    family = SyntheticFamily(sizes=(13, 13, 4), separation=6.0, trials=60, steps=1000, seed=seed)
    assert groups_of(family).tolist() == family.labels.tolist()


def test_fixed_count_gives_the_number_asked_for():
    config = AnalysisConfig(cut="fixed count", group_count=4)
    distances = from_positions(np.arange(12.0))
    cut = cut_dendrogram(build_dendrogram(distances, "average"), distances, config)
    assert cut.labels.max() == 3


@pytest.mark.parametrize("cut", ["largest gap", "silhouette"])
def test_other_rules_find_two_far_apart_runs(cut):
    distances = from_positions([0.0, 0.2, 0.4, 30.0, 30.2, 30.4], noise=0.05)
    assert group_variants(distances, AnalysisConfig(cut=cut)).tolist() == [0, 0, 0, 1, 1, 1]


@given(seed=seeds, n=st.integers(4, 20))
@settings(max_examples=40)
def test_silhouette_is_that_of_scikit_learn(seed, n):
    rng = np.random.default_rng(seed)
    distances = from_positions(10.0 * rng.random(n))
    labels = rng.integers(0, 3, n)
    labels[:3] = 0, 1, 2
    _, labels = np.unique(labels, return_inverse=True)
    if labels.max() + 1 >= n:
        return
    theirs = silhouette_score(distances, labels, metric="precomputed")
    assert mean_silhouette(distances, labels) == pytest.approx(theirs, abs=1e-9)


@given(seed=seeds, n=st.integers(1, 20), k=st.integers(1, 5))
@settings(max_examples=80)
def test_adjusted_rand_index_is_that_of_scikit_learn(seed, n, k):
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, k, n), rng.integers(0, k, n)
    assert adjusted_rand(a, b) == pytest.approx(adjusted_rand_score(a, b), abs=1e-12)
