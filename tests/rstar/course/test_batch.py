import json
import os
from dataclasses import replace

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from scipy import stats

from surmount.core.errors import ConfigError, InputError
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import CourseConfig, EnvConfig, RewardConfig
from surmount.rstar.course.infos import INFO_KEYS
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.course.single import ObstacleEnv
from surmount.rstar.robot.config import RobotConfig
from surmount.tasks.distribution import TaskDistribution

NAMES = tuple(OBSTACLES)
SHORT = EnvConfig(step_s=0.02, episode_s=0.3)
"""Episodes of 15 short steps: resets happen often and cheaply."""
TENTHS = EnvConfig(step_s=0.1)
"""Ten steps a second."""


def actions(steps, envs, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (steps, envs, 3))


def run(env, plan):
    outputs = []
    for action in plan:
        obs, reward, terminated, truncated, infos = env.step(action)
        outputs.append((obs, reward, terminated, truncated, infos["features"], infos["variant"]))
    return [np.array(column) for column in zip(*outputs, strict=True)]


ASKED = replace(SHORT, observe_targets=True, reward=RewardConfig(distance_point="carriers"))
"""The same, with everything that is measured on request only."""


@pytest.mark.parametrize("config", [SHORT, ASKED], ids=["default", "asked"])
@pytest.mark.parametrize("name", NAMES)
def test_batched_trajectories_equal_single_ones_to_the_last_bit_at_any_thread_count(name, config):
    plan = actions(40, 5)
    runs = []
    for n_threads in (1, 2, 5):
        env = ObstacleVectorEnv(name, 5, config=config, n_threads=n_threads)
        env.reset(seed=[3, 1, 4, 1, 5])
        runs.append(run(env, plan))
    for other in runs[1:]:
        for a, b in zip(runs[0], other, strict=True):
            np.testing.assert_array_equal(a, b)
    for index, seed in enumerate([3, 1, 4, 1, 5]):
        env = ObstacleEnv(name, config=config)
        env.reset(seed=seed)
        for step, action in enumerate(plan[:, index]):
            obs, reward, terminated, truncated, info = env.step(action)
            final = (reward, terminated, truncated)
            if terminated or truncated:
                obs, info = env.reset()
            whole = (obs, *final, info["features"], info["variant"])
            for a, b in zip(whole, runs[0], strict=True):
                np.testing.assert_array_equal(a, b[step, index])


def test_a_seeds_streams_do_not_depend_on_the_number_of_environments():
    few, many = ObstacleVectorEnv("step", 2), ObstacleVectorEnv("step", 7)
    obs_few, infos_few = few.reset(seed=11)
    obs_many, infos_many = many.reset(seed=11)
    np.testing.assert_array_equal(obs_few, obs_many[:2])
    np.testing.assert_array_equal(infos_few["variant"], infos_many["variant"][:2])
    assert len(np.unique(infos_many["variant"])) == 7
    other, _ = many.reset(seed=12)
    assert not np.array_equal(other, obs_many)


@pytest.mark.parametrize("config", [SHORT, ASKED], ids=["default", "asked"])
@pytest.mark.parametrize("name", NAMES)
def test_continuing_from_a_saved_state_is_bit_identical_across_resets(name, config):
    env = ObstacleVectorEnv(name, 3, config=config)
    env.reset(seed=0)
    env.set_task_distribution(
        TaskDistribution.uniform(
            env.task_parameters,
            np.array([OBSTACLES[name].lower]),
            np.array([OBSTACLES[name].lower + 3]),
        )
    )
    run(env, actions(10, 3))
    state = env.state_dict()
    arrays = {key: value for key, value in state.items() if isinstance(value, np.ndarray)}
    rest = json.loads(json.dumps({k: v for k, v in state.items() if k not in arrays}))
    expected = run(env, actions(40, 3, seed=1))
    again = ObstacleVectorEnv(name, 3, config=config, n_threads=2)
    again.load_state_dict({**arrays, **rest})
    for a, b in zip(expected, run(again, actions(40, 3, seed=1)), strict=True):
        np.testing.assert_array_equal(a, b)
    assert expected[3].any()  # episodes did end and begin anew


def test_a_state_of_another_environment_is_refused():
    env = ObstacleVectorEnv("step", 2)
    env.reset(seed=0)
    with pytest.raises(InputError, match="expected"):
        ObstacleVectorEnv("step", 3).load_state_dict(env.state_dict())
    with pytest.raises(InputError, match="expected"):
        ObstacleVectorEnv("low-entrance", 2).load_state_dict(env.state_dict())


def test_the_robot_meets_the_obstacle_that_the_variant_names():
    # Rays measure the opening in the simulated world: between the walls, under the lintel, and
    # down onto the step.
    probes = {
        "narrow-channel": ((0.15, 0.0, 0.14), [(0, 1, 0), (0, -1, 0)], lambda d: d.sum()),
        "low-entrance": ((0.15, 0.2, 0.001), [(0, 0, 1)], lambda d: d[0] + 0.001),
        "step": ((0.15, 0.1, 0.3), [(0, 0, -1)], lambda d: 0.3 - d[0]),
    }
    for name, (origin, directions, opening) in probes.items():
        variants = OBSTACLES[name].variants
        env = ObstacleVectorEnv(name, variants.size)
        env.reset(seed=0, options={"variant": variants, "start": "fixed"})
        for index, size in enumerate(variants):
            data = env.simulation.data(index)
            hits = []
            for direction in directions:
                geom = np.zeros(1, dtype=np.int32)
                hits.append(
                    mujoco.mj_ray(
                        env.simulation.model, data, origin, direction, None, 1, -1, geom, None
                    )
                )
            assert opening(np.array(hits)) * 1e3 == pytest.approx(size, abs=1e-6)


def test_a_wide_channel_lets_pass_what_a_narrow_one_stops():
    env = ObstacleVectorEnv(
        "narrow-channel", 2, config=TENTHS, autoreset_mode=AutoresetMode.DISABLED
    )
    env.reset(seed=0, options={"variant": [180.0, 300.0], "start": "fixed"})
    ahead = np.tile([1.0, 0.0, 0.0], (2, 1))
    for _ in range(60):
        _, _, terminated, _, infos = env.step(ahead)
    # The start pose is 248 mm wide; 0.58 m take less than 3 s at 0.25 m/s.
    assert infos["is_success"].tolist() == [False, True]
    assert terminated.tolist() == [False, True]
    assert infos["features"][0, 3] > 0.35  # stopped before the walls


def test_drawn_variants_follow_the_mixture_across_autoresets():
    env = ObstacleVectorEnv("step", 9, config=EnvConfig(step_s=0.005, episode_s=0.005))
    env.set_task_distribution(
        TaskDistribution(
            parameters=("height_mm",),
            weights=np.array([0.7, 0.2, 0.1]),
            lower=np.array([[21.0], [33.5], [46.5]]),
            upper=np.array([[33.5], [46.5], [50.0]]),
        )
    )
    env.reset(seed=0)
    drawn = []
    for _ in range(300):  # every step ends every episode
        _, _, _, truncated, infos = env.step(np.zeros((9, 3)))
        assert truncated.all()
        drawn.append(infos["variant"][:, 0])
        assert (infos["final_info"]["variant"][:, 0] != infos["variant"][:, 0]).all()
    sizes = np.concatenate(drawn)
    edges = np.array([21.0, 27.25, 33.5, 40.0, 46.5, 48.25, 50.0])
    counts, _ = np.histogram(sizes, edges)
    expected = np.array([0.35, 0.35, 0.1, 0.1, 0.05, 0.05]) * sizes.size
    assert counts.sum() == sizes.size
    assert stats.chisquare(counts, expected).pvalue > 0.001
    other = stats.chisquare(counts, np.full(6, sizes.size / 6)).pvalue
    assert other < 1e-9  # the test would notice a distribution that was not applied


def test_same_step_autoreset_hands_over_the_last_values_of_the_old_episode():
    env = ObstacleVectorEnv("step", 3, config=SHORT)
    frozen = ObstacleVectorEnv("step", 3, config=SHORT, autoreset_mode=AutoresetMode.DISABLED)
    first, _ = env.reset(seed=[1, 2, 3])
    frozen.reset(seed=[1, 2, 3])
    for step, action in enumerate(actions(15, 3)):
        obs, _, _, truncated, infos = env.step(action)
        last, _, _, same, last_infos = frozen.step(action)
        np.testing.assert_array_equal(truncated, same)
        if step < 14:
            np.testing.assert_array_equal(obs, last)
            assert "final_obs" not in infos
    assert truncated.all()
    np.testing.assert_array_equal(np.stack(list(infos["final_obs"])), last)
    assert infos["_final_obs"].all()
    for key in INFO_KEYS:
        np.testing.assert_array_equal(infos["final_info"][key], last_infos[key])
        assert infos["final_info"][f"_{key}"].all()
    assert infos["features"][:, 0].tolist() == [0, 0, 0]
    assert last_infos["features"][:, 0] == pytest.approx([0.3, 0.3, 0.3])
    assert infos["sprawl_path_deg"].tolist() == [0, 0, 0]
    assert (last_infos["sprawl_path_deg"] > 0).all()
    assert not np.array_equal(obs, first)


def test_without_autoreset_an_ended_episode_stays_frozen_until_it_is_reset():
    env = ObstacleVectorEnv("step", 2, config=SHORT, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    plan = actions(20, 2)
    for action in plan[:15]:
        env.step(action)
    at_end = env.state_dict()["simulation"]
    _, reward, _, truncated, _ = env.step(plan[15])
    assert truncated.all()
    assert reward.tolist() == [0.0, 0.0]
    env.reset(options={"reset_mask": np.array([False, True])})
    _, reward, _, truncated, infos = env.step(plan[16])
    assert truncated.tolist() == [True, False]
    assert reward[0] == 0.0
    assert reward[1] < 0.0
    assert infos["features"][:, 0] == pytest.approx([0.3, 0.02])
    time_column = at_end[0, 0]
    assert env.state_dict()["simulation"][0, 0] == time_column


def test_next_step_autoreset_ignores_the_action_of_the_resetting_step():
    env = ObstacleVectorEnv("step", 1, config=SHORT, autoreset_mode="NextStep")
    env.reset(seed=0)
    for action in actions(15, 1):
        _, _, _, truncated, _ = env.step(action)
    assert truncated[0]
    _, reward, terminated, truncated, infos = env.step(np.ones((1, 3)))
    assert (reward[0], terminated[0], truncated[0]) == (0.0, False, False)
    assert infos["features"][0, 0] == 0.0


@pytest.mark.parametrize("name", NAMES)
def test_the_logged_distance_is_euclidean_to_the_middle_of_the_line_at_the_height_of_the_start(
    name,
):
    env = ObstacleVectorEnv(name, 3, n_threads=1)
    env.reset(seed=0)
    for action in actions(60, 3):
        _, _, _, _, infos = env.step(action)
    base = np.array([env.simulation.data(index).body("base").xpos for index in range(3)])
    # The line is on the floor, on which the start pose stands 70.89 mm high.
    target = np.array([0.32, 0.0, 0.0708932])
    expected = np.linalg.norm(base - target, axis=1)
    np.testing.assert_allclose(infos["features"][:, 3], expected, rtol=0, atol=1e-7)
    plane = np.linalg.norm((base - target)[:, :2], axis=1)
    assert np.abs(expected - plane).max() > 1e-4


def test_a_target_line_on_the_step_has_its_point_above_the_step():
    course = CourseConfig(target_m=0.25)
    env = ObstacleVectorEnv("step", 2, config=EnvConfig(course=course), n_threads=1)
    _, infos = env.reset(seed=0, options={"variant": [25.0, 45.0], "start": "fixed"})
    along = 0.25 - course.fixed_start_m
    expected = np.hypot(along, [0.025, 0.045])
    np.testing.assert_allclose(infos["features"][:, 3], expected, rtol=0, atol=1e-9)
    again = ObstacleVectorEnv("step", 2, config=EnvConfig(course=course), n_threads=1)
    again.load_state_dict(env.state_dict())
    stay = np.zeros((2, 3))
    np.testing.assert_array_equal(env.step(stay)[4]["features"], again.step(stay)[4]["features"])


def test_driving_off_the_floor_ends_the_episode_with_minus_five():
    env = ObstacleEnv("step", config=TENTHS)
    env.reset(seed=0, options={"variant": 30, "start": "fixed"})
    for _ in range(200):
        _, reward, terminated, truncated, info = env.step([-1.0, 0.0, -1.0])
        if terminated or truncated:
            break
    assert terminated
    assert not info["is_success"]
    # (0.75 − 0.264) m at 0.25 m/s take the base to the edge in 2 s; there a robot with its legs
    # straight down topples. Lower ones stay on it: carriers slide only while wheels still push.
    assert 2.0 < info["features"][0] < 10.0
    assert -8.0 < reward < -5.0


def test_speed_command_is_limited_to_a_quarter_metre_a_second_and_one_metre_a_second_squared():
    env = ObstacleVectorEnv("low-entrance", 1, config=TENTHS, autoreset_mode=AutoresetMode.DISABLED)
    _, infos = env.reset(seed=0, options={"variant": 140, "start": "fixed"})
    distance = [infos["features"][0, 3]]
    for _ in range(15):
        _, _, _, _, infos = env.step([[1.0, 0.0, 0.0]])
        distance.append(infos["features"][0, 3])
    speed = -np.diff(distance) / 0.1
    # A target v = t, followed with the wheels' lag τ = 0.001/0.06 s, covers 0.0036 m in 0.1 s.
    assert speed[0] == pytest.approx(0.036, abs=0.010)
    assert speed[5:] == pytest.approx(0.25, rel=0.05)  # tyres slip by a few per cent


def test_tyres_roll_without_slip_when_the_robot_accelerates_within_its_friction():
    # 1 m/s² needs a tenth of the friction. An implicit damper on too light a wheel would break
    # this: contacts would not feel it.
    config = EnvConfig(step_s=0.02)
    env = ObstacleVectorEnv("low-entrance", 1, config=config, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0, options={"variant": 140, "start": "fixed"})
    for _ in range(25):
        env.step(np.zeros((1, 3)))  # settle
    for step in range(45):
        obs, _, _, _, _ = env.step([[1.0 if step < 15 else -1.0, 0.0, 0.0]])
        rim = obs[0, 3] * 0.25
        body = env.simulation.batch.bind("qvel")[0, 0]
        assert body == pytest.approx(rim, abs=0.015)
    assert rim == pytest.approx(-0.25, abs=0.06)


def test_angle_commands_ramp_at_80_degrees_a_second_whatever_the_decision_interval():
    for interval in (0.1, 0.05, 0.02):
        config = EnvConfig(step_s=interval)
        env = ObstacleVectorEnv("low-entrance", 1, config=config)
        env.reset(seed=0, options={"variant": 140, "start": "fixed"})
        for _ in range(round(0.4 / interval)):
            _, _, _, _, infos = env.step([[0.0, 0.5, -1.0]])
        # Targets: 48 − 32 and 16 degrees. Moving servos lag by rate x damping/stiffness: 1.6 and
        # 1 degree; the robot's weight adds up to 1 degree.
        assert infos["features"][0, 1] == pytest.approx(17.6, abs=1.5)
        assert infos["features"][0, 2] == pytest.approx(15.0, abs=1.5)


def test_a_diverged_simulation_ends_its_episode_is_counted_and_never_shows_nan(
    monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    for mode in (AutoresetMode.SAME_STEP, AutoresetMode.DISABLED):
        env = ObstacleVectorEnv("step", 3, config=TENTHS, autoreset_mode=mode)
        env.reset(seed=0)
        env.simulation.batch.bind("qfrc_applied")[1, 3] = 1e14
        obs, reward, terminated, _, infos = env.step(np.zeros((3, 3)))
        final = infos["final_info"] if mode is AutoresetMode.SAME_STEP else infos
        assert terminated.tolist() == [False, True, False]
        assert final["diverged"].tolist() == [False, True, False]
        assert not final["is_success"].any()
        assert -6.0 < reward[1] < -5.0
        for values in (obs, reward, infos["features"], final["features"]):
            assert np.isfinite(values).all()
        assert np.isfinite(env.state_dict()["simulation"]).all()
        obs, reward, _, _, _ = env.step(np.zeros((3, 3)))
        assert np.isfinite(obs).all()
        assert np.isfinite(reward).all()
    assert list(tmp_path.iterdir()) == []  # MuJoCo's log file would lie here


def random_run(name, steps, config=None):
    """Deepest contacts in mm of the robot with floor and obstacle over random actions."""
    env = ObstacleVectorEnv(name, 9, config=config or TENTHS)
    env.reset(seed=0)
    rng = np.random.default_rng(1)
    deepest, diverged, fastest = 0.0, 0, 0.0
    action = np.zeros((9, 3))
    for step in range(steps // 9):
        if step % 3 == 0:  # held for a while, actions reach the ends of the ranges
            action = rng.uniform(-1, 1, (9, 3)).round() * rng.uniform(0, 1, (9, 1))
        obs, reward, _, _, infos = env.step(action)
        assert env.observation_space.contains(obs)
        assert np.isfinite(reward).all()
        assert np.isfinite(infos["features"]).all()
        if "final_info" in infos:
            diverged += int(infos["final_info"]["diverged"].sum())
        fastest = max(fastest, float(np.abs(env.simulation.batch.bind("qvel")[:, :3]).max()))
        if step % 10 == 0:
            data = env.simulation.data(step % 9)
            deepest = min(deepest, float(data.contact.dist.min(initial=0.0)))
    return -deepest * 1e3, diverged, fastest


@pytest.mark.parametrize("name", NAMES)
def test_random_actions_neither_diverge_nor_push_the_robot_into_floor_or_obstacle(name):
    deepest_mm, diverged, fastest = random_run(name, 2_000)
    assert diverged == 0
    assert 0.0 < deepest_mm < 6.0
    assert fastest < 5.0


@pytest.mark.slow
@pytest.mark.parametrize("gear", ["wheels", "both"])
@pytest.mark.parametrize("name", NAMES)
def test_long_random_runs_neither_diverge_nor_penetrate(name, gear):
    deepest_mm, diverged, fastest = random_run(
        name, 50_000, EnvConfig(robot=RobotConfig(gear=gear), step_s=0.1)
    )
    assert diverged == 0
    assert 0.0 < deepest_mm < 6.0
    assert fastest < 5.0


@pytest.mark.parametrize(
    ("call", "error"),
    [
        (lambda: ObstacleVectorEnv("hurdle", 1), ConfigError),
        (lambda: ObstacleVectorEnv("step", 0), ConfigError),
        (lambda: ObstacleVectorEnv("step", 1, render_mode="ansi"), ConfigError),
        (lambda: ObstacleVectorEnv("step", 1).step(np.zeros((1, 3))), InputError),
        (lambda: ObstacleVectorEnv("step", 1).reset(options={"variant": 500.0}), InputError),
        (lambda: ObstacleVectorEnv("step", 1).reset(options={"variant": np.nan}), InputError),
        (lambda: ObstacleVectorEnv("step", 2).reset(options={"variant": np.ones(3)}), InputError),
        (lambda: ObstacleVectorEnv("step", 1).reset(options={"size": 30}), InputError),
        (lambda: ObstacleVectorEnv("step", 1).reset(options={"start": "here"}), InputError),
        (lambda: ObstacleVectorEnv("step", 2).reset(seed=[1]), InputError),
    ],
)
def test_bad_arguments_are_refused_with_a_remedy(call, error):
    with pytest.raises(error) as caught:
        call()
    assert caught.value.remedy


def test_actions_that_are_not_finite_are_refused():
    env = ObstacleVectorEnv("step", 1)
    env.reset(seed=0)
    with pytest.raises(InputError, match="finite"):
        env.step([[0.0, np.nan, 0.0]])


def test_task_distributions_over_other_parameters_or_sizes_are_refused():
    env = ObstacleVectorEnv("step", 1)
    for parameter, size in (("width_mm", 30.0), ("height_mm", 80.0)):
        wrong = TaskDistribution.uniform((parameter,), np.array([size]), np.array([size]))
        with pytest.raises(InputError):
            env.set_task_distribution(wrong)


@pytest.mark.parametrize("obstacle", OBSTACLES.values(), ids=NAMES)
def test_registered_vector_environments_declare_mode_spaces_and_tasks(obstacle):
    env = gymnasium.make_vec(obstacle.gym_id, num_envs=9, vectorization_mode="vector_entry_point")
    assert isinstance(env, ObstacleVectorEnv)
    assert env.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert env.single_observation_space.shape == (7 if obstacle.name == "step" else 6,)
    assert env.task_parameters == (obstacle.parameter,)
    assert env.step_s == 0.01
    assert env.feature_names == ("time_s", "sprawl_deg", "fbem_deg", "distance_m")
    obs, infos = env.reset(seed=0)
    assert env.observation_space.contains(obs)
    assert infos["features"].shape == (9, 4)
    assert infos["variant"].shape == (9, 1)
    for key in INFO_KEYS:
        assert infos[key].shape[0] == 9
        assert infos[f"_{key}"].all()
    assert infos.keys() == {*INFO_KEYS, *(f"_{key}" for key in INFO_KEYS)}
    env.close()


def test_a_task_distribution_pushed_to_gymnasiums_vector_environments_holds_across_autoresets():
    env = gymnasium.make_vec(
        "surmount/Step-v0", num_envs=2, vectorization_mode="sync", config=EnvConfig(episode_s=0.02)
    )
    env.reset(seed=0)
    edge = TaskDistribution.uniform(("height_mm",), np.array([40.0]), np.array([50.0]))
    env.call("set_task_distribution", edge)
    env.step(env.action_space.sample())  # ends episodes that were drawn before
    sizes = []
    for _ in range(60):  # each episode takes one step, and one in which it begins anew
        _, _, _, truncated, infos = env.step(env.action_space.sample())
        sizes.append(infos["variant"][~truncated, 0])
    env.close()
    sizes = np.concatenate(sizes)
    assert sizes.size > 50
    assert stats.kstest(sizes, stats.uniform(40.0, 10.0).cdf).pvalue > 0.001


def test_threads_are_chosen_by_environments_and_processors_unless_they_are_given():
    processors = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    )
    for num_envs, most in ((1, 1), (7, 1), (8, 2), (400, 100)):
        env = ObstacleVectorEnv("step", num_envs)
        assert env.simulation.batch.nthread == min(most, processors)
    assert ObstacleVectorEnv("step", 3, n_threads=2).simulation.batch.nthread == 2
    with pytest.raises(ConfigError, match="n_threads"):
        ObstacleVectorEnv("step", 3, n_threads=0)


def test_infos_tell_the_share_of_the_way_from_the_fixed_start_to_the_target_line():
    env = ObstacleVectorEnv("step", 2, config=SHORT, start="fixed")
    _, infos = env.reset(seed=0)
    np.testing.assert_allclose(infos["covered"], 0.0, atol=1e-6)
    course, shares = SHORT.course, []
    for _ in range(15):
        x_m = env.simulation.measure().x_m
        way_m = course.target_m - course.fixed_start_m
        expected = np.clip((x_m - course.fixed_start_m) / way_m, 0.0, 1.0)
        np.testing.assert_array_equal(infos["covered"], expected)
        shares.append(infos["covered"].max())
        _, _, _, truncated, infos = env.step(np.array([[1.0, 0.0, 0.0]] * 2))
    assert truncated.all()
    assert 0.0 < max(shares) <= infos["final_info"]["covered"].max() <= 1.0
    env.close()
