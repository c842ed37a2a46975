"""Bootstrap, sensitivity and the words for both."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from strategies import random_mixture
from synthetic_trials import SyntheticFamily

from surmount import Analysis, AnalysisConfig, determine_curriculum, hellinger
from surmount.analysis.description import describe_curriculum
from surmount.analysis.explanation import explain_analysis
from surmount.analysis.sensitivity import marginal
from surmount.analysis.stability import Stability, resampled

CLEAR = SyntheticFamily(sizes=(4, 4), behaviours=(0, 1), separation=10.0, trials=10, steps=50)
CONFIG = AnalysisConfig(components=4, restarts=1, bootstrap=20, bootstrap_samples=200)


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return determine_curriculum(CLEAR.generate(), CONFIG)


def test_clear_groups_are_stable(analysis: Analysis):
    stability = analysis.stability
    assert stability.same_count == 1.0
    assert stability.agreement == 1.0
    assert stability.boundaries.tolist() == [0, 0, 0, 1, 0, 0, 0]
    expected = (CLEAR.labels[:, None] == CLEAR.labels).astype(float)
    np.testing.assert_array_equal(stability.co_membership, expected)


def test_a_grouping_on_the_edge_of_the_cut_is_called_not_stable():
    gap = determine_curriculum(CLEAR.generate(), dataclasses.replace(CONFIG, bootstrap=0))
    edge = float(gap.cut.statistic.max())
    # Replicates scatter about the statistic divided by √2: see `assess_stability`.
    config = dataclasses.replace(CONFIG, cut_off=edge / np.sqrt(2.0))
    analysis = determine_curriculum(CLEAR.generate(), config)
    assert 0.0 < analysis.stability.same_count < 1.0
    assert analysis.stability.same_count < config.stability_threshold
    assert any("not stable" in warning for warning in analysis.warnings)


def test_resampling_draws_as_many_trials_of_each_variant_as_there_are():
    trials = CLEAR.generate()
    _, variant = trials.variants()
    counts = resampled(trials, np.random.default_rng(0))
    assert np.bincount(variant, weights=counts).tolist() == [10.0] * 8
    assert counts.max() > 1


def test_resampling_draws_networks_as_wholes():
    trials = CLEAR.generate()
    drawn = [resampled(trials, np.random.default_rng(seed)) for seed in range(40)]
    first = np.array([counts[trials.network == 0].sum() for counts in drawn]) / trials.n_trials
    # Of two networks drawn twice: none, one or two copies of the first, by 1/4, 1/2, 1/4.
    assert set(np.round(first, 6)) == {0.0, 0.5, 1.0}


def test_sensitivity_names_each_choice_and_judges_it_by_agreement(analysis: Analysis):
    rows = {(row.choice, row.value): row for row in analysis.sensitivity}
    assert rows["linkage", "ward"].agreement == 1.0
    assert rows["features", "without time_s"].n_groups == 2
    assert rows["regularisation", "0.01"].agreement == 1.0
    assert {row.choice for row in analysis.sensitivity} == {
        "linkage", "cut-off", "alike distance", "cut", "small groups", "features", "components",
        "regularisation", "networks",
    }  # fmt: skip


def test_a_boundary_of_one_network_shows_where_this_network_is_by_itself():
    family = dataclasses.replace(CLEAR, own_behaviours=True, steady_network=True)
    found = determine_curriculum(family.generate(), CONFIG)
    alone = {row.value: row.n_groups for row in found.sensitivity if row.choice == "networks"}
    assert alone == {"only 0": 2, "only 1": 1}


def test_shares_of_groups_are_means_over_pairs_of_variants():
    rng = np.random.default_rng(3)
    labels = np.array([0, 0, 1, 2, 1, 0, 1])
    square = rng.random((7, 7))
    stability = Stability(
        replicates=5,
        co_membership=(square + square.T) / 2,
        group_counts=((3, 1.0),),
        same_count=1.0,
        boundaries=np.ones(6),
        agreement=1.0,
    )
    within = {0: [], 1: [], 2: []}
    between = {(a, b): [] for a in range(3) for b in range(3) if a != b}
    for i, j in itertools.permutations(range(7), 2):
        shared = stability.co_membership[i, j]
        if labels[i] == labels[j]:
            within[labels[i]].append(shared)
        else:
            between[labels[i], labels[j]].append(shared)
    together = [np.mean(within[group] or [1.0]) for group in range(3)]
    apart = [1 - max(np.mean(between[a, b]) for b in range(3) if b != a) for a in range(3)]
    np.testing.assert_allclose(stability.together(labels), together, rtol=1e-12)
    np.testing.assert_allclose(stability.apart(labels), apart, rtol=1e-12)


def test_marginal_mixture_is_the_mixture_of_the_remaining_features():
    rng = np.random.default_rng(0)
    mixture = random_mixture(rng, 3, 3)
    kept = marginal(mixture, [0, 2])
    x = mixture.sample(rng, 100_000)[:, [0, 2]]
    centred = kept.means - kept.weights @ kept.means
    covariance = np.einsum("k,kij->ij", kept.weights, kept.covariances)
    covariance += (kept.weights[:, None] * centred).T @ centred
    # Standard errors are below 0.02; five of them.
    np.testing.assert_allclose(np.cov(x.T), covariance, atol=0.1)
    assert hellinger(kept, marginal(kept, [0, 1])) < 1e-7


def test_explanation_states_every_number_of_the_links(analysis: Analysis):
    text = "\n".join(explain_analysis(analysis))
    for height, statistic in zip(analysis.linkage[:, 2], analysis.cut.statistic, strict=True):
        assert f"{height:.3f}" in text
        assert f"{statistic:.2f}" in text
    assert text.count("divides\n") == 1
    assert "20 times" in text
    assert "a boundary in 100% of the replicates" in text


def test_description_states_groups_ranges_success_and_weights(analysis: Analysis):
    text = "\n".join(describe_curriculum(analysis.curriculum))
    for group in analysis.groups:
        assert group.name in text
        assert f"{group.success_rate:.1%}" in text
    assert "100–130 (4)" in text
    assert "100–135" in text
    assert f"{analysis.curriculum.n_levels} level" in text


def test_levels_taken_out_by_hand_are_not_explained_by_success(analysis: Analysis):
    curriculum = analysis.curriculum
    assert curriculum.n_levels == 1
    without = describe_curriculum(dataclasses.replace(curriculum, levels=()))
    assert without[-1] == "No levels."
    learnt = dataclasses.replace(curriculum, levels=(), success_threshold=0.0)
    assert describe_curriculum(learnt)[-1] == "No levels: every group reaches 0% success."
