"""The trials that come with the package."""

from __future__ import annotations

import numpy as np

from surmount import load_example
from surmount.cli.main import run


def test_the_example_is_what_its_text_says():
    trials = load_example()
    variants, index = trials.variants()
    assert variants[:, 0].tolist() == [*range(21, 51)]
    assert np.bincount(index).tolist() == [24] * 30  # three networks, eight trials each
    assert trials.feature_names == ("time_s", "sprawl_deg", "fbem_deg", "distance_m")
    easy = trials.success[trials.variant[:, 0] <= 33]
    hard = trials.success[trials.variant[:, 0] >= 47]
    assert easy.mean() > 0.95
    assert hard.mean() < 0.1


def test_the_word_example_is_read_as_a_table_of_ones_own_is(tmp_path, capsys):
    few = ["--set", "bootstrap=0", "--set", "sensitivity=false", "--set", "components=2"]
    assert run(["analyze", "example", "--out", str(tmp_path), *few]) == 0
    assert "Curriculum over height_mm" in capsys.readouterr().out
    assert (tmp_path / "curriculum.json").is_file()
