"""Each figure's data against numbers recomputed from the artefacts by other libraries."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import polars as pl
import pytest
import scipy.stats
from matplotlib.cbook import boxplot_stats
from scipy.cluster import hierarchy
from synthetic_trials import SyntheticFamily

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.determination import determine_curriculum
from surmount.analysis.result import Analysis
from surmount.core.records import read_record
from surmount.report.contents import document_of
from surmount.report.figures.curves import running_mean
from surmount.report.figures.dendrogram_layout import layout
from surmount.report.figures.fit import mixture_fit
from surmount.report.figures.learning import DECISIONS
from surmount.report.figures.path import box_of
from surmount.report.pages import write_analysis_report
from surmount.report.results import read_run
from surmount.report.sections.grouping import grouping_section
from surmount.workflow.run_layout import TRIALS

EXACT = 1e-12
"""The same numbers, but for the order of summation."""
DRAWN = 1e-4
"""Drawn numbers have five significant digits."""


def rows_of(chart, *, panel, layer):
    """Return the rows that a layer of a panel draws."""
    record = chart.to_dict()
    drawn = record["concat"][panel]
    return record["datasets"][(drawn["layer"][layer].get("data") or drawn["data"])["name"]]


@pytest.fixture(scope="module")
def trials(reported) -> pl.DataFrame:
    """Return one row per trial with its group, from the Parquet files alone."""
    curriculum = read_record(reported.stages["analysis"].path("curriculum.json"))
    groups = {
        variant[0]: group["name"] for group in curriculum["groups"] for variant in group["variants"]
    }
    parts = [
        pl.read_parquet(artefact.path("trials.parquet")).with_columns(stage=pl.lit(kind))
        for kind, stage in TRIALS.items()
        for name, artefact in reported.stages.items()
        if name.startswith(f"{stage}/")
    ]
    by = ["stage", "variant.height_mm", "network", "trial"]
    return (
        pl.concat(parts)
        .group_by(by, maintain_order=True)
        .agg(
            pl.col("success").first(),
            pl.col("time_s").last(),
            sprawl=pl.col("sprawl_deg").diff().abs().sum(),
            fbem=pl.col("fbem_deg").diff().abs().sum(),
        )
        .with_columns(group=pl.col("variant.height_mm").replace_strict(groups))
    )


def test_figure_5_shows_the_recorded_and_sampled_points_of_the_analysis(reported):
    analysis = read_record(reported.stages["analysis"].path("analysis.json"))
    rows = reported.rows("figure-5-mixture-fit")
    for kind in ("recorded", "sampled"):
        shown = [
            [float(row[name]) for name in ("time_s", "sprawl_deg", "fbem_deg", "distance_m")]
            for row in rows
            if row["kind"] == kind
        ]
        assert shown == analysis[kind]


def test_figure_5_shows_the_bic_curve_where_k_was_chosen_by_it(trials_analysis):
    figure = mixture_fit(trials_analysis)
    curve = trials_analysis.bic
    shown = [value for value in figure.data["bic"] if value is not None]
    assert shown == list(curve.values)
    line = rows_of(figure.chart, panel=-1, layer=0)
    assert [row["x"] for row in line] == list(curve.components)
    assert np.allclose([1000 * row["y"] for row in line], curve.values, rtol=DRAWN)
    assert f"K = {curve.chosen} was taken" in " ".join(figure.caption)


@pytest.fixture(scope="module")
def trials_analysis() -> Analysis:
    family = SyntheticFamily(sizes=(3, 3), behaviours=(0, 1), trials=6, steps=30)
    config = AnalysisConfig(max_components=4, bootstrap=0, scatter_samples=20)
    return determine_curriculum(family.generate(), config)


def test_figure_6_shows_the_distances_and_links_of_the_analysis(reported):
    analysis = read_record(reported.stages["analysis"].path("analysis.json"))
    rows = reported.rows("figure-6-distances-and-groups")
    labels = [f"{variant[0]:g}" for variant in analysis["variants"]]
    shown = {
        (row["first"], row["second"]): float(row["distance"])
        for row in rows
        if row["kind"] == "distance"
    }
    assert shown == {
        (a, b): analysis["distances"][i][j]
        for i, a in enumerate(labels)
        for j, b in enumerate(labels)
    }
    links = [row for row in rows if row["kind"] == "link"]
    assert [float(row["distance"]) for row in links] == [link[2] for link in analysis["linkage"]]
    assert [row["divided"] == "true" for row in links] == analysis["cut"]["divided"]


def test_success_and_stability_are_those_of_trials_and_replicates(reported, trials):
    analysis = read_record(reported.stages["analysis"].path("analysis.json"))
    rows = reported.rows("success-and-stability")
    shown = {float(row["first"]): row for row in rows if row["kind"] == "variant"}
    initiation = trials.filter(pl.col("stage") == "initiation").group_by("variant.height_mm")
    for variant, won, tried in initiation.agg(
        pl.col("success").sum(), pl.len().alias("trials")
    ).iter_rows():
        row = shown[variant]
        assert (int(row["trials"]), float(row["success"])) == (tried, pytest.approx(won / tried))
        wilson = scipy.stats.binomtest(won, tried).proportion_ci(method="wilson")
        assert float(row["lower"]) == pytest.approx(wilson.low, abs=EXACT)
        assert float(row["upper"]) == pytest.approx(wilson.high, abs=EXACT)
    pairs = [float(row["together"]) for row in rows if row["kind"] == "pair"]
    assert pairs == list(itertools.chain(*analysis["stability"]["co_membership"]))
    between = [row["boundary_after"] for row in rows if row["kind"] == "variant"]
    assert [float(share) for share in between[:-1]] == analysis["stability"]["boundaries"]
    assert between[-1] == ""


def test_the_dendrogram_is_scipys_with_the_groups_below_the_cut(reported):
    analysis = Analysis.load(reported.stages["analysis"].path("analysis.json"))
    drawn = layout(analysis)
    scipys = hierarchy.dendrogram(analysis.linkage, no_plot=True)
    ours = sorted(sorted([left, right, top]) for left, right, top in drawn.heights.tolist())
    theirs = sorted(sorted([d[0], d[1], d[3]]) for d in scipys["dcoord"])
    assert np.allclose(ours, theirs, rtol=0, atol=EXACT)
    assert sorted(drawn.leaves.tolist()) == list(range(12))
    # A horizontal cut there gives the groups again, whatever their names.
    flat = hierarchy.fcluster(analysis.linkage, drawn.cut_height, criterion="distance")
    pairs = flat[:, None] == flat
    assert (pairs == (analysis.cut.labels[:, None] == analysis.cut.labels)).all()
    # Links do not cross: below each link stands an unbroken run of leaves.
    place = np.argsort(drawn.leaves)
    for link in range(11):
        below = np.sort(place[analysis.dendrogram.leaves(12 + link)])
        assert (np.diff(below) == 1).all()


def test_figure_7_shows_every_rollout_and_every_level_test(reported):
    rows = reported.rows("figure-7-learning-curves")
    for network in ("0", "1"):
        offset = 0
        for kind in ("initiation", "curriculum", "control"):
            artefact = reported.stages[f"{kind}/network-{network}"]
            history = pl.read_parquet(artefact.path("history.parquet"))
            shown = [
                (int(row["steps"]), float(row["reward"]))
                for row in rows
                if (row["kind"], row["network"], row["stage"]) == ("rollout", network, kind)
            ]
            assert shown == [(offset + s, r) for s, r in history["steps", "reward"].iter_rows()]
            if kind == "initiation":
                offset = int(history["steps"][-1])
        tests = read_record(reported.stages[f"curriculum/network-{network}"].path("training.json"))[
            "level_tests"
        ]
        shown = [row for row in rows if (row["kind"], row["network"]) == ("level test", network)]
        assert len(shown) == len(tests) > 0
        for row, test in zip(shown, tests, strict=True):
            assert int(row["steps"]) == offset + test["steps"]
            assert row["decision"] == test["decision"]
            for name in ("first_window", "last_window", "first_gain", "newest_gain", "threshold"):
                assert float(row[name]) == test[name]
            assert float(row["ratio"]) == test["ratio"]


def test_figure_7_marks_each_test_where_it_was_made(reported):
    document = document_of(read_run(reported.root))
    figure = next(f for f in document.figures() if f.name == "figure-7-learning-curves")
    tests = [row for row in reported.rows(figure.name) if row["kind"] == "level test"]
    for network in range(2):
        marks = rows_of(figure.chart, panel=network, layer=-1)
        own = [row for row in tests if row["network"] == str(network)]
        assert [mark["x"] for mark in marks] == [int(row["steps"]) for row in own]
        for mark, row in zip(marks, own, strict=True):
            assert f"{float(row['ratio']):.3f}" in mark["ratio of eq 5"]
            assert mark["decision"] == DECISIONS[row["decision"]].name


def test_the_running_mean_is_that_of_neighbours_of_the_same_level():
    rng = np.random.default_rng(0)
    values, part = rng.standard_normal(30), np.repeat([0, 1, 2], [4, 17, 9])
    expected = [
        np.mean([v for j, v in enumerate(values) if abs(i - j) <= 2 and part[j] == part[i]])
        for i in range(30)
    ]
    assert np.allclose(running_mean(values, 5, part), expected, rtol=0, atol=EXACT)


def test_figure_8_shows_counts_wilson_intervals_and_tests(reported, trials):
    rows = [row for row in reported.rows("figure-8-success") if not row["network"]]
    counts = {
        (stage, group): (won, tried)
        for stage, group, won, tried in trials.group_by("stage", "group")
        .agg(pl.col("success").sum(), tried=pl.len())
        .iter_rows()
    }
    assert len(rows) == len(counts) == 9
    for row in rows:
        won, tried = counts[row["stage"], row["group"]]
        assert (int(row["successes"]), int(row["trials"])) == (won, tried)
        wilson = scipy.stats.binomtest(won, tried).proportion_ci(method="wilson")
        # SciPy does not round the limits at 0 and 1 to these.
        assert float(row["lower"]) == pytest.approx(wilson.low, abs=1e-9)
        assert float(row["upper"]) == pytest.approx(wilson.high, abs=1e-9)
    for group in ("medium", "difficult"):
        table = np.array([counts[arm, group] for arm in ("curriculum", "control")])
        table[:, 1] -= table[:, 0]
        scipys = scipy.stats.chi2_contingency(table, correction=True)
        shown = [row for row in rows if row["group"] == group and row["chi_square"]]
        assert len(shown) == 2
        for row in shown:
            assert float(row["chi_square"]) == pytest.approx(scipys.statistic, rel=1e-9)
            assert float(row["p_value"]) == pytest.approx(scipys.pvalue, rel=1e-9)


def test_figure_8_shows_each_networks_own_rate(reported, trials):
    rates = trials.group_by("stage", "group", "network").agg(pl.col("success").mean())
    expected = {(s, g, str(n)): r for s, g, n, r in rates.iter_rows()}
    shown = {
        (row["stage"], row["group"], row["network"]): float(row["rate"])
        for row in reported.rows("figure-8-success")
        if row["network"]
    }
    assert shown == pytest.approx(expected, abs=EXACT)


def test_the_bars_on_the_screen_are_those_of_the_data(reported):
    document = document_of(read_run(reported.root))
    figure = next(f for f in document.figures() if f.name == "figure-8-success")
    bars = rows_of(figure.chart, panel=0, layer=0)
    rows = [row for row in reported.rows(figure.name) if not row["network"]]
    for stage in ("initiation", "curriculum", "control"):
        shown = [bar for bar in bars if bar["series"] == stage]
        own = [row for row in rows if row["stage"] == stage]
        for drawn, written in (("y", "rate"), ("lower", "lower"), ("upper", "upper")):
            expected = [float(row[written]) for row in own]
            assert np.allclose([bar[drawn] for bar in shown], expected, rtol=DRAWN)


def test_figure_8b_shows_scipys_survival_function(reported, trials):
    rows = reported.rows("figure-8b-survival")
    for arm in ("curriculum", "control"):
        for group in ("easy", "medium", "difficult"):
            own = trials.filter(stage=arm, group=group)
            time, won = own["time_s"].to_numpy(), own["success"].to_numpy()
            shown = [row for row in rows if (row["arm"], row["group"]) == (arm, group)]
            at = [float(row["time_s"]) for row in shown]
            if won.any():
                data = scipy.stats.CensoredData.right_censored(time, ~won)
                # Times that differ by rounding alone are one time in ours: look just after it.
                expected = scipy.stats.ecdf(data).sf.evaluate(np.asarray(at) + 1e-6)
            else:
                expected = np.ones(len(at))
            assert np.allclose([float(row["survival"]) for row in shown], expected, atol=1e-9)


def test_figure_9_shows_the_path_length_of_every_successful_trial(reported, trials):
    shown = {
        (row["arm"], row["variant.height_mm"], row["network"], row["trial"]): (
            float(row["path_length.sprawl_deg"]),
            float(row["path_length.fbem_deg"]),
        )
        for row in reported.rows("figure-9-path-lengths")
    }
    won = trials.filter(pl.col("success") & (pl.col("stage") != "initiation"))
    expected = {
        (row["stage"], str(row["variant.height_mm"]), str(row["network"]), str(row["trial"])): (
            row["sprawl"],
            row["fbem"],
        )
        for row in won.iter_rows(named=True)
    }
    assert shown.keys() == expected.keys()
    for key, lengths in shown.items():
        assert lengths == pytest.approx(expected[key], rel=1e-9)


def test_boxes_are_tukeys():
    rng = np.random.default_rng(1)
    for size in (1, 2, 7, 100):
        values = rng.standard_cauchy(size)
        ours, (theirs,) = box_of(values), boxplot_stats(values)
        assert (ours.low, ours.q1, ours.median, ours.q3, ours.high) == pytest.approx(
            tuple(theirs[name] for name in ("whislo", "q1", "med", "q3", "whishi")), abs=EXACT
        )
        assert sorted(ours.beyond) == pytest.approx(sorted(theirs["fliers"]))


def test_figure_10_shows_success_on_every_variant(reported, trials):
    counts = trials.group_by("stage", "variant.height_mm").agg(
        pl.col("success").sum(), tried=pl.len()
    )
    expected = {(s, str(v)): (w, n) for s, v, w, n in counts.iter_rows()}
    rows = reported.rows("figure-10-success-by-variant")
    shown = {
        (row["stage"], row["variant.height_mm"]): (int(row["successes"]), int(row["trials"]))
        for row in rows
    }
    assert len(rows) == 36
    assert shown == expected


@pytest.mark.parametrize("features", [1, 4])
def test_trials_of_any_task_have_figures(tmp_path, features):
    generated = SyntheticFamily(sizes=(4, 4), behaviours=(0, 1), trials=4, steps=30).generate()
    size = generated.variant[:, 0]
    trials = dataclasses.replace(
        generated,
        parameters=("height_mm", "$friction$"),
        axes=(),
        variant=np.stack([100 + 100 * (size >= 140), size % 40 / 100], axis=1),
        feature_names=generated.feature_names[:features],
        features=generated.features[:, :features],
    )
    analysis = determine_curriculum(trials, AnalysisConfig(components=2, bootstrap=0))
    write_analysis_report(analysis.to_record(), tmp_path)
    text = (tmp_path / "figures" / "figure-5-mixture-fit.csv").read_text(encoding="utf-8")
    assert text.splitlines()[0].split(",")[1 : 1 + features] == list(analysis.features.names)
    assert text.count("\nsampled,") == len(analysis.sampled)
    section = grouping_section(analysis)
    (levels,) = [b for b in section.blocks if b.kind == "table" and b.label == "Table 2"]
    assert " cells within " in levels.rows[0][1]
