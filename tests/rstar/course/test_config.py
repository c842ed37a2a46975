import ast
import inspect

import pytest

from surmount.core import configuration
from surmount.core.errors import ConfigError
from surmount.rstar.course import config as envs_config
from surmount.rstar.course import randomisation
from surmount.rstar.course.config import CourseConfig, EnvConfig, RewardConfig, StartConfig
from surmount.rstar.robot import config as robot_config
from surmount.rstar.robot.config import RobotConfig


def test_default_decisions_and_cap_are_whole_ticks_and_steps():
    config = EnvConfig()
    assert config.physics_steps_per_step * config.robot.physics_step_s == pytest.approx(
        config.step_s
    )
    assert config.steps_per_episode * config.step_s == pytest.approx(20.0)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: EnvConfig(step_s=0.012), "step_s"),
        (lambda: EnvConfig(episode_s=0.005), "episode_s"),
        (lambda: EnvConfig(step_s=float("nan")), "step_s"),
        (lambda: CourseConfig(target_m=1.0), "floor_front_m"),
        (lambda: CourseConfig(floor_half_width_m=-1.0), "floor_half_width_m"),
        (lambda: StartConfig(region="behind"), "start.region"),
        (lambda: StartConfig(sprawl_min_deg=80.0, sprawl_max_deg=70.0), "sprawl_min_deg"),
        (lambda: RewardConfig(distance_unit_m=0.0), "distance_unit_m"),
        (lambda: RewardConfig(yaw_limits_deg=(10.0, 5.0)), "yaw_limits_deg"),
        (lambda: RewardConfig(yaw_gains=(1.0, float("inf"), 1.0)), "yaw_gains"),
    ],
)
def test_values_out_of_range_are_refused_naming_the_field(make, field):
    with pytest.raises(ConfigError, match=field):
        make()


def test_every_field_can_be_read_from_dotted_keys_and_goes_to_json_and_back():
    config = configuration.override(
        EnvConfig(),
        {"robot.gear": "both", "reward.yaw_limits_deg": "[4.0, 9.0]", "step_s": 0.05},
    )
    assert config.robot.gear == "both"
    assert config.reward.yaw_limits_deg == (4.0, 9.0)
    assert configuration.from_record(EnvConfig, configuration.to_record(config)) == config


@pytest.mark.parametrize("module", [envs_config, randomisation, robot_config])
def test_every_configuration_field_says_what_it_is_and_where_it_comes_from(module):
    for node in ast.walk(ast.parse(inspect.getsource(module))):
        if not isinstance(node, ast.ClassDef):
            continue
        for field, text in zip(node.body, [*node.body[1:], None], strict=True):
            if isinstance(field, ast.AnnAssign):
                assert isinstance(text, ast.Expr), f"{node.name}.{ast.unparse(field.target)}"
                sentence = ast.literal_eval(text.value)
                nested = ast.unparse(field.annotation).endswith("Config")
                sourced = any(word in sentence for word in ("assumed", "paper", "simulation"))
                assert nested or sourced, sentence


def test_robot_configuration_is_part_of_the_environments():
    assert EnvConfig(robot=RobotConfig(friction=0.9)).robot.friction == 0.9
