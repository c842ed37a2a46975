"""One page over several runs says what each says, and what all of them say together."""

from __future__ import annotations

import csv

import pytest
from page_reader import PageReader
from run_builder import RunBuilder

from surmount.cli.main import run
from surmount.core.errors import InputError
from surmount.report.pages import write_report
from surmount.report.results import read_run
from surmount.studies.paper.pages import write_overview
from surmount.workflow.run_layout import ARMS


@pytest.fixture(scope="module")
def roots(tmp_path_factory):
    """Return a finished run and one that has only begun, on two obstacles."""
    step, entrance = (tmp_path_factory.mktemp(name) for name in ("step", "entrance"))
    RunBuilder(step).whole()
    RunBuilder(entrance, obstacle="low-entrance").initiate()
    return step, entrance


def test_the_page_holds_every_claim_and_the_evidence_over_all(roots, tmp_path):
    page = write_overview(roots, tmp_path)
    read = PageReader(page.read_text(encoding="utf-8"))
    assert read.problems == []
    for claim in read_run(roots[0]).evidence.claims:
        for words in (claim.claim, claim.ours, claim.verdict, claim.reason):
            assert " ".join(words.split()) in read.text
    assert "Low entrance: no claim can be judged yet." in read.text
    assert "Low entrance: unfinished run" in read.text
    with (tmp_path / "figures" / "figure-11-profiles.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["arm"] == "curriculum"]
    # Two of the three groups have learnt to succeed at 0.95 and 0.9, one at 1.
    assert float(rows[0]["share_above"]) == 1.0
    shares = [float(row["share_above"]) for row in rows]
    assert shares == sorted(shares, reverse=True)
    assert (tmp_path / "figures" / "step-figure-8-success.svg").is_file()


def test_two_runs_on_one_obstacle_are_refused(roots, tmp_path):
    with pytest.raises(InputError, match="on the same obstacle: step and step"):
        write_overview((roots[0], roots[0]), tmp_path)


def test_the_command_takes_one_run_or_several_with_a_folder(capsys, roots, tmp_path):
    assert run(["report", *map(str, roots)]) == 2
    assert "There are 2 runs." in capsys.readouterr().err
    assert run(["report", *map(str, roots), "--out", str(tmp_path)]) == 0
    assert f"Report: {(tmp_path / 'report.html').resolve()}" in capsys.readouterr().out


def test_arms_that_were_never_trained_take_no_part_in_what_all_obstacles_say(roots, tmp_path):
    idle = tmp_path / "channel"
    idle.mkdir()
    sure = dict.fromkeys(("initiation", *ARMS), (1.0, 1.0, 1.0))
    RunBuilder(idle, obstacle="narrow-channel", success=sure).whole()
    alone = write_overview((roots[0],), tmp_path / "alone")
    both = write_overview((roots[0], idle), tmp_path / "both")
    pages = [PageReader(page.read_text(encoding="utf-8")).text for page in (alone, both)]
    left_out = "Narrow channel is left out. The curriculum has no levels: neither arm was trained"
    assert [left_out in page for page in pages] == [False, True]
    profiles = [
        (page.parent / "figures" / "figure-11-profiles.csv").read_bytes() for page in (alone, both)
    ]
    assert profiles[0] == profiles[1]
    own_page = PageReader(write_report(idle).read_text(encoding="utf-8")).text
    assert "Both arms are the networks after the initiation: what differs is chance." in own_page
