import json

import numpy as np
import pytest

from surmount.cli.main import run
from surmount.core.errors import ConfigError, InputError
from surmount.studies.initiation_map import (
    distance_to_table_1,
    group_success,
    initiation_stages,
    read_settings,
)

SMALL = """
[common]
obstacles = ["low-entrance"]
networks = 2
[common.changes]
initial_steps = 1
"trials.repetitions" = 1
"env.episode_s" = 0.2
"learner.rollout_steps" = 32
"learner.batch_size" = 288
"learner.hidden_layers" = [8]
[settings.base]
[settings.slow]
networks = 1
changes = {"env.step_s" = 0.05}
"""


def written(tmp_path, text):
    path = tmp_path / "settings.toml"
    path.write_text(text)
    return path


def test_a_map_runs_every_setting_and_goes_on_with_what_is_added(tmp_path, capsys):
    out = tmp_path / "out"
    path = written(tmp_path, SMALL)
    assert run(["initiations", str(path), "--out", str(out), "--processes", "0"]) == 0
    record = json.loads((out / "initiations.json").read_text())
    assert {
        name: np.shape(found["obstacles"]["low-entrance"]["success"])
        for name, found in record["settings"].items()
    } == {"base": (2, 18), "slow": (1, 18)}
    base = record["settings"]["base"]
    entrance = base["obstacles"]["low-entrance"]
    # The paper's entrance is scored; its channel, whose groups are assumed, would not be.
    assert base["score"] == entrance["score"]["log_likelihood"] < 0
    assert (base["out"], entrance["networks"]) == (None, [0, 1])
    assert f"{base['score']:.2f}" in capsys.readouterr().out
    for suffix in ("svg", "png", "csv"):
        assert (out / f"initiations.{suffix}").stat().st_size > 500
    capsys.readouterr()
    written(tmp_path, SMALL + '[settings.far]\nchanges = {"env.reward.distance_unit_m" = 1.0}\n')
    assert run(["initiations", str(path), "--out", str(out), "--processes", "0"]) == 0
    said = capsys.readouterr().out
    assert said.count("kept from an earlier call") == 6
    assert said.count("initiation/far") >= 2


def test_network_i_has_the_same_seed_under_every_setting(tmp_path):
    graph = initiation_stages(read_settings(written(tmp_path, SMALL)))
    seeds = {stage.name: stage.seed for stage in graph}
    base, other = "initiation/base/low-entrance", "initiation/slow/low-entrance"
    assert seeds[f"{base}/network-0"] == seeds[f"{other}/network-0"]
    assert seeds[f"{base}/network-0"] != seeds[f"{base}/network-1"]


def test_distance_to_table_1_is_the_mean_over_groups_and_then_over_obstacles():
    channel, entrance, step = (
        np.arange(180.0, 321, 10),
        np.arange(55.0, 141, 5),
        np.arange(21.0, 51),
    )
    found = {
        # Everything succeeds: differences 0 and 0.6, 0.01 and 0.24, 0.06 and 0.81 and 1.
        name: {"groups": group_success(name, sizes, np.ones((2, sizes.size)))}
        for name, sizes in (
            ("narrow-channel", channel),
            ("low-entrance", entrance),
            ("step", step),
        )
    }
    expected = (0.6 / 2 + 0.25 / 2 + 1.87 / 3) / 3
    assert distance_to_table_1(found) == pytest.approx(expected)
    assert distance_to_table_1({"step": found["step"]}) is None


def test_groups_hold_the_variants_that_the_paper_gives_them():
    sizes = np.arange(21.0, 51)
    success = np.where(sizes <= 33, 1.0, np.where(sizes <= 46, 0.5, 0.0))[None]
    groups = group_success("step", sizes, success)
    assert [group["mean"] for group in groups] == [1.0, 0.5, 0.0]
    assert [group["networks"] for group in groups] == [[1.0], [0.5], [0.0]]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("settings = 3", InputError),
        ("[common]\n", InputError),
        ("[common\n", InputError),
        ("[common]\n[settings.a]\nchanges = 4\n", InputError),
        ('[common]\n[settings.a]\nchanges = {"env.gear" = 1}\n', ConfigError),
        ('[common]\n[settings.a]\nobstacles = ["wall"]\n', ConfigError),
    ],
)
def test_files_that_are_no_settings_are_refused_with_a_remedy(tmp_path, text, error):
    with pytest.raises(error) as caught:
        initiation_stages(read_settings(written(tmp_path, text)))
    assert caught.value.remedy
