"""Trials at the edge of what can be analysed: a defined result or a clear error, never NaN."""

from __future__ import annotations

import dataclasses
import json
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import seeds

from surmount import Analysis, AnalysisConfig, Trials, determine_curriculum
from surmount.analysis.explanation import explain_analysis
from surmount.core.errors import ConfigError, InputError
from surmount.trials.table import trials_from_table

QUICK = AnalysisConfig(
    components=3, restarts=1, bootstrap=3, bootstrap_samples=50, min_samples_per_component=5
)


def trials_of(features: np.ndarray, n_variants: int, n_trials: int, success=None) -> Trials:
    """Trials of equal length from rows of features."""
    total = n_variants * n_trials
    steps = features.shape[0] // total
    return Trials(
        parameters=("size_mm",),
        feature_names=tuple(f"x{i}" for i in range(features.shape[1])),
        variant=np.repeat(np.arange(float(n_variants)), n_trials)[:, None],
        network=np.zeros(total, dtype=np.int64),
        repetition=np.tile(np.arange(n_trials), n_variants),
        success=np.zeros(total, dtype=np.bool_) if success is None else success,
        starts=steps * np.arange(total + 1),
        features=features[: steps * total],
    )


def sound(analysis: Analysis) -> Analysis:
    """Check that every number is finite, and that record and words can be made."""
    json.dumps(analysis.to_record(), allow_nan=False)
    assert analysis.distances.min() >= 0.0
    assert analysis.distances.max() <= 1.0
    assert all(weight > 0 for mixture in analysis.mixtures for weight in mixture.weights)
    assert explain_analysis(analysis)
    return analysis


@pytest.mark.parametrize("value", [False, True])
def test_all_trials_failing_or_succeeding_is_a_defined_result(value):
    x = np.random.default_rng(0).standard_normal((4 * 5 * 20, 2))
    analysis = sound(determine_curriculum(trials_of(x, 4, 5, np.full(20, value)), QUICK))
    assert analysis.curriculum.n_levels == (0 if value else len(analysis.groups))


def test_a_robot_that_never_moves_on_one_variant_is_told_apart():
    rng = np.random.default_rng(1)
    x = rng.standard_normal((8, 100, 2))
    x[4:] = 0.5  # exactly still on four variants
    analysis = sound(determine_curriculum(trials_of(x.reshape(-1, 2), 8, 5), QUICK))
    assert analysis.labels.tolist() == [0, 0, 0, 0, 1, 1, 1, 1]
    assert analysis.mixtures[5].fit.floored >= 1
    assert analysis.mixtures[5].fit.collapsed == 2


def test_a_robot_that_never_moves_but_for_the_clock_is_a_defined_result():
    x = np.zeros((3 * 4 * 30, 3))
    x[:, 0] = np.tile(0.1 * np.arange(30), 12)
    analysis = sound(determine_curriculum(trials_of(x, 3, 4), QUICK))
    assert analysis.features.logged == ("x0",)
    assert len(analysis.groups) == 1


def test_identical_recordings_on_all_variants_form_one_group():
    x = np.tile(np.random.default_rng(2).standard_normal((100, 2)), (6, 1))
    analysis = sound(determine_curriculum(trials_of(x, 6, 5), QUICK))
    assert analysis.distances.max() < 1e-6
    assert len(analysis.groups) == 1


def test_a_variant_with_few_samples_gets_fewer_components_and_a_warning():
    rng = np.random.default_rng(3)
    trials = trials_of(rng.standard_normal((4 * 4 * 10, 2)), 4, 4)
    keep = ~((trials.variant[:, 0] == 2.0) & (trials.repetition > 0))
    analysis = sound(determine_curriculum(trials.select(keep), QUICK))
    assert [m.fit.requested for m in analysis.mixtures] == [3, 3, 2, 3]
    assert any("enough samples for 3 components" in warning for warning in analysis.warnings)


def test_a_variant_with_hardly_a_sample_is_refused_by_name():
    trials = trials_of(np.random.default_rng(4).standard_normal((3 * 2 * 4, 2)), 3, 2)
    keep = ~((trials.variant[:, 0] == 1.0) & (trials.repetition > 0))
    with pytest.raises(InputError, match="Variant 1 has 4 samples"):
        determine_curriculum(trials.select(keep), QUICK)


def test_two_variants_are_enough():
    x = np.random.default_rng(5).standard_normal((2, 100, 2)) + np.array([0.0, 20.0])[:, None, None]
    analysis = sound(determine_curriculum(trials_of(x.reshape(-1, 2), 2, 5), QUICK))
    assert len(analysis.groups) == 1  # both are small groups: there is no neighbour to stay apart


def test_several_parameters_sample_cells():
    rng = np.random.default_rng(6)
    x = rng.standard_normal((12, 60, 2))
    x[6:] += 30.0
    trials = trials_of(x.reshape(-1, 2), 12, 3)
    grid = np.stack([np.repeat([0.0, 1.0, 2.0, 5.0, 6.0, 7.0], 2), np.tile([0.5, 1.0], 6)], axis=1)
    wide = dataclasses.replace(
        trials,
        parameters=("height_mm", "friction"),
        axes=(),
        variant=np.repeat(grid, 3, axis=0),
    )
    analysis = sound(determine_curriculum(wide, QUICK))
    assert analysis.labels.tolist() == [0] * 6 + [1] * 6
    tasks = analysis.curriculum.sample(1, np.random.default_rng(0), 500)
    assert ((tasks >= [0.0, 0.5]) & (tasks <= [7.0, 1.0])).all()
    assert np.mean(tasks[:, 0] > 3.5) == pytest.approx(0.7, abs=0.1)  # 5 standard errors


@pytest.mark.parametrize("harder", [(0,), (2,), (1, -1, 3)])
def test_directions_of_difficulty_are_one_or_minus_one(harder):
    with pytest.raises(ConfigError, match="`harder` is"):
        AnalysisConfig(harder=harder)


def test_directions_of_difficulty_must_be_as_many_as_task_parameters():
    trials = trials_of(np.random.default_rng(0).standard_normal((4 * 3 * 10, 2)), 4, 3)
    with pytest.raises(InputError, match="gives 2 directions, but the trials have 1"):
        determine_curriculum(trials, dataclasses.replace(QUICK, harder=(1, 1)))


def test_a_bic_variant_that_was_not_recorded_is_refused():
    trials = trials_of(np.random.default_rng(7).standard_normal((200, 2)), 2, 5)
    with pytest.raises(InputError, match="not among the recorded"):
        determine_curriculum(trials, dataclasses.replace(QUICK, bic_variant=(55.0,)))


@settings(max_examples=20)
@given(
    seed=seeds,
    shape=st.tuples(st.integers(2, 5), st.integers(1, 3), st.integers(5, 12), st.integers(1, 3)),
    kind=st.sampled_from(["normal", "integers", "tiny", "huge", "offset", "ties"]),
)
def test_any_finite_trials_give_a_sound_analysis(seed, shape, kind):
    rng = np.random.default_rng(seed)
    n_variants, n_trials, steps, d = shape
    x = rng.standard_normal((n_variants * n_trials * steps, d))
    x = {
        "normal": x,
        "integers": np.round(x),
        "tiny": 1e-90 * x,
        "huge": 1e90 * x,
        "offset": 1e9 + 1e-3 * x,
        "ties": (x > 0).astype(float),
    }[kind]
    if (np.ptp(x, axis=0) == 0).all():
        return
    sound(determine_curriculum(trials_of(x, n_variants, n_trials), QUICK))


FIELDS = [field.name for field in dataclasses.fields(AnalysisConfig)]
TRIALS = trials_of(np.random.default_rng(8).standard_normal((4 * 3 * 10, 2)), 4, 3)


@settings(max_examples=60)
@given(
    name=st.sampled_from(FIELDS),
    value=st.one_of(
        st.integers(-3, 30), st.floats(), st.sampled_from(["ward", "single", "silhouette", "x"])
    ),
)
def test_any_option_is_refused_or_gives_a_sound_analysis(name, value):
    if name in ("features", "bic_variant", "harder", "components_per_variant", "sensitivity"):
        return  # tuples and switches, typed when a configuration is read
    if isinstance(getattr(AnalysisConfig(), name), int) and isinstance(value, float):
        return  # whole numbers, typed when a configuration is read
    try:
        config = dataclasses.replace(QUICK, **{name: value})
    except ConfigError:
        return
    try:
        analysis = determine_curriculum(TRIALS, config)
    except InputError:
        return
    sound(analysis)


@pytest.mark.parametrize("outlier", [1e6, 1e99])
def test_a_value_beside_which_all_others_vanish_is_told(outlier):
    rng = np.random.default_rng(0)
    features = rng.normal(size=(4 * 5 * 20, 2))
    features[7, 1] = outlier
    analysis = sound(determine_curriculum(trials_of(features, 4, 5), QUICK))
    (warning,) = [text for text in analysis.warnings if "next to nothing" in text]
    assert f"`x1` (one is {outlier:g})" in warning
    features[7, 1] = 5.0  # far out, and one of many
    analysis = determine_curriculum(trials_of(features, 4, 5), QUICK)
    assert not [text for text in analysis.warnings if "next to nothing" in text]


@pytest.mark.parametrize("n_variants", [2, 3, 4])
def test_too_few_variants_for_a_cut_are_told(n_variants):
    features = np.random.default_rng(0).normal(size=(n_variants * 5 * 20, 2))
    analysis = sound(determine_curriculum(trials_of(features, n_variants, 5), QUICK))
    told = [text for text in analysis.warnings if "cannot be cut by the rule" in text]
    assert len(told) == (n_variants < 4)
    assert any("No abrupt change" in text for text in analysis.warnings) == (n_variants == 4)


def test_the_work_grows_with_the_number_of_columns_and_not_with_its_square():
    """Of 20,000 columns, reading the table took 78 s."""

    def seconds(n_columns: int) -> float:
        ids = {"variant": np.repeat([0.0, 1.0], 4), "network": np.zeros(8), "success": np.ones(8)}
        table = {**ids, "trial": np.repeat(np.arange(4), 2)}
        table |= {f"x{index}": np.arange(8.0) for index in range(n_columns)}
        began = time.process_time()
        assert len(trials_from_table(table).feature_names) == n_columns
        return time.process_time() - began

    few = seconds(2_000)
    assert seconds(20_000) < 40.0 * few  # ten times the columns; its square would be a hundred
