"""Charts from Python: of analyses, curricula and runs; without the extra a sentence tells of it."""

from __future__ import annotations

import itertools
import json

import pytest
from missing import take_away

import surmount
from surmount.analysis.result import Analysis
from surmount.core.errors import InputError, MissingExtraError
from surmount.report.figures.palette import DARK, GRID, INK, PAPER
from surmount.report.figures.stills import draw


@pytest.fixture(scope="module")
def analysis(reported) -> Analysis:
    return Analysis.load(reported.stages["analysis"].path("analysis.json"))


PLOTS = ("plot_dendrogram", "plot_distances", "plot_success", "plot_stability", "plot_fit")


@pytest.mark.parametrize("name", PLOTS)
def test_an_analysis_draws_itself_as_charts_that_save_themselves(analysis, name, tmp_path):
    chart = getattr(analysis, name)()
    path = tmp_path / "chart.svg"
    chart.save(str(path))
    assert path.read_text(encoding="utf-8").startswith("<svg")
    assert "vega" in str(chart._repr_mimebundle_(None, None)).lower()  # for a notebook


def test_a_curriculum_draws_the_weights_of_its_levels(analysis):
    record = analysis.curriculum.plot().to_dict()
    rows = list(itertools.chain(*record["datasets"].values()))
    drawn = [row["x"] for row in rows if "level" in row]
    expected = [weight for level in analysis.curriculum.levels for weight in level.weights]
    assert drawn == pytest.approx(expected, rel=1e-4)


def test_a_fit_on_another_variant_needs_the_trials_for_its_recorded_points(analysis):
    other = next(label for i, label in enumerate(analysis.labels_of_variants)
                 if i != analysis.bic_variant)  # fmt: skip
    series = {
        row["series"]
        for rows in analysis.plot_fit(other).to_dict()["datasets"].values()
        for row in rows
        if "series" in row
    }
    assert series == {"drawn from the mixture"}
    with pytest.raises(InputError, match="There is no variant 1"):
        analysis.plot_fit(1)


def test_stability_that_was_not_assessed_is_not_drawn(analysis):
    record = analysis.to_record() | {"stability": None}
    with pytest.raises(InputError, match="bootstrap"):
        Analysis.from_record(record).plot_stability()


def test_an_analysis_explains_itself_in_lines(analysis):
    told = analysis.explain()
    assert repr(told) == told
    assert told.split("\n") == surmount.explain_analysis(analysis)


def test_without_the_extra_a_sentence_names_it(analysis, monkeypatch):
    take_away(monkeypatch, "altair", "surmount.report")
    with pytest.raises(MissingExtraError, match=r"pip install 'surmount\[report\]'"):
        analysis.plot_dendrogram()


def test_a_run_shows_its_answer_its_curriculum_and_its_charts(reported):
    run = surmount.Run(reported.root)
    assert run.missing == ()
    assert run.analysis is not None
    assert run.curriculum is run.analysis.curriculum
    assert repr(run).splitlines()[1:] == run.answer()
    for chart in (run.plot_learning(), run.plot_learning("success"), run.plot_success()):
        assert chart.to_dict()["concat"]
    with pytest.raises(InputError, match="no measure"):
        run.plot_learning("speed")


def test_a_picture_is_the_same_bytes_and_holds_its_dark_twin(analysis):
    first, second = (draw(analysis.plot_dendrogram()) for _ in range(2))
    assert first == second
    assert "prefers-color-scheme:dark" in first.svg.decode()
    assert json.loads(first.spec)["usermeta"]["columns"] == 1


def _luminance(colour: str) -> float:
    parts = [int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5)]
    red, green, blue = (
        part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


@pytest.mark.parametrize("light", sorted(DARK.keys() - {PAPER, GRID}))
def test_marks_stand_out_from_light_and_dark_pages(light):
    for colour, paper in ((light, PAPER), (DARK[light], DARK[PAPER])):
        low, high = sorted((_luminance(colour), _luminance(paper)))
        assert (high + 0.05) / (low + 0.05) >= 3.0
    assert (_luminance(INK) + 0.05) * 7 < _luminance(PAPER) + 0.05
