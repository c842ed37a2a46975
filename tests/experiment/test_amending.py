"""A run is no dead end: what no finished stage depends on may be changed when it is resumed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from small import run_first_stages, small_config

from surmount.core.configuration import override
from surmount.core.errors import ConfigError, OutputError
from surmount.core.records import read_record
from surmount.experiment.config import fingerprinted
from surmount.experiment.protocol import protocol
from surmount.experiment.running import begin, load_config
from surmount.experiment.teaching import require_fit
from surmount.learn.config import LearnerConfig
from surmount.workflow.run_layout import RUN


@pytest.fixture(scope="module")
def half(tmp_path_factory):
    """A run whose first network was trained and tried, and nothing analysed."""
    config = fingerprinted(small_config())
    return run_first_stages(tmp_path_factory.mktemp("half") / "run", config), config


def test_what_belongs_to_stages_that_have_not_run_may_be_changed(half):
    root, config = half
    changed = override(config, {"analysis.min_samples_per_component": 5, "tests.repetitions": 2})
    with pytest.raises(OutputError, match="with --resume, what no finished stage depends on"):
        begin(root, changed)
    begin(root, changed, amended=protocol)
    assert load_config(root) == changed
    (told,) = read_record(root / RUN)["amended"]
    assert told["tests.repetitions"] == [1, 2]
    begin(root, config, amended=protocol)  # and back
    assert load_config(root) == config


@pytest.mark.parametrize(("key", "value", "stage"), [
    ("learner.learning_rate", 1e-3, "initiation/network-0"),
    ("trials.repetitions", 3, "trials/network-0"),
    ("initial_steps", 700, "initiation/network-0"),
])  # fmt: skip
def test_what_has_run_may_not(half, key, value, stage):
    root, config = half
    with pytest.raises(OutputError, match=f"changes what has run already: {stage}"):
        begin(root, override(config, {key: value}), amended=protocol)
    assert load_config(root) == config


def test_a_teacher_that_needs_a_critic_is_refused_before_anything_runs():
    config = small_config()
    require_fit(config, ("plr", "alp-gmm"))
    off = replace(config, learner=LearnerConfig(algorithm="SAC"))
    require_fit(off, ("alp-gmm",))
    with pytest.raises(ConfigError, match=r"`plr` needs a critic's value errors, and SAC"):
        require_fit(off, ("alp-gmm", "plr"))
    with pytest.raises(ConfigError, match="no algorithm `SAK`"):
        require_fit(replace(config, learner=LearnerConfig(algorithm="SAK")), ("plr",))
