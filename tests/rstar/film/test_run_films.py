"""Films of a run show its logged trials, are drawn once, and go into its page whole."""

from __future__ import annotations

import base64
import re

import av
import numpy as np
import pytest
from graphics import needs_graphics, orange
from small import run_first_stages, small_config

from surmount.core.errors import IntegrityError
from surmount.core.records import file_hash, read_record, write_record
from surmount.report.pages import write_report
from surmount.rstar.film.run_films import FILM, draw_films
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import open_run

pytestmark = needs_graphics
CONFIG = small_config(networks=1, **{"env.episode_s": 0.8})


@pytest.fixture(scope="module")
def filmed(tmp_path_factory):
    root = run_first_stages(tmp_path_factory.mktemp("run"), CONFIG)
    said = []
    draw_films(open_run(root), said.append)
    return root, said


def test_a_film_shows_the_first_trial_on_the_hardest_variant(filmed):
    root, said = filmed
    (sentence,) = said
    assert "trial 0 of trials/network-0, simulated again: equal to its log" in sentence
    (film,) = read_record(root / "films" / "films.json")["films"]
    trials = read_trials(open_run(root).stages["trials/network-0"].path("trials.parquet"))
    hardest = trials.variant[:, 0] == 180.0
    assert (film["size_mm"], film["trials"]) == (180.0, hardest.sum())
    assert film["successes"] == trials.success[hardest].sum()
    rows = trials.lengths[np.flatnonzero(hardest)[0]]
    assert film["duration_s"] == pytest.approx((rows - 1) * 0.1)
    with av.open(root / "films" / "initiation.mp4") as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    held = round(FILM.hold_s * FILM.fps)
    # Begin and end are both shown, and the last moment stays.
    assert len(pictures) == np.ceil(film["duration_s"] * FILM.fps / FILM.speed) + 1 + held
    assert all(orange(picture) > 50 for picture in pictures)


def test_films_are_drawn_once_and_again_when_they_were_changed(filmed):
    root, _ = filmed
    path = root / "films" / "initiation.mp4"
    before, said = path.read_bytes(), []
    draw_films(open_run(root), said.append)
    assert said == []
    path.write_bytes(before[:-1])
    with pytest.raises(IntegrityError, match=r"initiation\.mp4 is missing or was changed"):
        write_report(root)
    draw_films(open_run(root), said.append)
    assert len(said) == 1
    (film,) = read_record(root / "films" / "films.json")["films"]
    assert file_hash(path) == film["film"]["sha256"]


def test_the_page_holds_the_films_whole_and_no_films_of_other_trials(filmed):
    root, _ = filmed
    page = write_report(root).read_text(encoding="utf-8")
    (source,) = re.findall(r'<video[^>]* src="data:video/mp4;base64,([^"]+)"', page)
    assert base64.b64decode(source) == (root / "films" / "initiation.mp4").read_bytes()
    assert "media-src data:" in page
    record = read_record(root / "films" / "films.json")
    record["films"][0]["key"] = "0" * 16
    write_record(root / "films" / "films.json", record)
    assert "<video" not in write_report(root).read_text(encoding="utf-8")
