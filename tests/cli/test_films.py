"""Where films cannot be drawn the report does without them and says why."""

from __future__ import annotations

from missing import take_away
from small import run_first_stages, small_config

from surmount.cli.main import run


def test_a_report_without_films_says_why(capsys, tmp_path, monkeypatch):
    root = run_first_stages(tmp_path, small_config(networks=1, **{"env.episode_s": 0.4}))
    take_away(monkeypatch, "av", "surmount.rstar.film", "surmount.envs.video")
    assert run(["report", str(root)]) == 0
    said = capsys.readouterr().out
    assert "No films: This needs the package `av`, which is not installed." in said
    assert "<video" not in (root / "report.html").read_text(encoding="utf-8")
