"""`evaluate` shows success by size, and writes its trials where it is asked to."""

from __future__ import annotations

import re

import pytest
from small import run_first_stages, small_config

from surmount.cli.main import run
from surmount.trials.table import read_trials


@pytest.fixture(scope="module")
def network(tmp_path_factory):
    root = run_first_stages(tmp_path_factory.mktemp("run"), small_config(networks=1))
    return next(root.glob("stages/initiation/**/network.safetensors"))


def test_success_by_size_is_that_of_the_table_it_writes(capsys, network, tmp_path):
    out = tmp_path / "new" / "trials.csv"
    sizes = ["200", "320"]
    arguments = ["evaluate", network, "--variant", *sizes, "--repetitions", 3, "--out", out]
    assert run([str(argument) for argument in arguments]) == 0
    said = capsys.readouterr().out
    trials = read_trials(out, minimum_samples=1, minimum_variants=1)
    assert trials.n_trials == 6
    shown = re.findall(r"(200|320) \W+(\d) / 3 ", said)
    expected = [
        (size, str(int(trials.success[trials.variant[:, 0] == float(size)].sum())))
        for size in sizes
    ]
    assert shown == expected
    assert f"Written to {out}: 6 trials" in said


@pytest.mark.parametrize(
    ("out", "sentence"), [("e.txt", "neither a .parquet nor"), ("e.csv", "is a folder")]
)
def test_where_nothing_can_be_written_nothing_is_tried(capsys, network, tmp_path, out, sentence):
    (tmp_path / "e.csv").mkdir()
    assert run(["evaluate", str(network), "--out", str(tmp_path / out)]) in (2, 3)
    said = capsys.readouterr()
    assert sentence in said.err
    assert said.out == ""


def test_a_file_that_is_no_network_ends_with_code_3(capsys, tmp_path):
    (tmp_path / "notes.safetensors").write_text("hello", encoding="utf-8")
    assert run(["evaluate", str(tmp_path / "notes.safetensors")]) == 3
    assert "is not a network written by Surmount" in capsys.readouterr().err
    assert run(["evaluate", str(tmp_path)]) == 3
    assert "is a folder" in capsys.readouterr().err
