"""The whole analysis on synthetic trials with known groups."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from synthetic_trials import SyntheticFamily

from surmount import Analysis, AnalysisConfig, Curriculum, Trials, determine_curriculum
from surmount.analysis.explanation import describe_bic_choice, explain_analysis
from surmount.core.errors import InputError
from surmount.report.figures.fit import mixture_fit

QUICK = AnalysisConfig(components=4, restarts=1, bootstrap=4, bootstrap_samples=200)
FAMILY = SyntheticFamily(sizes=(4, 5, 4), behaviours=(0, 1, 2), separation=8.0, steps=60, trials=12)


@pytest.fixture(scope="module")
def trials() -> Trials:
    return FAMILY.generate()


@pytest.fixture(scope="module")
def analysis(trials: Trials) -> Analysis:
    return determine_curriculum(trials, QUICK)


def test_well_separated_behaviours_become_the_groups(analysis: Analysis):
    assert analysis.labels.tolist() == FAMILY.labels.tolist()


def test_groups_are_ranked_by_measured_success(analysis: Analysis, trials: Trials):
    rates = [group.success_rate for group in analysis.groups]
    assert rates == sorted(rates, reverse=True)
    for group in analysis.groups:
        per_variant = [
            trials.success[(trials.variant == v).all(axis=1)].mean() for v in group.variants
        ]
        assert group.success_rate == pytest.approx(np.mean(per_variant), abs=1e-12)


def test_one_level_for_each_group_below_the_threshold(analysis: Analysis):
    below = [group.name for group in analysis.groups if group.success_rate < 0.95]
    assert [level.dominant for level in analysis.curriculum.levels] == below
    assert len(below) in (2, 3)


def test_record_survives_json_unchanged(analysis: Analysis):
    record = json.loads(json.dumps(analysis.to_record(), allow_nan=False))
    assert Analysis.from_record(record).to_record() == analysis.to_record()


def test_same_trials_and_seed_give_the_same_record(analysis: Analysis, trials: Trials):
    assert determine_curriculum(trials, QUICK).to_record() == analysis.to_record()


def test_number_of_threads_does_not_matter(analysis: Analysis, trials: Trials, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert determine_curriculum(trials, QUICK).to_record() == analysis.to_record()


def test_order_of_trials_does_not_matter(analysis: Analysis, trials: Trials):
    order = np.random.default_rng(1).permutation(trials.n_trials)
    parts = [trials.select(np.arange(trials.n_trials) == i) for i in order]
    shuffled = determine_curriculum(Trials.concatenate(parts), QUICK)
    # Sums over samples run in another order only where scaling is computed: rounding, no more.
    np.testing.assert_allclose(shuffled.distances, analysis.distances, atol=1e-6)
    assert shuffled.labels.tolist() == analysis.labels.tolist()


def test_names_of_variants_and_units_of_features_do_not_matter(analysis: Analysis, trials: Trials):
    mirrored = dataclasses.replace(
        trials,
        variant=-trials.variant,
        network=7 - trials.network,
        features=trials.features * [60.0, 0.01, -3.0, 1e3] + [5.0, 0.0, 1.0, -2.0],
    )
    found = determine_curriculum(mirrored, QUICK)
    # The sign of a feature changes the order of samples, so the starts are others.
    np.testing.assert_allclose(found.distances[::-1, ::-1], analysis.distances, atol=0.05)
    assert found.labels[::-1].tolist() == analysis.labels.tolist()
    rescaled = dataclasses.replace(mirrored, features=trials.features * [60.0, 0.01, 3.0, 1e3])
    found = determine_curriculum(rescaled, QUICK)
    np.testing.assert_allclose(found.distances[::-1, ::-1], analysis.distances, atol=1e-6)


@pytest.mark.parametrize(
    ("changes", "index", "why"),
    [
        ({}, 5, "that of the lowest success (0.0%)"),
        ({"harder": (1,)}, 12, "the hardest by the direction of difficulty (success 50.0%)"),
        ({"harder": (-1,)}, 0, "the hardest by the direction of difficulty (success 50.0%)"),
        ({"harder": (1,), "bic_variant": (3.0,)}, 3, "which the configuration names"),
    ],
)
def test_k_is_chosen_on_the_hardest_variant_and_the_analysis_says_why(trials, changes, index, why):
    # Variants 0 to 12; half of all trials succeed, but none on variant 5.
    variant = (trials.variant - trials.variant.min()) / 10.0
    success = trials.repetition % 2 == 0
    success &= variant[:, 0] != 5.0
    config = dataclasses.replace(
        QUICK, components=0, max_components=3, bootstrap=0, sensitivity=False, **changes
    )
    analysis = determine_curriculum(
        dataclasses.replace(trials, variant=variant, success=success),
        config,
    )
    assert analysis.bic_variant == index
    assert describe_bic_choice(analysis) == why
    assert any(why in line for line in explain_analysis(analysis))
    assert why in " ".join(mixture_fit(analysis).caption)
    record = analysis.to_record()
    assert describe_bic_choice(Analysis.from_record(record)) == why
    if not changes:
        del record["config"]["harder"]  # written before there was such an option
        assert describe_bic_choice(Analysis.from_record(record)) == why


def test_over_several_parameters_the_hardest_variant_is_the_corner_that_all_directions_point_to():
    variants = np.array([[a, b] for a in (1.0, 2.0, 4.0) for b in (0.0, 0.5, 0.6)])
    for harder, corner in (((1, 1), 8), ((-1, 1), 2), ((1, -1), 6)):
        rng = np.random.default_rng(0)
        trials = Trials(
            parameters=("a", "b"),
            feature_names=("x",),
            variant=np.repeat(variants, 2, axis=0),
            network=np.zeros(18, dtype=np.int64),
            repetition=np.tile([0, 1], 9),
            success=np.ones(18, dtype=np.bool_),
            starts=np.arange(19) * 60,
            features=rng.normal(size=(18 * 60, 1)),
        )
        found = determine_curriculum(
            trials, dataclasses.replace(QUICK, harder=harder, bootstrap=0, sensitivity=False)
        )
        assert found.bic_variant == corner


def test_all_groups_succeeding_gives_a_curriculum_without_levels(trials: Trials, tmp_path):
    everyone = Trials(
        parameters=trials.parameters,
        feature_names=trials.feature_names,
        variant=trials.variant,
        network=trials.network,
        repetition=trials.repetition,
        success=np.ones(trials.n_trials, dtype=np.bool_),
        starts=trials.starts,
        features=trials.features,
    )
    curriculum = determine_curriculum(everyone, QUICK).curriculum
    assert curriculum.n_levels == 0
    curriculum.save(tmp_path / "curriculum.json")
    assert Curriculum.load(tmp_path / "curriculum.json").n_levels == 0


def test_one_variant_is_refused_with_a_remedy(trials: Trials):
    only = trials.select((trials.variant == trials.variant[0]).all(axis=1))
    with pytest.raises(InputError, match="one variant only") as caught:
        determine_curriculum(only, QUICK)
    assert caught.value.remedy
