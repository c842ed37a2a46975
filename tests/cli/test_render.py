"""`render` writes what it says, and every wrong call of it or of `view` ends in a sentence."""

from __future__ import annotations

import av
import numpy as np
import pytest
from graphics import needs_graphics, orange
from missing import take_away
from PIL import Image
from small import run_first_stages, small_config

from surmount.cli.main import run

SMALL = ("--size", "96", "72")


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """Return the folder of a run that has trained its only network and logged its trials."""
    config = small_config(networks=1, **{"env.episode_s": 0.8})
    return run_first_stages(tmp_path_factory.mktemp("run"), config)


def call(capsys, *arguments) -> tuple[int, str, str]:
    code = run([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@needs_graphics
def test_a_policy_becomes_a_film(capsys, root, tmp_path):
    out = tmp_path / "policy.mp4"
    code, said, _ = call(
        capsys, "render", root, "--variant", 200, 320, "--fps", 5, "--out", out, *SMALL
    )
    assert code == 0
    assert "narrow-channel, 200 mm: initiation/network-0, actions drawn by seed 0: had not" in said
    # Twice 0.8 s: at 0.0, 0.2, … 0.8 s, and then a second of the last.
    assert f"Written to {out}: 20 frames, 4.0 s, 96 x 72 pixels" in said
    with av.open(out) as film:
        pictures = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert [picture.shape for picture in pictures] == [(72, 96, 3)] * 20
    assert all(orange(picture) > 10 for picture in pictures)


@needs_graphics
def test_a_logged_trial_becomes_a_gif_and_a_sheet(capsys, root, tmp_path):
    trial = (root, "--stage", "trials/network-0", "--variant", 250, "--trial", 1)
    out = tmp_path / "trial.gif"
    code, said, _ = call(
        capsys, "render", *trial, "--speed", 2, "--fps", 5, "--out", out, "--camera", "top", *SMALL
    )
    assert code == 0
    assert "trial 1 of trials/network-0, simulated again: equal to its log" in said
    assert f"Written to {out}: 8 frames, 1.6 s, 96 x 72 pixels" in said
    with Image.open(out) as film:
        assert film.size == (96, 72)
    code, said, _ = call(
        capsys, "render", *trial, "--at", 0.1, 0.4, "--out", tmp_path / "trial.png", *SMALL
    )
    assert (code, "192 x 72 pixels" in said) == (0, True)
    with Image.open(tmp_path / "trial.png") as sheet:
        first, second = np.hsplit(np.asarray(sheet), 2)
    assert orange(first) > 10
    assert orange(second) > 10


@pytest.mark.parametrize(
    ("arguments", "code", "sentence", "remedy"),
    [
        (["stepp"], 3, "`stepp` is neither an obstacle", "Did you mean `step`?"),
        (["step", "--stand", "--variant", "90"], 3, "90 is not admissible", "from 20 to 51"),
        (["step", "--stand", "--out", "x.avi"], 2, "x.avi ends in none of .mp4", ".gif"),
        (["step", "--stand", "--out", "/dev/null/x.mp4"], 4, "is not a folder", "Choose"),
        (["step", "--stand", "--fps", "0"], 2, "`fps` is 0", "[1, 240]"),
        (["step", "--stand", "--speed", "0"], 2, "`speed` is 0", "Give a value"),
        (["step", "--stand", "--camera", "drone"], 2, "'drone'", "track, side, front, top, course"),
        (["step", "--stand", "--at", "1"], 2, "For a film, --at would do nothing", "Leave it out"),
        (["step", "--stand", "--out", "x.gif", "--fps", "60"], 2, "too many for a GIF", "most 50"),
        (["step", "--stand", "--out", "x.png", "--fps", "5"], 2, "For a picture, --fps", "Leave"),
        (["step", "--stand", "--set", "env.x=1"], 2, "Unknown configuration key", "Did you mean"),
        (["step", "--stand", "--seed", "1"], 2, "With a manoeuvre, --seed", "Leave it out"),
    ],
)
def test_wrong_calls_end_in_a_sentence(
    capsys, tmp_path, monkeypatch, arguments, code, sentence, remedy
):
    monkeypatch.chdir(tmp_path)
    out = [] if "--out" in arguments else ["--out", "x.mp4"]
    found, _, err = call(capsys, "render", *arguments, *out)
    assert found == code
    assert sentence in err
    assert remedy in err
    assert not list(tmp_path.iterdir())


@needs_graphics
def test_an_odd_size_is_refused_for_an_mp4(capsys, tmp_path):
    out = tmp_path / "x.mp4"
    code, _, err = call(capsys, "render", "step", "--stand", "--out", out, "--size", 95, 72)
    assert code == 2
    assert "An MP4 cannot be 95 x 72 pixels.\nGive an even width" in err
    assert not list(tmp_path.iterdir())


def test_a_view_without_a_display_ends_with_code_1(capsys, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    code, out, err = call(capsys, "view", "step", "--stand", "--variant", 30)
    assert code == 1
    assert "step, 30 mm: standing" in out
    assert "There is no display for a window." in err
    assert "surmount render" in err


def test_without_the_extra_for_films_render_says_what_to_install(capsys, monkeypatch, tmp_path):
    take_away(monkeypatch, "av", "surmount.rstar.film.film", "surmount.envs.video")
    code, _, err = call(capsys, "render", "step", "--stand", "--out", tmp_path / "x.mp4")
    assert code == 6
    assert "pip install 'surmount[video]'" in err
    code, _, _ = call(capsys, "config", "step")
    assert code == 0
