"""Columns that are no behaviour: named, and no verdict that they alone hold up."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from synthetic_trials import SyntheticFamily

from surmount import Analysis, AnalysisConfig, Trials, determine_curriculum, read_trials
from surmount.analysis.explanation import explain_analysis
from surmount.analysis.trust import describe_trust, hanging, is_stable

CASES = Path(__file__).parents[1] / "trials" / "cases"
QUICK = AnalysisConfig(components=3, restarts=1, bootstrap=10, bootstrap_samples=200)
FAMILY = SyntheticFamily(sizes=(4, 4), behaviours=(0, 0), separation=6.0, trials=10, steps=50)


def with_feature(trials: Trials, name: str, values: np.ndarray) -> Trials:
    return dataclasses.replace(
        trials,
        feature_names=(*trials.feature_names, name),
        features=np.column_stack([trials.features, values]),
    )


@pytest.fixture(scope="module")
def clocked() -> Analysis:
    return determine_curriculum(read_trials(CASES / "clock_feature.csv.gz"))


def test_a_clock_that_makes_the_groups_is_named_and_they_are_not_called_stable(clocked):
    assert len(clocked.groups) == 2
    assert [(one.feature, one.kind, one.n_groups) for one in clocked.suspects] == [
        ("timestamp", "clock", 1)
    ]
    assert hanging(clocked) == ("timestamp",)
    assert is_stable(clocked) is False
    verdict = describe_trust(clocked)[0]
    assert "hang on `timestamp` alone: without it there is one group" in verdict
    assert "is stable" not in verdict
    said = " ".join(clocked.warnings)
    assert "`timestamp` rises over the whole table from trial to trial" in said
    assert "hang on `timestamp` alone" in "\n".join(explain_analysis(clocked))


def test_the_same_trials_without_the_clock_are_one_group():
    trials = read_trials(CASES / "clock_feature.csv.gz")
    names = tuple(name for name in trials.feature_names if name != "timestamp")
    alike = determine_curriculum(trials, AnalysisConfig(features=names))
    assert len(alike.groups) == 1
    assert alike.suspects == ()


def test_suspects_are_kept_in_the_record(clocked):
    again = Analysis.from_record(json.loads(json.dumps(clocked.to_record())))
    assert again.suspects == clocked.suspects
    old = clocked.to_record()
    for name in ("suspects", "notes", "network_names"):  # records of before
        del old[name]
    assert Analysis.from_record(old).suspects == ()


def ordered_by_variant(trials: Trials) -> np.ndarray:
    """A clock over trials that were made variant after variant."""
    assert (np.diff(trials.sample_variant()) >= 0).all()
    return np.arange(trials.n_samples, dtype=float)


@pytest.mark.parametrize("kind", ["two clocks", "counter", "task", "reduced"])
def test_clocks_counters_and_the_task_itself_are_found(kind):
    trials = FAMILY.generate()
    variant = trials.sample_variant().astype(float)
    far = np.where(variant < 4, variant, variant + 100.0)
    clock = ordered_by_variant(trials) + 1e6 * (variant >= 4)
    config = dataclasses.replace(QUICK, sensitivity=False)
    number = np.repeat(np.arange(float(trials.n_trials)), trials.lengths)
    added = {
        "two clocks": [("t", clock, "clock"), ("u", 3.0 * clock + 1.0, "clock")],
        "counter": [("n", number + 1e4 * (variant >= 4), "clock")],
        "task": [("size", far, "task")],
        "reduced": [("t", clock, "clock")],
    }[kind]
    if kind == "reduced":
        config = dataclasses.replace(config, reduction="pca")
    for name, values, _ in added:
        trials = with_feature(trials, name, values)
    found = determine_curriculum(trials, config)
    assert [(one.feature, one.kind) for one in found.suspects] == [
        (name, expected) for name, _, expected in added
    ]
    assert len(found.groups) == 2
    assert hanging(found) == tuple(name for name, *_ in added)
    assert is_stable(found) is False


def test_clocks_that_begin_anew_for_each_network_are_found_even_in_pairs():
    trials = FAMILY.generate()
    clock = np.empty(trials.n_samples)
    whose = np.repeat(trials.network, trials.lengths)
    late = 1e6 * (trials.sample_variant() >= 4)
    for network in np.unique(trials.network):
        clock[whose == network] = np.arange(float((whose == network).sum()))
    for name, values in {"session_s": clock + late, "seq": np.floor(10 * clock) + late}.items():
        trials = with_feature(trials, name, values)
    found = determine_curriculum(trials, dataclasses.replace(QUICK, sensitivity=False))
    assert [(one.feature, one.kind) for one in found.suspects] == [
        ("session_s", "network-clock"),
        ("seq", "network-clock"),
    ]
    assert hanging(found) == ("session_s", "seq")
    assert is_stable(found) is False
    said = " ".join(found.warnings)
    assert "`seq` rises within each network from trial to trial" in said
    assert Analysis.from_record(found.to_record()).suspects == found.suspects


def test_a_clock_in_one_network_of_several_is_none():
    trials = FAMILY.generate()
    rng = np.random.default_rng(0)
    clock = np.arange(float(trials.n_samples))
    first = np.repeat(trials.network, trials.lengths) == trials.network[0]
    values = np.where(first, clock, rng.normal(size=trials.n_samples))
    config = dataclasses.replace(QUICK, sensitivity=False)
    assert determine_curriculum(with_feature(trials, "t", values), config).suspects == ()


def test_a_feature_that_decides_alone_is_named_without_a_doubt_about_it():
    trials = FAMILY.generate()
    rng = np.random.default_rng(0)
    heading = 5.0 * (trials.sample_variant() >= 4) + rng.normal(size=trials.n_samples)
    found = determine_curriculum(with_feature(trials, "heading_rad", heading), QUICK)
    assert len(found.groups) == 2
    assert found.suspects == ()
    assert "hang on `heading_rad` alone" in describe_trust(found)[0]
    assert any("Without `heading_rad` all variants are one" in said for said in found.warnings)


def test_groups_of_behaviour_stay_stable_beside_a_clock():
    family = dataclasses.replace(FAMILY, behaviours=(0, 1), separation=10.0)
    trials = family.generate()
    found = determine_curriculum(with_feature(trials, "t", ordered_by_variant(trials)), QUICK)
    assert [one.kind for one in found.suspects] == ["clock"]
    assert hanging(found) == ()
    assert is_stable(found)


def test_names_of_networks_and_notes_of_reading_come_with_the_analysis():
    trials = dataclasses.replace(
        FAMILY.generate(), network_names=("run_a", "run_b", "c", "d"), notes=("Read so.",)
    )
    found = determine_curriculum(trials, QUICK)
    lines = "\n".join(explain_analysis(found))
    assert "networks (run_a, run_b" in lines
    assert "Read so." in found.warnings
    alone = [row.value for row in found.sensitivity if row.choice == "networks"]
    assert alone[:2] == ["only run_a", "only run_b"]


def test_progress_is_told_of_every_part_to_its_end():
    told: dict[str, list[tuple[int, int]]] = {}
    trials = FAMILY.generate()
    config = dataclasses.replace(QUICK, components=0, max_components=3)
    quiet = determine_curriculum(trials, config)
    loud = determine_curriculum(
        trials, config, progress=lambda part, done, of: told.setdefault(part, []).append((done, of))
    )
    assert list(told) == [
        "number of components", "mixtures", "distances", "bootstrap", "sensitivity"
    ]  # fmt: skip
    assert all(said[0][0] == 0 and said[-1][0] == said[-1][1] for said in told.values())
    assert told["bootstrap"][-1] == (10, 10)
    assert quiet.to_record() == loud.to_record()
