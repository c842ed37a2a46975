"""Films of a run on somebody's own environment: drawn by itself, small, once, and on its page."""

from __future__ import annotations

from dataclasses import replace

import av
import numpy as np
import pytest
from any_spaces import Walk, make_walk
from PIL import Image
from small import run_first_stages, run_small

from surmount.core.configuration import override
from surmount.core.errors import InputError
from surmount.core.records import read_record
from surmount.envs.own_family import OwnFamily
from surmount.experiment.films import films
from surmount.experiment.own_films import film_network
from surmount.experiment.own_run_films import LONGEST_S, MOST_FRAMES, MOST_PX
from surmount.experiment.presets import preset
from surmount.report import film_choice
from surmount.report.pages import write_report
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import open_run

CONFIG = override(
    preset("any_spaces:discrete", "smoke"),
    {
        "networks": 1,
        "initial_steps": 64,
        "learner.num_envs": 2,
        "learner.rollout_steps": 16,
        "learner.batch_size": 32,
        "learner.hidden_layers": [8],
        "trials.repetitions": 2,
        "tests.repetitions": 2,
    },
)


@pytest.fixture(scope="module")
def filmed(tmp_path_factory):
    root = run_first_stages(tmp_path_factory.mktemp("run"), CONFIG)
    said = []
    films(root, said.append, own=True)
    return root, said


def test_shown_is_the_variant_that_the_initial_networks_did_worst_on(filmed):
    root, said = filmed
    (film,) = read_record(root / "films" / "films.json")["films"]
    trials = read_trials(open_run(root).stages["trials/network-0"].path("trials.parquet"))
    rates = {goal: trials.success[trials.variant[:, 0] == goal].mean() for goal in (0.5, 1.0, 2.0)}
    worst = max(goal for goal, rate in rates.items() if rate == min(rates.values()))
    assert film["variant"].endswith(f"did worst on, goal_m {worst:g}")
    assert film["successes"] == round(rates[worst] * film["trials"])
    assert said == [f"{root}/films/initiation.mp4: goal_m {worst:g}: {film['outcome'].split()[0]}"]


def test_the_film_lasts_as_long_as_the_episode_at_its_speed(filmed):
    root, _ = filmed
    (film,) = read_record(root / "films" / "films.json")["films"]
    with av.open(root / "films" / "initiation.mp4") as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
        rate = container.streams.video[0].average_rate
    assert len(pictures) == round(film["duration_s"] / 0.1) + 1  # one a step, and the start
    assert film["duration_s"] == pytest.approx((len(pictures) - 1) * film["speed"] / float(rate))
    with Image.open(root / "films" / "initiation.png") as sheet:
        assert sheet.size == (3 * 64, 2 * 32)


def test_films_are_on_the_page_and_are_drawn_once(filmed):
    root, _ = filmed
    page = write_report(root).read_text(encoding="utf-8")
    assert page.count("<video") == 1
    assert "it is none of the trials" in page
    again = []
    films(root, again.append, own=True)
    assert again == []


def test_without_leave_ones_own_module_is_not_imported_for_films(filmed, monkeypatch):
    root, _ = filmed
    monkeypatch.setattr("surmount.experiment.films.find_family", pytest.fail)
    films(root, pytest.fail)


def test_long_episodes_and_large_pictures_become_small_films(tmp_path, monkeypatch):
    root = run_first_stages(tmp_path, CONFIG, stages=1)
    network = open_run(root).stages["initiation/network-0"].path("network.safetensors")
    monkeypatch.setattr(Walk, "render", lambda self: np.zeros((801, 1603, 3), np.uint8))
    family = OwnFamily("any_spaces:discrete", lambda: make_walk("discrete"))
    (episode,) = film_network(network, family, most_frames=4, most_px=MOST_PX)
    assert len(episode.frames) <= 4 + 1  # every fourth of at most 15 steps, the start, the last
    assert {frame.shape for frame in episode.frames} == {(158, 320, 3)}
    assert MOST_FRAMES / LONGEST_S >= 24  # as smooth as films are


def test_an_environment_that_says_it_draws_nothing_has_no_films(tmp_path, monkeypatch):
    monkeypatch.setattr(Walk, "metadata", {"render_modes": []})
    monkeypatch.setattr("any_spaces.Walk.__init__", _without_drawing(Walk.__init__))
    root = run_first_stages(tmp_path, CONFIG)
    films(root, pytest.fail, own=True)
    assert not (root / "films").exists()


def test_a_render_that_fails_is_a_sentence_and_the_page_does_without(filmed, monkeypatch):
    root, _ = filmed
    (root / "films" / "films.json").unlink()
    monkeypatch.setattr(Walk, "render", lambda self: 1 / 0)
    said = []
    films(root, said.append, own=True)
    (sentence,) = said
    assert sentence.startswith("No films: The environment's `render` fails (ZeroDivisionError")
    monkeypatch.setattr(Walk, "render", lambda self: None)
    network = open_run(root).stages["initiation/network-0"].path("network.safetensors")
    drawing = film_network(network, OwnFamily("walk", lambda: make_walk("discrete")))
    with pytest.raises(InputError, match="returned NoneType, not a picture"):
        next(drawing)
    assert "<video" not in write_report(root).read_text(encoding="utf-8")


def _without_drawing(begin):
    def begun(self, *arguments):
        begin(self, *arguments)
        self.render_mode = None

    return begun


def test_a_second_film_shows_both_arms_where_they_differ_most(tmp_path, monkeypatch):
    changes = {"advancement.iteration_steps": 64, "advancement.extension_steps": 32}
    changes |= {"advancement.window_steps": 16, "advancement.max_extensions": 1}
    config = override(
        CONFIG,
        changes
        | {
            "analysis.components": 2,
            "analysis.bootstrap": 0,
            "analysis.min_samples_per_component": 4,
        },
    )
    outcome, _ = run_small(tmp_path, config)
    assert not outcome.interrupted
    read = film_choice.read_outcomes

    def as_if(artefacts):
        """Return the tests as if the curriculum alone reached the middle goal, nobody another."""
        stages = [*artefacts]
        found = read(stages)
        middle = found.variant[:, 0] == 1.0
        ahead = "curriculum" in str(stages[0].path("trials.parquet"))
        return replace(found, success=middle & ahead)

    monkeypatch.setattr(film_choice, "read_outcomes", as_if)
    films(tmp_path, lambda _: None, own=True)
    drawn = read_record(tmp_path / "films" / "films.json")["films"]
    second = [film for film in drawn if film["variant"].startswith(film_choice.TITLE)]
    assert [film["kind"] for film in second] == ["curriculum", "control"]
    page = write_report(tmp_path).read_text(encoding="utf-8")
    assert page.count("<video") == len(drawn) == 5
    assert "100 % with the curriculum, 0 % without it" in page.replace("\N{NO-BREAK SPACE}", " ")
