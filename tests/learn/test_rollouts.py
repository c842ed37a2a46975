"""Roll-outs log what happened, trial by trial."""

from __future__ import annotations

import numpy as np
import pytest
from point_env import STEP, PointEnv

from surmount.core.errors import ConfigError
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import roll_out
from surmount.workflow.monitor import SilentMonitor


class FullSpeed:
    """Drives forward at full speed: after n steps it is n * STEP from the start."""

    def begin(self, trials, rng, *, deterministic):
        return lambda observations: np.ones((len(observations), 1))


def trials_of(distances, repetitions=2):
    return roll_out(
        PointEnv(len(distances) * repetitions, autoreset=False),
        FullSpeed(),
        np.array(distances)[:, None],
        RolloutConfig(repetitions=repetitions),
        network=7,
        seed=0,
        monitor=SilentMonitor(),
    )


def test_a_trial_holds_its_own_steps_from_start_to_end():
    trials = trials_of([1.0, 2.0, 99.0])
    assert trials.success.tolist() == [True, True, True, True, False, False]
    # Full speed covers STEP a step and stops within the tolerance of the goal, one row being
    # the start pose; the unreachable goal ends by the limit of 40 steps.
    assert trials.lengths.tolist() == [6, 6, 11, 11, 41, 41]
    np.testing.assert_allclose(trials.final("position_m"), STEP * (trials.lengths - 1))
    np.testing.assert_allclose(trials.path_length("position_m"), STEP * (trials.lengths - 1))
    assert trials.network.tolist() == [7] * 6
    assert trials.repetition.tolist() == [0, 1] * 3


def test_a_wrong_number_of_environments_is_refused():
    with pytest.raises(ConfigError, match="6 trials need as many environments, not 5"):
        roll_out(
            PointEnv(5, autoreset=False),
            FullSpeed(),
            np.ones((3, 1)),
            RolloutConfig(repetitions=2),
            network=0,
            seed=0,
            monitor=SilentMonitor(),
        )
