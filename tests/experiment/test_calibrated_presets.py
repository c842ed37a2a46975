"""Presets begin from what a family was calibrated to, and make way for what is asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from surmount.cli.main import main
from surmount.core.configuration import override
from surmount.core.errors import ConfigError
from surmount.core.records import read_record
from surmount.experiment.presets import configured, preset
from surmount.rstar.family import CALIBRATED

PAPER = preset("rstar/step", "paper")


@pytest.mark.parametrize("task", ["rstar/step", "rstar/low-entrance", "rstar/narrow-channel"])
@pytest.mark.parametrize("name", ["paper", "smoke"])
def test_every_obstacle_and_scale_has_the_world_that_was_chosen(task, name):
    chosen = preset(task, name)
    assert chosen.env.robot.friction == 1.3
    assert chosen.learner.discount_time_s == 5.0
    assert chosen.learner.gae_time_s == 0.5
    assert chosen.learner.activation == "silu"
    assert not chosen.learner.normalise_rewards


def test_the_presets_settings_are_those_that_the_runs_were_planned_with():
    planned = read_record(Path("docs/results/reproduction/frozen.json"))
    assert override(preset("rstar/step", "paper", calibrated=False), planned) == PAPER
    assert {key: planned[key] for key in CALIBRATED} == dict(CALIBRATED)


def test_another_algorithm_leaves_the_own_ones_hyper_parameters_behind():
    chosen = configured(PAPER, {"learner.algorithm": "SAC"})
    assert chosen.learner.discount_time_s is None
    assert chosen.learner.activation == preset("step", "paper", calibrated=False).learner.activation
    assert chosen.env == PAPER.env
    with pytest.raises(ConfigError, match=r"learner.clip_range` belongs to Surmount's own PPO"):
        configured(PAPER, {"learner.algorithm": "SAC", "learner.clip_range": 0.1})


def test_a_factor_per_step_takes_the_place_of_a_time():
    chosen = configured(PAPER, {"learner.discount": 0.9})
    assert chosen.learner.at_interval(0.01).discount == 0.9
    assert chosen.learner.gae_time_s == 0.5


def test_both_a_factor_and_a_time_are_refused():
    with pytest.raises(ConfigError, match="say the same in two ways"):
        configured(PAPER, {"learner.discount": 0.9, "learner.discount_time_s": 2.0})


@pytest.mark.parametrize(
    ("flags", "says"),
    [
        (["--learner.discount", "0.9"], ["learner.discount = 0.9", 'discount_time_s = "null"']),
        (["--learner.gae-lambda=0.9"], ["learner.gae_lambda = 0.9", 'gae_time_s = "null"']),
        (["--learner.algorithm", "SAC"], ['algorithm = "SAC"', "friction = 1.3"]),
        (["--set", "learner.algorithm=SAC"], ['algorithm = "SAC"', "friction = 1.3"]),
    ],
)
def test_flags_do_so_too(flags, says, capsys):
    with pytest.raises(SystemExit) as end:
        main(["config", "step", *flags])
    assert end.value.code == 0
    printed = capsys.readouterr().out
    assert all(line in printed for line in says)
