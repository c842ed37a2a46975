import json

import mujoco
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from scipy import stats

from surmount.core.errors import ConfigError, InputError
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES, find_obstacle
from surmount.rstar.course.randomisation import FACTORS, RandomisationConfig, draw
from surmount.rstar.course.scene import build_model
from surmount.rstar.course.single import ObstacleEnv
from surmount.rstar.robot import constants as c

EVERYTHING = RandomisationConfig(
    friction_factor=(0.5, 1.2),
    mass_factor=(0.8, 1.3),
    sprawl_gain_factor=(0.7, 1.4),
    fbem_gain_factor=(0.7, 1.4),
    wheel_gain_factor=(0.7, 1.4),
    action_delay_steps=(0, 3),
    attitude_noise_deg=1.0,
    joint_noise_deg=0.5,
    speed_noise_mps=0.01,
    distance_noise_m=0.005,
    size_noise_mm=2.0,
)
FIXED = {"start": "fixed"}


def course(name="low-entrance", num_envs=1, mode=AutoresetMode.DISABLED, **randomisation):
    config = EnvConfig(step_s=0.02, randomisation=RandomisationConfig(**randomisation))
    env = ObstacleVectorEnv(name, num_envs, config=config, autoreset_mode=mode)
    env.reset(seed=0, options={**FIXED, "variant": find_obstacle(name).upper})
    return env


def sag_deg(**randomisation):
    """How far the legs give way under the robot's weight at rest, in degrees."""
    env = course(**randomisation)
    for _ in range(60):
        _, _, _, _, infos = env.step(np.zeros((1, 3)))
    return abs(48.0 - infos["features"][0, 1])


@pytest.mark.parametrize("name", OBSTACLES)
def test_without_randomisation_the_physics_is_that_of_a_bare_mujoco_loop_to_the_last_bit(name):
    config = EnvConfig()
    assert config.randomisation.is_off
    env = ObstacleVectorEnv(name, 2, config=config, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    model = build_model(find_obstacle(name), config)
    datas = [mujoco.MjData(model) for _ in range(2)]
    whole = mujoco.mjtState.mjSTATE_INTEGRATION.value
    for data, row in zip(datas, env.state_dict()["simulation"], strict=True):
        mujoco.mj_setState(model, data, row, whole)
    kind = [
        {"fbem": 1, "sprawl": 2}.get(model.actuator(i).name.split("_")[-1], 0)
        for i in range(model.nu)
    ]
    full = [1.0 / (c.WHEEL_RADIUS_MM * 1e-3), np.deg2rad(80.0), np.deg2rad(80.0)]
    rng = np.random.default_rng(1)
    for _ in range(40):
        action = rng.uniform(-1, 1, (2, 3))
        env.step(action)
        for index, data in enumerate(datas):
            data.ctrl[:] = [action[index, k] * full[k] for k in kind]
            mujoco.mj_step(model, data, config.physics_steps_per_step)
    rows = env.state_dict()["simulation"]
    for data, row in zip(datas, rows, strict=True):
        expected = np.empty(row.size)
        mujoco.mj_getState(model, data, expected, whole)
        np.testing.assert_array_equal(row, expected)


def test_drawn_factors_and_delays_are_uniform_over_their_ranges():
    rng = np.random.default_rng(0)
    factors, delays = zip(*(draw(EVERYTHING, rng) for _ in range(4000)), strict=True)
    for column, name in zip(np.array(factors).T, FACTORS, strict=True):
        low, high = getattr(EVERYTHING, name)
        assert stats.kstest(column, stats.uniform(low, high - low).cdf).pvalue > 0.001, name
    assert stats.chisquare(np.bincount(delays, minlength=4)).pvalue > 0.001
    # Each is drawn on its own: correlations of 4,000 independent pairs stay below 4/sqrt(4000).
    correlations = np.corrcoef(np.column_stack([factors, delays]).T) - np.eye(6)
    assert np.abs(correlations).max() < 0.065


def test_every_reset_draws_anew_and_gives_the_simulation_what_infos_say():
    env = ObstacleVectorEnv("step", 20, config=EnvConfig(randomisation=EVERYTHING))
    nominal = env.simulation.model
    robot = nominal.body_rootid == nominal.body("base").id
    solid = np.flatnonzero(nominal.geom_contype)
    drawn = []
    for seed in range(3):
        _, infos = env.reset(seed=seed)
        drawn.append(infos["dynamics"])
        assert set(infos["action_delay"]) <= {0, 1, 2, 3}
        for index in (0, 19):
            model = env.simulation.batch.get_model(index)
            friction, mass, sprawl, fbem, wheel = infos["dynamics"][index]
            ratio = model.geom_friction[solid, 0] / nominal.geom_friction[solid, 0]
            assert ratio == pytest.approx(friction)
            weight = model.body_subtreemass[model.body("base").id]
            assert weight == pytest.approx(mass * c.SIMULATION_MASS_KG)
            assert model.body_inertia[robot] == pytest.approx(mass * nominal.body_inertia[robot])
            for servo, factor in (
                ("left_sprawl", sprawl),
                ("right_fbem", fbem),
                ("left_rear", wheel),
            ):
                for field in ("gainprm", "biasprm"):
                    own = getattr(model.actuator(servo), field)
                    assert own == pytest.approx(factor * getattr(nominal.actuator(servo), field))
    factors = np.concatenate(drawn)
    assert len(np.unique(factors[:, 0])) == 60
    assert stats.kstest(factors[:, 1], stats.uniform(0.8, 0.5).cdf).pvalue > 0.001


def test_a_robot_twice_as_heavy_sags_twice_as_far_and_a_doubled_gain_halves_that():
    plain = sag_deg()
    assert plain > 0.1
    # Torques are linear in the weight, and the leverage changes by less than a degree's worth.
    assert sag_deg(mass_factor=(2.0, 2.0)) == pytest.approx(2 * plain, rel=0.06)
    assert sag_deg(sprawl_gain_factor=(2.0, 2.0)) == pytest.approx(plain / 2, rel=0.06)


def test_on_a_slippery_ground_friction_and_not_the_servo_limits_the_acceleration():
    factor = 0.04
    env = course(friction_factor=(factor, factor))
    for _ in range(25):
        env.step(np.zeros((1, 3)))  # settle
    before = env.simulation.batch.bind("qvel")[0, 0]
    for _ in range(15):
        env.step([[1.0, 0.0, 0.0]])
    gained = env.simulation.batch.bind("qvel")[0, 0] - before
    # Sliding tyres push with μ m g, whatever the wheels do: 0.51 m/s² instead of 1 m/s². The first
    # steps, in which the wheels are still too slow to slide, take a little off.
    limit = env.config.robot.friction * factor * 9.81 * 15 * 0.02
    assert gained == pytest.approx(limit, rel=0.12)
    assert gained < 0.6 * 15 * 0.02


def test_noise_is_normal_has_the_stated_deviation_and_shows_in_nothing_but_observations():
    noisy = course(
        "step",
        9,
        **{name: getattr(EVERYTHING, name) for name in vars(EVERYTHING) if "noise" in name},
    )
    plain = course("step", 9)
    scale = np.array([90.0, 90.0, 72.0, 90.0, 0.25, 0.3, 14.5])
    stated = np.array([1.0, 1.0, 0.5, 0.5, 0.01, 0.005, 2.0])
    rng = np.random.default_rng(3)
    differences = []
    for _ in range(120):
        action = 0.3 * rng.uniform(-1, 1, (9, 3))
        seen, reward, terminated, truncated, infos = noisy.step(action)
        true, true_reward, true_terminated, true_truncated, true_infos = plain.step(action)
        differences.append((seen - true) * scale)
        np.testing.assert_array_equal(reward, true_reward)
        np.testing.assert_array_equal(terminated | truncated, true_terminated | true_truncated)
        assert infos.keys() == true_infos.keys()
        for key, value in infos.items():
            np.testing.assert_array_equal(value, true_infos[key])
    noise = np.concatenate(differences) / stated
    for column in noise.T:  # 1,080 draws each; mean and deviation are part of the hypothesis
        assert stats.kstest(column, stats.norm.cdf).pvalue > 0.001
        assert column.std() == pytest.approx(1.0, rel=0.08)  # 3.7 standard errors
    assert np.abs(np.corrcoef(noise.T) - np.eye(7)).max() < 0.13  # 4.3 standard errors


def test_observed_targets_are_free_of_noise_and_those_of_the_actions_that_have_arrived():
    noise = RandomisationConfig(joint_noise_deg=5.0, speed_noise_mps=0.1, action_delay_steps=(2, 2))
    config = EnvConfig(observe_targets=True, randomisation=noise)
    env = ObstacleVectorEnv("step", 2, config=config, n_threads=1)
    env.reset(seed=0, options={**FIXED, "variant": 30.0})
    for _ in range(12):
        seen, _, _, _, _ = env.step([[1.0, 1.0, -1.0]] * 2)
    # Ten of twelve actions of 0.01 s: 0.1 m/s of 0.25, 8° of 72°, and 40° of 90° ± 90°.
    assert seen[:, 6:9] == pytest.approx(np.array([[0.4, 8 / 72, -50 / 90]] * 2), abs=1e-6)


@pytest.mark.parametrize("delay", [1, 3])
def test_a_delay_of_so_many_decisions_is_the_undelayed_run_with_as_many_idle_ones_before(delay):
    late, prompt = course(action_delay_steps=(delay, delay)), course()
    plan = np.random.default_rng(2).uniform(-1, 1, (30, 1, 3))
    idle = np.zeros((delay, 1, 3))
    for decided, effective in zip(plan, np.concatenate([idle, plan])[: len(plan)], strict=True):
        seen, reward, _, _, infos = late.step(decided)
        expected, expected_reward, _, _, expected_infos = prompt.step(effective)
        np.testing.assert_array_equal(seen, expected)
        np.testing.assert_array_equal(reward, expected_reward)
        np.testing.assert_array_equal(infos["features"], expected_infos["features"])
    assert infos["action_delay"].tolist() == [delay]


def test_actions_of_an_old_episode_do_not_reach_the_new_one():
    env = course(action_delay_steps=(3, 3))
    for _ in range(5):
        env.step([[1.0, 1.0, 1.0]])
    env.reset(options={**FIXED, "variant": 140.0})
    fresh = course(action_delay_steps=(3, 3))
    for _ in range(5):
        seen, _, _, _, _ = env.step(np.zeros((1, 3)))
        expected, _, _, _, _ = fresh.step(np.zeros((1, 3)))
        np.testing.assert_array_equal(seen, expected)


SHORT = EnvConfig(episode_s=0.3, randomisation=EVERYTHING)


def run(env, plan):
    outputs = []
    for action in plan:
        obs, reward, terminated, truncated, infos = env.step(action)
        outputs.append((obs, reward, terminated, truncated, infos["features"], infos["dynamics"]))
    return [np.array(column) for column in zip(*outputs, strict=True)]


def test_randomised_runs_are_bit_identical_single_or_batched_at_any_thread_count():
    plan = np.random.default_rng(0).uniform(-1, 1, (40, 5, 3))
    seeds = [3, 1, 4, 1, 5]
    runs = []
    for n_threads in (1, 2, 5):
        env = ObstacleVectorEnv("step", 5, config=SHORT, n_threads=n_threads)
        env.reset(seed=seeds)
        runs.append(run(env, plan))
    for other in runs[1:]:
        for a, b in zip(runs[0], other, strict=True):
            np.testing.assert_array_equal(a, b)
    for index, seed in enumerate(seeds):
        env = ObstacleEnv("step", config=SHORT)
        env.reset(seed=seed)
        for step, action in enumerate(plan[:, index]):
            obs, reward, terminated, truncated, info = env.step(action)
            if terminated or truncated:
                obs, info = env.reset()
            whole = (obs, reward, terminated, truncated, info["features"], info["dynamics"])
            for a, b in zip(whole, runs[0], strict=True):
                np.testing.assert_array_equal(a, b[step, index])


def test_a_randomised_run_goes_on_bit_identically_from_a_saved_state():
    env = ObstacleVectorEnv("narrow-channel", 3, config=SHORT)
    env.reset(seed=0)
    plan = np.random.default_rng(0).uniform(-1, 1, (45, 3, 3))
    run(env, plan[:7])  # in the middle of an episode, with actions on their way
    state = env.state_dict()
    arrays = {key: value for key, value in state.items() if isinstance(value, np.ndarray)}
    rest = json.loads(json.dumps({k: v for k, v in state.items() if k not in arrays}))
    expected = run(env, plan[7:])
    again = ObstacleVectorEnv("narrow-channel", 3, config=SHORT)
    again.load_state_dict({**arrays, **rest})
    for a, b in zip(expected, run(again, plan[7:]), strict=True):
        np.testing.assert_array_equal(a, b)
    with pytest.raises(InputError, match="nothing"):
        ObstacleVectorEnv("narrow-channel", 3, config=EnvConfig()).load_state_dict(state)


def test_an_environment_that_is_not_reset_keeps_what_it_saw():
    env = course("step", 2, distance_noise_m=0.01)
    seen, _, _, _, _ = env.step(np.zeros((2, 3)))
    again, _ = env.reset(options={"reset_mask": np.array([False, True])})
    np.testing.assert_array_equal(seen[0], again[0])
    assert not np.array_equal(seen[1], again[1])


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("friction_factor", (0.0, 1.0)),
        ("mass_factor", (1.2, 1.1)),
        ("wheel_gain_factor", (1.0, float("nan"))),
        ("action_delay_steps", (-1, 2)),
        ("action_delay_steps", (0, 1000)),
        ("joint_noise_deg", -0.1),
        ("size_noise_mm", float("inf")),
    ],
)
def test_ranges_that_make_no_sense_are_refused_naming_the_field(field, value):
    with pytest.raises(ConfigError, match=field):
        RandomisationConfig(**{field: value})
