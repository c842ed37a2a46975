"""From trials to samples: thinning, scaling, dropping, principal components."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from sklearn.decomposition import PCA
from synthetic_trials import SyntheticFamily

from surmount import AnalysisConfig, Trials, determine_curriculum
from surmount.analysis.features import variant_samples
from surmount.core.errors import InputError

FAMILY = SyntheticFamily(sizes=(3, 3), behaviours=(0, 1), separation=8.0, trials=8, steps=50)
QUICK = AnalysisConfig(components=3, restarts=1, bootstrap=0, sensitivity=False)


def with_features(trials: Trials, features: np.ndarray, names: tuple[str, ...]) -> Trials:
    return dataclasses.replace(trials, features=features, feature_names=names)


def test_samples_of_all_variants_together_are_standardised():
    data = variant_samples(FAMILY.generate(), AnalysisConfig())
    z = np.concatenate(data.samples)
    np.testing.assert_allclose(z.mean(axis=0), 0.0, atol=1e-10)
    np.testing.assert_allclose(z.std(axis=0), 1.0, atol=1e-10)


def test_samples_and_their_trials_stay_together():
    trials = FAMILY.generate()
    data = variant_samples(trials, AnalysisConfig())
    scaling = data.features.scaling
    for samples, origin in zip(data.samples, data.trial, strict=True):
        row = samples[5] * scaling.scale + scaling.centre
        own = slice(trials.starts[origin[5]], trials.starts[origin[5] + 1])
        assert np.abs(trials.features[own] - row).sum(axis=1).min() < 1e-9


def test_thinning_keeps_every_trial_and_about_the_number_asked_for():
    trials = FAMILY.generate()
    data = variant_samples(trials, AnalysisConfig(max_samples=60))
    for samples, origin, recorded, stride in zip(
        data.samples, data.trial, data.n_recorded, data.stride, strict=True
    ):
        assert np.unique(origin).size == 8
        assert recorded / stride <= 60
        assert samples.shape[0] == pytest.approx(recorded / stride, abs=8)


def test_success_is_the_mean_over_trials_of_all_networks():
    trials = FAMILY.generate()
    data = variant_samples(trials, AnalysisConfig())
    for variant, rate in zip(data.variants, data.success_rate, strict=True):
        own = (trials.variant == variant).all(axis=1)
        assert rate == pytest.approx(trials.success[own].mean(), abs=1e-12)


def test_constant_features_are_dropped_and_named():
    trials = FAMILY.generate()
    constant = np.full((trials.n_samples, 1), 0.1 + 0.2)
    wider = with_features(
        trials, np.hstack([trials.features, constant]), (*trials.feature_names, "gear_nm")
    )
    analysis = determine_curriculum(wider, QUICK)
    assert analysis.features.dropped == ("gear_nm",)
    assert any("gear_nm" in warning for warning in analysis.warnings)
    plain = determine_curriculum(trials, QUICK)
    np.testing.assert_allclose(analysis.distances, plain.distances, atol=1e-9)


def test_principal_components_explain_the_variance_that_scikit_learn_says():
    trials = FAMILY.generate()
    rng = np.random.default_rng(0)
    mixed = trials.features @ rng.standard_normal((4, 12))
    names = tuple(f"x{i}" for i in range(12))
    data = variant_samples(with_features(trials, mixed, names), AnalysisConfig())
    z = (mixed - mixed.mean(axis=0)) / mixed.std(axis=0)
    theirs = np.cumsum(PCA().fit(z).explained_variance_ratio_)
    kept = len(data.features.names)
    assert data.features.reduced
    assert theirs[kept - 1] >= 0.99 > (theirs[kept - 2] if kept > 1 else 0.0)
    assert data.features.explained_variance == pytest.approx(theirs[kept - 1], abs=1e-9)


def test_mixing_the_features_into_many_leaves_the_groups():
    trials = FAMILY.generate()
    mixed = trials.features @ np.random.default_rng(1).standard_normal((4, 12))
    names = tuple(f"x{i}" for i in range(12))
    analysis = determine_curriculum(with_features(trials, mixed, names), QUICK)
    assert analysis.labels.tolist() == FAMILY.labels.tolist()


def test_named_features_alone_are_used():
    config = dataclasses.replace(QUICK, features=("time_s", "distance_mm"))
    analysis = determine_curriculum(FAMILY.generate(), config)
    assert analysis.features.logged == ("time_s", "distance_mm")
    assert analysis.mixtures[0].n_features == 2


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda x: np.where(x > x.mean(), np.nan, x), "NaN or infinite"),
        (lambda x: np.where(x > x.mean(), 1e200, x), "NaN or infinite"),
        (np.ones_like, "No feature varies"),
    ],
)
def test_useless_features_are_refused_with_a_remedy(change, words):
    trials = FAMILY.generate()
    broken = with_features(trials, change(trials.features), trials.feature_names)
    with pytest.raises(InputError, match=words) as caught:
        determine_curriculum(broken, QUICK)
    assert caught.value.remedy


def test_an_unknown_feature_is_refused_naming_the_known_ones():
    config = dataclasses.replace(QUICK, features=("speed",))
    with pytest.raises(InputError, match="time_s"):
        determine_curriculum(FAMILY.generate(), config)
