import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small import SMALL

from surmount.cli.main import run
from surmount.core.errors import ConfigError, InputError
from surmount.studies.regime_map import judge, read_regime_map, regime, regime_stages

ROOT = Path(__file__).parents[2]
KEYS = "\n".join(
    f'"{key}" = {json.dumps(value)}' for key, value in (SMALL | {"networks": 1}).items()
)
AXES = '"env.robot.friction" = [0.7]\n"env.step_s" = [0.1, 0.2]\n'
HEAD = 'obstacle = "low-entrance"\nhard = [55, 70]\nsolved = 0.5\n'


def written(tmp_path, text=f"{HEAD}[common]\n{KEYS}\n[axes]\n{AXES}"):
    path = tmp_path / "map.toml"
    path.write_text(text)
    return path


@pytest.mark.slow
def test_a_map_runs_both_arms_in_every_cell_and_names_regimes_by_its_rule(tmp_path, capsys):
    out, path = tmp_path / "out", written(tmp_path)
    command = ["regimes", str(path), "--out", str(out), "--processes", "0"]
    assert run(command) == 0
    record = json.loads((out / "regimes.json").read_text())
    assert [cell["values"] for cell in record["cells"]] == [[0.7, 0.1], [0.7, 0.2]]
    for cell in record["cells"]:
        hard = np.array(cell["variants"]) <= 70
        means = {name: np.array(rows)[:, hard].mean() for name, rows in cell["success"].items()}
        assert cell["hard"]["success"] == pytest.approx(means)
        assert cell["regime"] == regime(means["curriculum"], means["control"], 0.5)
        assert cell["hard"]["difference"]["estimate"] == pytest.approx(
            means["curriculum"] - means["control"]
        )
    with (out / "regimes.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 3 * 18  # cells, trainings, heights
    for suffix in ("svg", "png"):
        assert (out / f"regimes.{suffix}").stat().st_size > 1000
    capsys.readouterr()
    assert run(command) == 0
    assert capsys.readouterr().out.count("kept from an earlier call") == 2 * (6 + 3)


def test_a_stage_has_the_same_seed_in_every_cell_and_takes_its_own_cells_artefacts(tmp_path):
    regimes = read_regime_map(written(tmp_path))
    first, second = regimes.cells
    stages = {stage.name: stage for stage in regime_stages(regimes)}
    for name in ("initiation/network-0", "curriculum/network-0", "analysis"):
        assert stages[first.stage(name)].seed == stages[second.stage(name)].seed
    assert stages[first.stage("control/network-0")].inputs == {
        "network": (first.stage("initiation/network-0"),),
        "curriculum": (first.stage("curriculum/network-0"),),
    }
    interval = [stages[cell.stage("initiation/network-0")].config["env"]["step_s"]
                for cell in regimes.cells]  # fmt: skip
    assert interval == [0.1, 0.2]


@pytest.mark.parametrize(
    ("curriculum", "control", "expected"),
    [
        (0.2, 0.4, "neither"),
        (0.5, 0.4, "curriculum only"),
        (0.4, 0.5, "control only"),
        (0.5, 1.0, "both"),
    ],
)
def test_regimes_are_told_by_who_solves_the_hard_variants(curriculum, control, expected):
    assert regime(curriculum, control, 0.5) == expected


def test_a_cell_is_judged_on_the_hard_on_all_and_on_every_single_variant():
    success = {
        "initiation": np.zeros((2, 3)),
        "curriculum": np.array([[1.0, 0.6, 0.2], [1.0, 0.6, 0.6]]),
        "control": np.array([[1.0, 0.0, 0.0], [0.5, 0.0, 0.0]]),
    }
    judged = judge(success, np.array([21.0, 35.0, 50.0]), (30, 50), 0.5)
    assert judged["hard"]["success"] == pytest.approx(
        {"initiation": 0.0, "curriculum": 0.5, "control": 0.0}
    )
    assert judged["hard"]["difference"]["estimate"] == pytest.approx(0.5)
    assert judged["all"]["difference"]["estimate"] == pytest.approx((1.8 - 1 + 2.2 - 0.5) / 6)
    assert judged["regime"] == "curriculum only"
    assert judged["regimes"] == ["both", "curriculum only", "neither"]


def test_the_published_maps_are_read_and_share_all_but_seed_and_number_of_networks():
    first, again = (
        read_regime_map(ROOT / "docs/results/regime-map" / name)
        for name in ("step.toml", "step-again.toml")
    )
    assert {cell.config.env.robot.friction for cell in first.cells} == {0.7, 1.3}
    assert len({cell.name for cell in first.cells}) == 6
    for cell, other in zip(first.cells, again.cells, strict=False):
        assert cell.config.seed != other.config.seed
        assert other.config == replace(cell.config, seed=2030, networks=3)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", InputError),
        ("[axes\n", InputError),
        (f"{HEAD}[axes]\n", InputError),
        (f'{HEAD}[axes]\n"seed" = [1]\n', InputError),
        (f'{HEAD}[axes]\n"seed" = []\n"networks" = [1]\n', InputError),
        (f"{HEAD.replace('55', '90')}[axes]\n{AXES}", InputError),
        (f"{HEAD.replace('0.5', '1.5')}[axes]\n{AXES}", InputError),
        (f'{HEAD}[axes]\n"seed" = [1]\n"env.gear" = ["wheels"]\n', ConfigError),
        (f"{HEAD.replace('low-entrance', 'wall')}[axes]\n{AXES}", ConfigError),
    ],
)
def test_files_that_are_no_map_are_refused_with_a_remedy(tmp_path, text, error):
    with pytest.raises(error) as caught:
        read_regime_map(written(tmp_path, text))
    assert caught.value.remedy


def test_hard_variants_that_no_variant_is_are_refused(tmp_path):
    text = written(tmp_path).read_text().replace("[55, 70]", "[20, 30]")
    with pytest.raises(InputError, match="No variant lies within the hard ones, 20 to 30"):
        read_regime_map(written(tmp_path, text))
