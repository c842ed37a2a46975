"""What is shown is what was logged, or says that it is not; what cannot be shown is refused."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
from small import run_first_stages, small_config

from surmount.core.errors import ConfigError, InputError, IntegrityError, OutputError
from surmount.envs.registry import find_family
from surmount.experiment.presets import preset
from surmount.experiment.running import begin
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import Actor, roll_out
from surmount.learn.snapshot import Snapshot
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.film.footage import Wanted, motions
from surmount.rstar.film.logged_trials import logged_motion, run_log
from surmount.rstar.film.motion import record_motion
from surmount.rstar.film.replay import CAPTION
from surmount.rstar.manoeuvres.manoeuvre import Player
from surmount.rstar.manoeuvres.stored import stored_manoeuvre
from surmount.trials.table import read_trials, write_trials
from surmount.workflow.monitor import SilentMonitor
from surmount.workflow.run_folder import open_run

STRAIGHT = {"speed_mps": 0.2, "fbem_deg": 0, "sprawl_deg": 20, "until_x_m": 1, "at_most_s": 20}
CONFIG = small_config(networks=1)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """Return the folder of a run that has trained its only network and logged its trials."""
    return run_first_stages(tmp_path_factory.mktemp("run"), CONFIG)


@pytest.fixture
def network(root):
    return next(root.glob("stages/initiation/**/network.safetensors"))


@pytest.fixture
def table(root):
    return next(root.glob("stages/trials/**/trials.parquet"))


def shown(source, **options):
    return list(motions(Wanted(source=str(source), **options)))


def test_a_trial_simulated_again_equals_its_log_to_the_last_bit(root, table):
    trials = read_trials(table)
    log = run_log(open_run(root), "trials/network-0", trials, "log")
    for trial in (0, 7, trials.n_trials - 1):
        motion = logged_motion(log, trial)
        rows = slice(trials.starts[trial], trials.starts[trial + 1])
        np.testing.assert_array_equal(motion.features, trials.features[rows])
        assert motion.caption.endswith("simulated again: equal to its log")
        assert motion.size_mm == trials.variant[trial, 0]
        assert motion.success == trials.success[trial]


def test_a_log_whose_distance_leaves_out_the_height_is_known_as_such(root, table):
    trials = read_trials(table)
    log = run_log(open_run(root), "trials/network-0", trials, "log")
    motion = logged_motion(log, 2)
    rows = slice(trials.starts[2], trials.starts[3])
    x_m, y_m = motion.qpos[:: CONFIG.env.physics_steps_per_step, :2].T
    older = trials.features.copy()
    ahead_m = CONFIG.env.course.target_m - x_m
    older[rows, 3] = np.sqrt(ahead_m * ahead_m + y_m * y_m)
    assert np.abs(older[rows, 3] - trials.features[rows, 3]).max() > 1e-6
    again = logged_motion(replace(log, trials=replace(trials, features=older)), 2)
    assert again.caption.endswith("equal to its log, whose distance leaves out the height")
    np.testing.assert_array_equal(again.qpos, motion.qpos)


def test_a_network_that_observes_targets_acts_as_in_its_roll_out(tmp_path):
    changes = {"env.observe_targets": True, "env.episode_s": 1.0, "initial_steps": 0}
    root = run_first_stages(tmp_path / "run", small_config(networks=1, **changes))
    (motion,) = shown(root, stage="trials/network-0")
    assert motion.caption.endswith("simulated again: equal to its log")
    (network,) = root.glob("stages/initiation/**/network.safetensors")
    with pytest.raises(InputError, match="takes 9 observations, and narrow-channel has 6"):
        shown(shutil.copy(network, tmp_path), changes={"env.observe_targets": False})


def test_a_trial_of_a_shard_is_simulated_again_with_the_shards_seed(tmp_path):
    shards = {"trials.repetitions": 3, "tests.repetitions": 2, "rollout_shards": 2}
    config = small_config(networks=1, initial_steps=0, **{"env.episode_s": 1.0}, **shards)
    root = run_first_stages(tmp_path / "run", config, stages=4)
    trials = read_trials(next(root.glob("stages/trials/**/trials.parquet")))
    variants, index = trials.variants()
    for variant in range(len(variants)):
        np.testing.assert_array_equal(trials.repetition[index == variant], [0, 1, 2])
    log = run_log(open_run(root), "trials/network-0", trials, "log")
    for repetition in range(3):
        motion = logged_motion(log, log.find(250.0, repetition, 0))
        assert motion.caption.endswith("simulated again: equal to its log")


def test_a_trial_with_randomised_physics_is_simulated_again_with_its_own_draws(tmp_path):
    ranges = {
        "env.randomisation.friction_factor": [0.7, 1.3],
        "env.randomisation.mass_factor": [0.8, 1.2],
        "env.randomisation.action_delay_steps": [0, 2],
        "env.randomisation.joint_noise_deg": 1.0,
        "env.episode_s": 1.0,
        "initial_steps": 0,
    }
    root = run_first_stages(tmp_path / "run", small_config(networks=1, **ranges))
    found = shown(root, stage="trials/network-0", sizes_mm=(180.0, 300.0), trials=(0, 1))
    for motion in found:
        assert motion.caption.endswith("simulated again: equal to its log")
    assert len({motion.qpos[-1, 0] for motion in found}) == 4


def test_trials_are_found_by_variant_and_number(root, table):
    found = shown(root, stage="trials/network-0", sizes_mm=(200.0, 320.0), trials=(1, 0))
    assert [motion.size_mm for motion in found] == [200.0, 200.0, 320.0, 320.0]
    assert [motion.caption[:7] for motion in found] == ["trial 1", "trial 0"] * 2
    (by_file,) = shown(table, sizes_mm=(200.0,), trials=(1,))
    np.testing.assert_array_equal(by_file.qpos, found[0].qpos)
    (default,) = shown(table)
    assert default.size_mm == 180.0  # the narrowest


def test_a_trial_that_departs_from_its_log_is_drawn_from_the_log(root, table):
    trials = read_trials(table)
    altered = trials.features.copy()
    altered[int(trials.starts[3]) + 5, 3] += 1e-12  # m
    log = run_log(open_run(root), "trials/network-0", replace(trials, features=altered), "log")
    motion = logged_motion(log, 3)
    assert CAPTION in motion.caption
    assert "it departs after 0.50 s" in motion.caption  # the fifth step of 0.1 s
    assert "equal" in logged_motion(log, 4).caption


def test_a_table_from_elsewhere_is_drawn_from_the_log(table, tmp_path):
    copy = tmp_path / "log.csv"
    write_trials(copy, read_trials(table))
    (motion,) = shown(copy, task="narrow-channel", sizes_mm=(250.0,))
    assert motion.caption == f"trial 0 of log.csv, {CAPTION}"
    (again,) = shown(table, sizes_mm=(250.0,))
    np.testing.assert_array_equal(motion.features, again.features)
    rows = np.searchsorted(again.time_s, motion.time_s - 1e-9)
    # Along the course, in m; how it deviates sideways is not in the log.
    np.testing.assert_allclose(motion.qpos[:, 0], again.qpos[rows, 0], atol=1e-3)


def test_a_policy_moves_as_in_a_roll_out_with_the_same_seed(root, network):
    family = find_family("narrow-channel")
    for deterministic in (False, True):
        env = family.trial_env(CONFIG.env, 1)
        actor = Actor(Snapshot.load(network), env.single_observation_space, env.single_action_space)
        rolled = roll_out(
            env,
            actor,
            np.array([[220.0]]),
            RolloutConfig(repetitions=1, deterministic=deterministic),
            network=0,
            seed=5,
            monitor=SilentMonitor(),
        )
        options = {"sizes_mm": (220.0,), "deterministic": deterministic}
        options |= {} if deterministic else {"seed": 5}
        for source in (root, network):
            (motion,) = shown(source, **options)
            np.testing.assert_array_equal(motion.features, rolled.features)
    assert motion.caption == "initiation/network-0, its mean actions"


def test_a_policy_with_correlated_noise_moves_as_in_its_roll_out(network, tmp_path):
    trained = Snapshot.load(network)
    noise = {"correlation_s": 0.5, "step_s": 0.1}
    record = {**trained.record, "exploration_noise": noise, "action_divisor": 3.0}
    mine = Snapshot(tensors=trained.tensors, record=record)
    mine.save(tmp_path / "mine.safetensors")
    env = find_family("narrow-channel").trial_env(CONFIG.env, 1)
    actor = Actor(mine, env.single_observation_space, env.single_action_space)
    rolled = roll_out(
        env,
        actor,
        np.array([[220.0]]),
        RolloutConfig(repetitions=1),
        network=0,
        seed=5,
        monitor=SilentMonitor(),
    )
    (motion,) = shown(tmp_path / "mine.safetensors", sizes_mm=(220.0,), seed=5)
    np.testing.assert_array_equal(motion.features, rolled.features)
    (white,) = shown(network, sizes_mm=(220.0,), seed=5)
    assert not np.array_equal(white.features[:10], motion.features[:10])


def test_files_of_a_run_take_its_configuration_which_may_be_changed(root):
    (motion,) = shown(root)
    assert motion.config == CONFIG.env
    assert motion.size_mm == find_obstacle("narrow-channel").hardest == 180.0
    (motion,) = shown(root, changes={"env.episode_s": 0.5})
    assert motion.outcome == "had not reached the target after 0.50 s"


def test_a_network_from_elsewhere_knows_its_obstacle_and_may_be_tried_on_another(network, tmp_path):
    copy = shutil.copy(network, tmp_path / "mine.safetensors")
    (motion,) = shown(copy)
    assert (motion.obstacle.name, motion.size_mm) == ("narrow-channel", 180.0)
    (motion,) = shown(copy, task="low-entrance", changes={"env.episode_s": 0.5})
    assert motion.caption == "mine.safetensors, actions drawn by seed 0"
    assert (motion.obstacle.name, motion.size_mm) == ("low-entrance", 55.0)
    assert motion.config.step_s == CONFIG.env.step_s
    with pytest.raises(InputError, match="takes 6 observations, and step has 7"):
        shown(copy, task="step")


def test_a_manoeuvre_is_played_on_every_size_asked_for(tmp_path):
    path = tmp_path / "straight.json"
    path.write_text(json.dumps({"phases": [STRAIGHT]}), encoding="utf-8")
    narrow, wide = shown(path, task="narrow-channel", sizes_mm=(190.0, 320.0))
    assert narrow.caption == wide.caption == "manoeuvre straight.json"
    assert narrow.success  # at a sprawl of 20° RSTAR is 178 mm wide
    assert wide.success
    assert wide.features[-1, 1] == pytest.approx(20.0, abs=1.0)


@pytest.mark.parametrize("name", ["narrow-channel", "low-entrance", "step"])
def test_an_obstacle_is_shown_with_the_manoeuvre_stored_for_its_hardest_variant(name):
    (motion,) = shown(name)
    obstacle = find_obstacle(name)
    assert motion.size_mm == obstacle.hardest
    assert motion.caption == f"stored manoeuvre for {obstacle.hardest:g} mm"
    # It succeeds with the margins it was chosen for. Its course is chaotic at a step: where
    # processors round sines differently, 50 mm take 6.6 s instead of the 8.3 s of the search.
    assert motion.success
    # Played on this machine it is the same to the last bit.
    stored = stored_manoeuvre(name, motion.size_mm).manoeuvre
    player = Player([stored], motion.config.step_s)
    again = record_motion(
        obstacle, motion.config, motion.size_mm, lambda _, x_m: player.act(x_m), caption=""
    )
    np.testing.assert_array_equal(motion.features, again.features)


def test_a_size_between_variants_takes_the_next_harder_manoeuvre():
    (motion,) = shown("narrow-channel", sizes_mm=(315.5,))
    assert motion.caption == "stored manoeuvre for 310 mm"
    assert motion.success


def test_a_robot_may_just_stand():
    (motion,) = shown("step", standing=True)
    assert (motion.size_mm, motion.duration_s) == (50.0, pytest.approx(2.0))
    assert motion.config == preset("step", "paper").env


@pytest.mark.parametrize(
    ("options", "sentence", "remedy"),
    [
        ({"stage": "curriculum/network-0"}, "no finished stage", "initiation/network-0"),
        (
            {"task": "rstar/step"},
            "run on rstar/narrow-channel, not on rstar/step",
            "Leave the task out",
        ),
        ({"trials": (1,)}, "With a network, --trial would do nothing", "Leave it out"),
        ({"network": 1}, "With a network, --network would do nothing", "Leave it out"),
        ({"standing": True}, "With a network, --stand would do nothing", "Leave it out"),
        ({"sizes_mm": (100.0,)}, "width_mm 100 is not admissible", "from 170 to 330"),
        ({"changes": {"env.robot.gears": "both"}}, "Unknown config", "env.robot.gear"),
        (
            {"changes": {"task": "rstar/step"}},
            "for rstar/step, not for rstar/narrow-channel",
            "task",
        ),
    ],
)
def test_wrong_options_for_a_network_are_refused(root, options, sentence, remedy):
    with pytest.raises((ConfigError, InputError), match=sentence) as caught:
        shown(root, **options)
    assert remedy in caught.value.remedy


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"seed": 0}, "With logged trials, --seed would do nothing"),
        (
            {"changes": {"env.episode_s": 1}},
            "With trials of a run, --set and --config would do nothing",
        ),
        ({"sizes_mm": (185.0,)}, "no trial 0 of network 0 on 185 mm"),
        ({"trials": (2,)}, "no trial 2 of network 0 on 180 mm"),
        ({"network": 3}, "no trial 0 of network 3"),
        ({"task": "rstar/step"}, "run on rstar/narrow-channel, not on rstar/step"),
    ],
)
def test_wrong_options_for_trials_are_refused(table, options, sentence):
    with pytest.raises((ConfigError, InputError), match=sentence):
        shown(table, **options)


@pytest.mark.parametrize(
    ("name", "text", "error", "sentence"),
    [
        ("stepp", None, InputError, "neither an obstacle nor a file or folder"),
        ("missing.safetensors", None, InputError, "neither an obstacle nor"),
        ("notes.txt", "x", InputError, "no kind of file that can be shown"),
        ("broken.safetensors", "x", InputError, "not a network written by Surmount"),
        ("broken.json", "[", InputError, "not valid JSON"),
        ("empty.json", "{}", InputError, "holds no manoeuvre"),
        ("wrong.json", '{"phases": [{"speed": 1}]}', InputError, "not a manoeuvre"),
        ("broken.csv", "a,b\n1,2\n", InputError, "variant"),
        ("", None, OutputError, "There is no run in"),
    ],
)
def test_files_that_cannot_be_shown_are_named(tmp_path, name, text, error, sentence):
    path = tmp_path / name
    if text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(error, match=sentence):
        shown(path, task="step")


def test_an_unknown_obstacle_is_told_the_nearest(network, tmp_path):
    with pytest.raises(InputError, match="Did you mean `step`"):
        shown("stepp")
    copy = shutil.copy(network, tmp_path)
    with pytest.raises(ConfigError, match="Did you mean `step`"):
        shown(copy, task="stepp")


def test_a_run_that_has_trained_nothing_has_nothing_to_show(tmp_path):
    begin(tmp_path, CONFIG)
    with pytest.raises(InputError, match="has trained no network yet"):
        shown(tmp_path)


def test_a_network_that_was_changed_in_its_run_is_refused(root, tmp_path):
    copy = shutil.copytree(root, tmp_path / "run")
    path = next(copy.glob("stages/initiation/**/network.safetensors"))
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    for source in (copy, path):
        with pytest.raises(IntegrityError, match="changed or damaged"):
            shown(source)


def test_a_log_without_the_features_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("variant,network,trial,success,time_s\n30,0,0,true,0\n", encoding="utf-8")
    with pytest.raises(InputError, match="no feature `sprawl_deg`"):
        shown(path, task="step")
    text = "variant.a,variant.b,network,trial,success,time_s\n30,1,0,0,true,0\n"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="several task parameters: a, b"):
        shown(path, task="step")
