"""The evidence that a run keeps is what its page shows, and what can be found anew."""

from __future__ import annotations

import pytest
from run_builder import RunBuilder

from surmount.core.errors import IntegrityError
from surmount.core.records import read_record
from surmount.report.pages import write_report
from surmount.report.results import read_run


@pytest.fixture(scope="module")
def builder(tmp_path_factory):
    return RunBuilder(tmp_path_factory.mktemp("run")).whole()


def test_what_is_kept_is_what_is_found_anew(builder):
    anew = read_run(builder.root).evidence
    builder.weigh()
    kept = read_run(builder.root).evidence
    assert kept.to_record() == anew.to_record()
    record = read_record(builder.artefacts["evidence"].path("evidence.json"))
    assert {claim["claim"] for claim in record["claims"]} >= {"groups", "levels"}
    assert record["profiles"]["curriculum"]["share"][0] == 1.0  # all succeed at times


def test_the_page_refuses_evidence_that_was_changed(builder):
    builder.weigh()
    path = builder.artefacts["evidence"].path("evidence.json")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("not reproduced", "reproduced", 1), encoding="utf-8")
    try:
        with pytest.raises(IntegrityError, match=r"evidence\.json"):
            write_report(builder.root)
    finally:
        path.write_text(text, encoding="utf-8")
