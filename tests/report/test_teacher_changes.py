"""The page on teachers tells what was mastered, what fell and what stopping saves."""

from __future__ import annotations

from surmount.cli.show import show
from surmount.core.records import write_record
from surmount.report.teacher_changes import changes_section


def change(kind: str, group: str, steps: int) -> dict:
    return {
        "steps": steps,
        "kind": kind,
        "group": group,
        "before": None,
        "sentence": f"{steps:,} steps: {group}, {kind}",
    }


CHANGES = [
    [
        change("main group", "easy", 100),
        change("mastered", "easy", 400),
        change("stop", "easy", 700),
    ],
    [change("main group", "hard", 50), change("fell", "easy", 60)],
]


def test_changes_are_counted_over_networks_and_told_for_the_first():
    section = changes_section(
        [
            {"title": "uniform", "steps": [1_000, 1_000]},
            {"title": "frontier", "steps": [700, 1_000], "changes": CHANGES},
        ]
    )
    assert section is not None
    counts, words = section.blocks[1:]
    saved = "1 network, 300 steps"
    assert counts.rows == (
        ("frontier", "easy", "1", "1", "1", "0", saved),
        ("frontier", "hard", "1", "0", "0", "0", saved),
    )
    assert [row[1] for row in words.rows] == [one["sentence"] for one in CHANGES[0]]


def test_there_is_no_section_where_no_teacher_tells():
    assert changes_section([{"title": "uniform", "steps": [1_000]}]) is None


def test_show_tells_what_the_teacher_of_a_training_did(tmp_path, capsys):
    file = tmp_path / "training.json"
    write_record(file, {"steps": 1_000, "level_tests": [], "changes": CHANGES[0]})
    assert show(file, why=True) == 0
    printed = capsys.readouterr().out
    assert "What its teacher did in 1,000 steps" in printed
    assert "  400 steps: easy, mastered" in printed
    write_record(file, {"steps": 1_000, "level_tests": []})
    show(file)
    assert "made no decisions" in capsys.readouterr().out
