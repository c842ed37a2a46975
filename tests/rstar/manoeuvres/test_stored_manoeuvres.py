from dataclasses import replace

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from surmount.core.errors import ConfigError, InputError
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.manoeuvres.manoeuvre import Player
from surmount.rstar.manoeuvres.stored import stored_manoeuvre, stored_manoeuvres

DEFAULT = EnvConfig()


def replayed(name, config):
    """Success and time in s of every stored manoeuvre, played in the environment itself."""
    stored = stored_manoeuvres(name)
    env = ObstacleVectorEnv(
        name, len(stored), config=config, n_threads=2, autoreset_mode=AutoresetMode.DISABLED
    )
    sizes = np.array([found.size_mm for found in stored])
    obs, infos = env.reset(seed=0, options={"variant": sizes, "start": "fixed"})
    player = Player([found.manoeuvre for found in stored], config.step_s)
    distance = 5 if name == "step" else 4
    running = np.ones(len(stored), dtype=bool)
    while running.any():
        obs, _, terminated, truncated, infos = env.step(player.act(-0.3 * obs[:, distance]))
        running &= ~(terminated | truncated)
    return infos["is_success"], infos["features"][:, 0]


@pytest.mark.parametrize("name", OBSTACLES)
def test_every_variant_has_a_manoeuvre_that_succeeds_from_the_fixed_start_within_20_s(name):
    assert [found.size_mm for found in stored_manoeuvres(name)] == list(OBSTACLES[name].variants)
    success, time_s = replayed(name, DEFAULT)
    assert success.all()
    assert time_s.max() < 20.0
    # The base has 0.584 m to go and drives at 0.25 m/s at the most: 2.3 s at the least, less what
    # the body moves ahead of the wheels (48 mm).
    assert time_s.min() > (0.584 - 0.048) / 0.25


@pytest.mark.parametrize("name", OBSTACLES)
def test_halving_the_physics_step_changes_no_outcome_where_the_margins_say_so(name):
    physics_step_s = DEFAULT.robot.physics_step_s / 2
    finer = replace(DEFAULT, robot=replace(DEFAULT.robot, physics_step_s=physics_step_s))
    success, _ = replayed(name, finer)
    bear = np.array(["half physics step" in found.bears for found in stored_manoeuvres(name)])
    assert success[bear].all()  # whether others succeed may depend on the processor's rounding
    assert bear.sum() >= bear.size - 1


def test_a_size_between_variants_gets_the_manoeuvre_of_the_next_harder_one():
    assert stored_manoeuvre("step", 33.4).size_mm == 34.0
    assert stored_manoeuvre("low-entrance", 57.0).size_mm == 55.0
    assert stored_manoeuvre("narrow-channel", 180.0).size_mm == 180.0
    with pytest.raises(InputError, match="No stored manoeuvre"):
        stored_manoeuvre("step", 50.5)
    with pytest.raises(ConfigError):
        stored_manoeuvre("wall", 50.0)
