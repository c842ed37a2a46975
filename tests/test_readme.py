"""The README shows what there is: its verbs, its pictures, and the published result."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from scipy import stats

from surmount.cli.main import run

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ surmount ([a-z]+)", README, flags=re.MULTILINE)
MOST_BYTES = 2_000_000


@pytest.mark.parametrize("verb", sorted(set(COMMANDS)))
def test_commands_exist(verb, capsys):
    with pytest.raises(SystemExit) as ended:
        run([verb, "--help"])
    assert ended.value.code == 0
    assert "usage: surmount" in capsys.readouterr().out.lower()


def test_pictures_exist_and_are_small():
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", README)
    assert len(pictures) == 3
    for picture in pictures:
        assert 0 < (ROOT / picture).stat().st_size < MOST_BYTES


@pytest.mark.slow
def test_the_groups_shown_are_those_of_the_trials_that_come_with_it(tmp_path, capsys):
    options = ["--set", "bootstrap=0", "--set", "sensitivity=false"]
    assert run(["analyze", "example", "--out", str(tmp_path), *options]) == 0
    (block,) = re.findall(r"```text\n(.*?)```", README, flags=re.DOTALL)
    assert capsys.readouterr().out.startswith(block)


@pytest.mark.parametrize(
    ("name", "folders"),
    [
        ("step", ("step-2032", "step-2033")),
        ("low entrance", ("low-entrance-2032",)),
        ("narrow channel", ("narrow-channel-2032",)),
    ],
)
def test_the_table_of_results_is_that_of_the_published_outcomes(name, folders):
    table = README.partition("<!-- results: begin -->")[2].partition("<!-- results: end -->")[0]
    (row,) = re.findall(rf"^\| {name} \|(.*)\|$", table, flags=re.MULTILINE)
    _, with_it, without, difference, ahead, _ = (cell.strip() for cell in row.split("|"))
    arms = 100 * np.concatenate([_arms(folder) for folder in folders])
    assert [with_it, without] == [f"{rate:.0f} %" for rate in arms.mean(axis=0)]
    gains = arms[:, 0] - arms[:, 1]
    if not np.any(gains):
        assert (difference, ahead) == ("0 points", "none")
        return
    low, high = stats.t.interval(0.95, gains.size - 1, gains.mean(), stats.sem(gains))
    written = f"{gains.mean():+.1f} points ({low:.0f} to {high:.0f})".replace("-", "−")
    assert difference == written
    assert ahead == f"{(gains > 0).sum()} of {gains.size}"


def _arms(folder):
    """Return each network's mean success with the curriculum and without, ``(network, 2)``."""
    outcomes = pl.read_parquet(ROOT / f"docs/results/reproduction/{folder}/outcomes.parquet")
    rates = outcomes.group_by("learnt", "network").agg(pl.col("success").mean())
    by_network = rates.pivot(on="learnt", index="network", values="success")
    return by_network.select("curriculum", "control").to_numpy()
