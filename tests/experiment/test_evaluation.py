"""A network alone does what it did in its run, and says itself what it was trained on."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
from small import run_first_stages, small_config

from surmount.core.errors import ConfigError, InputError
from surmount.experiment.evaluation import evaluate_network
from surmount.experiment.protocol import protocol
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.snapshot import TRAINED_ON, Snapshot, acting_only
from surmount.trials.table import read_trials
from surmount.workflow.monitor import SilentMonitor

CONFIG = small_config(networks=1)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """Return the folder of a run that has trained its only network and logged its trials."""
    return run_first_stages(tmp_path_factory.mktemp("run"), CONFIG)


@pytest.fixture
def network(root, tmp_path):
    """Return a copy of its network, away from the run."""
    path = tmp_path / "alone.safetensors"
    shutil.copy(next(root.glob("stages/initiation/**/network.safetensors")), path)
    return path


def evaluated(path, **options):
    given = {"seed": 0, "monitor": SilentMonitor()} | options
    return evaluate_network(path, RolloutConfig(repetitions=2), **given)


@pytest.mark.parametrize("lean", [False, True])
def test_a_network_alone_repeats_the_trials_of_its_run_to_the_last_bit(root, network, lean):
    if lean:
        whole = network.stat().st_size
        acting_only(Snapshot.load(network)).save(network)
        assert network.stat().st_size < whole / 3
    (stage,) = [stage for stage in protocol(CONFIG) if stage.name == "trials/network-0"]
    evaluation = evaluated(network, seed=stage.seed)
    logged = read_trials(next(root.glob("stages/trials/**/trials.parquet")))
    assert evaluation.task == "rstar/narrow-channel"
    assert evaluation.cap_s == 2.0
    np.testing.assert_array_equal(evaluation.trials.features, logged.features)
    np.testing.assert_array_equal(evaluation.trials.success, logged.success)
    np.testing.assert_array_equal(evaluation.trials.variant, logged.variant)


def test_sizes_and_settings_can_be_chosen(network):
    evaluation = evaluated(
        network, variants=(250.5, 200.0), changes={"env.episode_s": 0.5, "env.start.yaw_deg": 1.0}
    )
    assert np.unique(evaluation.trials.variant).tolist() == [200.0, 250.5]
    assert evaluation.trials.final("time_s").max() == 0.5


def test_what_does_not_belong_together_is_refused(network, tmp_path):
    with pytest.raises(InputError, match="does not fit the environment"):
        evaluated(network, task="step")
    with pytest.raises(InputError, match="400 is no width_mm of this task") as found:
        evaluated(network, variants=(400.0,))
    assert "180 to 320" in found.value.remedy
    known = Snapshot.load(network)
    for trained_on, sentence in (
        ({"obstacle": "moat", "env": {}}, "does not say in this version's terms"),
        ({"obstacle": "step", "env": {"wings": 2}}, "does not say in this version's terms"),
        (["step"], "does not say in this version's terms"),
        (
            {"obstacle": "step", "env": known.record[TRAINED_ON]["env"]},
            "its tensors are",
        ),
    ):
        path = tmp_path / "changed.safetensors"
        record = json.loads(json.dumps({**known.record, TRAINED_ON: trained_on}))
        replace(known, record=record).save(path)
        if "tensors" in sentence:  # every obstacle has as many observations: spoil one layer
            spoilt = {name: array for name, array in known.tensors.items() if "net.2" not in name}
            replace(known, tensors=spoilt, record=record).save(path)
        with pytest.raises(InputError, match=sentence):
            evaluated(path)
    nothing = {name: value for name, value in known.record.items() if name != TRAINED_ON}
    replace(known, record=nothing).save(tmp_path / "silent.safetensors")
    with pytest.raises(ConfigError, match="does not say which task"):
        evaluated(tmp_path / "silent.safetensors")
    assert evaluated(tmp_path / "silent.safetensors", task="narrow-channel")
