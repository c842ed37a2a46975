"""In a plain script the callback pushes, tells, tests, logs, and can be saved."""

from __future__ import annotations

import io
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from own_point import PointEnv, make_env, make_point
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import HumanOutputFormat, KVWriter, Logger
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecNormalize

from surmount.core.errors import ConfigError, InputError, MissingExtraError
from surmount.learn.callback import TeacherCallback
from surmount.learn.curriculum_log import MOST_REGIONS, short_names, variant_regions
from surmount.learn.loggers import WRITERS, training_logger
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions
from surmount.tasks.space import TaskSpace
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.uniform import UniformTeacher

NAMES = ("distance_m", "wind")
NEAR = TaskDistribution.uniform(NAMES, np.array([0.5, 0.0]), np.array([0.7, 0.1]))
FAR = TaskDistribution.uniform(NAMES, np.array([1.5, 0.0]), np.array([2.0, 0.1]))
REGIONS = Regions(
    names=("near", "far"), lower=(NEAR.lower, FAR.lower), upper=(NEAR.upper, FAR.upper)
)
CONFIG = AdvancementConfig(
    iteration_steps=128, extension_steps=128, window_steps=32, max_extensions=0
)


class Told(LevelTeacher):
    """Keeps what it is told."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.outcomes = []

    def update_on_rollout(self, outcome):
        self.outcomes.append(outcome)
        return super().update_on_rollout(outcome)


class Lines(KVWriter):
    def __init__(self):
        self.lines = []

    def write(self, key_values, key_excluded, step=0):
        self.lines.append(dict(key_values))

    def close(self):
        pass


def learner_of(*, normalised=False, model=PPO, **options):
    env = DummyVecEnv([make_env, make_env])
    if normalised:
        env = VecNormalize(env)
    return model("MlpPolicy", env, seed=0, device="cpu", **options)


def learn(callback, *, steps=2_000, **options):
    learner = learner_of(**options)
    lines = Lines()
    learner.set_logger(Logger(None, [lines]))
    learner.learn(steps, callback=callback)
    return lines.lines


def test_levels_are_pushed_from_the_first_episode_on_and_training_ends_with_the_last():
    teacher = Told([NEAR, FAR], CONFIG)
    callback = TeacherCallback(teacher, regions=REGIONS)
    lines = learn(callback, n_steps=64, batch_size=64)
    tasks = [outcome.episodes.variant for outcome in teacher.outcomes]
    assert len(tasks) == 2  # two levels of one roll-out of 128 steps
    for outcome, before in zip(teacher.outcomes, (0, 128), strict=True):
        assert outcome.steps_before == before
        assert before < outcome.episodes.step.min() <= outcome.episodes.step.max() <= before + 128
    assert (tasks[0][:, 0] <= 0.7).all()  # the first episodes included
    begun_before = 2  # one episode of each environment began before the new level was pushed
    assert (tasks[1][begun_before:, 0] >= 1.5).all()
    assert all(test.decision.startswith("advance") for test in callback.tests)
    assert [test.level for test in callback.tests] == [0, 1]
    assert lines[0]["curriculum/tested_level"] == 1
    assert lines[0]["curriculum/level"] == 2  # what environments draw from now
    assert lines[0]["curriculum/weight/far"] == 1.0
    assert lines[0]["curriculum/weight/near"] == 0.0
    assert lines[0]["curriculum/success/near"] == pytest.approx(
        teacher.outcomes[0].episodes.success.mean()
    )
    test = callback.tests[0]
    assert lines[0]["curriculum/rL"] - lines[0]["curriculum/rF"] == pytest.approx(test.first_gain)
    assert lines[0]["curriculum/advanced"] == 1


def test_rewards_are_those_before_normalisation():
    teachers = [Told([NEAR], CONFIG), Told([NEAR], CONFIG)]
    for teacher, normalised in zip(teachers, (False, True), strict=True):
        learn(TeacherCallback(teacher), normalised=normalised, n_steps=64, batch_size=64)
    for teacher in teachers:
        rewards = teacher.outcomes[0].rewards
        goals = rewards > 0.2
        assert np.allclose(rewards[goals], 5.0)  # the reward of the goal, unscaled
        assert rewards.size == 128
        episodes = teacher.outcomes[0].episodes
        ended = int(episodes.length.sum())
        assert 0 < ended <= 128


def test_value_errors_reach_prioritised_level_replay():
    cells = TaskCells(NAMES, make_env().space.variants)
    teacher = ReplayTeacher(cells, total_steps=600, seed=0, config=ReplayConfig())
    learn(TeacherCallback(teacher), n_steps=64, batch_size=64)
    state = teacher.state_dict()
    assert state["episodes"] > 20
    assert max(state["score"]) > 0
    assert teacher.finished


def test_a_teacher_that_needs_a_critic_is_refused_before_the_first_step():
    cells = TaskCells(NAMES, make_env().space.variants)
    teacher = ReplayTeacher(cells, total_steps=600, seed=0, config=ReplayConfig())
    with pytest.raises(ConfigError, match="SAC estimates none"):
        learn(TeacherCallback(teacher), model=SAC, steps=400, learning_starts=500, buffer_size=500)
    assert teacher.state_dict()["episodes"] == 0


def test_learners_without_rollouts_update_the_teacher_now_and_then():
    teacher = Told([NEAR], AdvancementConfig(**{**vars(CONFIG), "iteration_steps": 200}))
    callback = TeacherCallback(teacher, update_steps=60)
    learn(callback, model=SAC, steps=400, learning_starts=500, buffer_size=500)
    assert 60 <= teacher.outcomes[0].rewards.size < 70
    assert teacher.outcomes[0].value_errors is None
    assert callback.tests


def test_the_level_in_force_is_logged_after_every_rollout():
    longer = AdvancementConfig(**{**vars(CONFIG), "iteration_steps": 256})
    lines = learn(TeacherCallback(LevelTeacher([NEAR, FAR], longer)), n_steps=64, batch_size=64)
    tests = [line.get("curriculum/tested_level") for line in lines[:4]]
    assert tests == [None, 1, None, 2]  # of two roll-outs each
    levels = [line.get("curriculum/level") for line in lines[:4]]
    assert levels == [1, 2, 2, None]  # after the last level none is in force


def test_steps_in_which_no_level_can_change_are_warned_of_once_over_pieces():
    callback = TeacherCallback(LevelTeacher([NEAR, FAR], AdvancementConfig()))
    learner = learner_of(**PIECES[PPO])
    said = (
        r"given 20 steps; level 1 is tested first after 500,000 and passes at the earliest after "
        r"600,000: it will not change.*iteration_steps"
    )
    with pytest.warns(UserWarning, match=said):
        learner.learn(20, callback=callback)
    learner.learn(20, callback=callback, reset_num_timesteps=False)  # warnings are errors here
    learner.learn(20, callback=callback)


def test_steps_in_which_a_level_can_change_are_not_warned_of_and_those_to_its_test_are_logged():
    longer = AdvancementConfig(iteration_steps=20, extension_steps=15, window_steps=5)
    teacher = Told([NEAR, FAR], longer)
    lines = learn(TeacherCallback(teacher), steps=31, **PIECES[PPO])  # four roll-outs of 10
    told = [line["curriculum/steps_to_test"] for line in lines]
    assert told == [10, 15, 5, teacher.status().steps_to_test]


class Diverging(gymnasium.Wrapper):
    """Every episode's second reward is NaN."""

    def reset(self, **options):
        self.steps = 0
        return self.env.reset(**options)

    def step(self, action):
        observation, reward, *rest = self.env.step(action)
        self.steps += 1
        return observation, (np.nan if self.steps == 2 else reward), *rest


def test_episodes_that_diverge_are_warned_of_once_and_logged():
    out_of_reach = TaskDistribution.uniform(NAMES, np.array([2.0, 2.0]), np.array([2.0, 2.0]))
    envs = [lambda: make_point(Diverging(PointEnv())), make_env]
    learner = PPO("MlpPolicy", DummyVecEnv(envs), seed=0, device="cpu", **PIECES[PPO])
    lines = Lines()
    learner.set_logger(Logger(None, [lines]))
    with pytest.warns(UserWarning, match="2 of 2 episodes of a roll-out diverged") as caught:
        learner.learn(60, callback=TeacherCallback(UniformTeacher(out_of_reach, 500)))
    assert len(caught) == 1
    shares = [line["curriculum/diverged"] for line in lines.lines]
    # In five steps two or three episodes of two steps diverge; one of twelve ends at its limit.
    assert shares == pytest.approx([1, 1, 2 / 3, 1, 2 / 3, 1])


def test_a_teacher_without_levels_logs_none():
    lines = learn(TeacherCallback(UniformTeacher(NEAR, 128)), n_steps=64, batch_size=64)
    assert "curriculum/level" not in lines[0]


def test_without_regions_each_variant_is_told_apart():
    teacher = AlpGmmTeacher(
        make_env().space.whole_range, total_steps=128, seed=0, config=AlpGmmConfig()
    )
    callback = TeacherCallback(teacher)
    lines = learn(callback, n_steps=32, batch_size=64)
    weights = {key: line for key, line in lines[0].items() if key.startswith("curriculum/weight/")}
    assert weights.keys() == {
        f"curriculum/weight/{distance:g}, {wind:g}"
        for distance in (0.5, 1.0, 1.5, 2.0)
        for wind in (0.0, 1.0, 2.0)
    }
    assert sum(weights.values()) == pytest.approx(1.0)  # the cells tile the range
    assert any(key.startswith("curriculum/success/") for key in lines[0])


def test_a_uniform_teacher_weighs_variants_by_their_cells():
    space = TaskSpace.grid(slope_deg=[0.0, 10.0, 40.0])
    regions = variant_regions(space)
    assert regions.names == ("0", "10", "40")
    shares = regions.shares(space.whole_range)
    assert shares.tolist() == pytest.approx([5 / 40, 20 / 40, 15 / 40])


@pytest.mark.parametrize(
    "values",
    [
        {"slope_deg": range(MOST_REGIONS + 1)},
        {"slope_deg": [1.0, 1.0 + 1e-9]},
        {name: [0.123456, 0.234567] for name in "abcd"},
    ],
)
def test_variants_whose_names_would_not_tell_them_apart_are_not_logged(values):
    assert variant_regions(TaskSpace.grid(**values)) is None


def test_the_names_of_variants_fit_the_table_of_stable_baselines():
    regions = variant_regions(TaskSpace.grid(**{name: [0.001, 0.002] for name in "abc"}))
    table = io.StringIO()
    logger = Logger(None, [HumanOutputFormat(table)])
    for name in regions.names:
        logger.record(f"curriculum/success/{name}", 1.0)
    logger.dump()
    assert all(f"success/{name} |" in table.getvalue() for name in regions.names)


@pytest.mark.parametrize(
    "teacher", [LevelTeacher([], CONFIG), UniformTeacher(NEAR, 0)], ids=["levels", "steps"]
)
def test_a_teacher_with_nothing_to_teach_is_refused(teacher):
    with pytest.raises(ConfigError, match="nothing to learn") as caught:
        learn(TeacherCallback(teacher), n_steps=64, batch_size=64)
    assert "surmount.UniformTeacher" in caught.value.remedy


def test_a_teacher_that_has_finished_is_refused():
    callback = TeacherCallback(UniformTeacher(NEAR, 128))
    learn(callback, n_steps=64, batch_size=64)
    with pytest.raises(ConfigError, match="finished already, after 128 steps"):
        learn(callback, n_steps=64, batch_size=64)


def test_the_first_transition_stored_is_of_a_pushed_task_under_normalisation():
    learner = learner_of(model=SAC, normalised=True, learning_starts=500, buffer_size=500)
    learner.learn(20, callback=TeacherCallback(UniformTeacher(FAR, 500)))
    distances = learner.replay_buffer.observations[0].sum(axis=1)  # position + what is left
    assert ((distances >= 1.5) & (distances <= 2.0)).all()


def test_episodes_that_are_begun_again_are_marked_as_begun():
    learner = learner_of(n_steps=5, batch_size=10)
    learner.learn(10)
    assert not learner._last_episode_starts.any()  # in the middle of episodes of 12 decisions
    learner.learn(
        10, callback=TeacherCallback(UniformTeacher(NEAR, 500)), reset_num_timesteps=False
    )
    assert learner.rollout_buffer.episode_starts[0].tolist() == [1.0, 1.0]


PIECES = {
    PPO: {"n_steps": 5, "batch_size": 10, "n_epochs": 1},
    SAC: {"learning_starts": 500, "buffer_size": 500},
}


@pytest.mark.parametrize("model", PIECES)
@pytest.mark.parametrize("normalised", [False, True])
def test_learning_in_pieces_tells_the_teacher_what_learning_at_once_does(model, normalised):
    states = []
    for pieces in (1, 20):
        cells = TaskCells(NAMES, make_env().space.variants)
        teacher = LearnabilityTeacher(cells, total_steps=500, seed=0, config=LearnabilityConfig())
        callback = TeacherCallback(teacher, update_steps=10)
        learner = learner_of(model=model, normalised=normalised, **PIECES[model])
        for _ in range(pieces):  # of 5 decisions, less than half of an episode
            learner.learn(200 // pieces, callback=callback, reset_num_timesteps=False)
        states.append(teacher.state_dict())
    assert states[0] == states[1]
    assert states[0]["steps"] == 200
    assert sum(map(len, states[0]["newest"])) >= 16  # of at most 12 decisions


def test_what_is_left_at_the_end_of_learning_is_told():
    teacher = Told([NEAR], CONFIG)
    learn(TeacherCallback(teacher), model=SAC, steps=60, **PIECES[SAC])
    assert [outcome.rewards.size for outcome in teacher.outcomes] == [60]


class Broken(BaseCallback):
    """Breaks learning off in the middle of a roll-out."""

    def _on_step(self):
        return self.num_timesteps != 26


def test_a_rollout_that_is_broken_off_is_not_told_and_its_episodes_are_begun_again():
    teacher = Told([NEAR], CONFIG)
    callback = TeacherCallback(teacher)
    learner = learner_of(**PIECES[PPO])
    learner.learn(40, callback=[callback, Broken()])
    assert sum(outcome.rewards.size for outcome in teacher.outcomes) == 20
    learner.learn(10, callback=callback, reset_num_timesteps=False)
    assert teacher.outcomes[-1].steps_before == 26
    assert learner.rollout_buffer.episode_starts[0].tolist() == [1.0, 1.0]


def test_learning_that_is_begun_again_begins_all_episodes():
    teacher = Told([NEAR], CONFIG)
    callback = TeacherCallback(teacher)
    learner = learner_of(**PIECES[PPO])
    for _ in range(2):
        learner.learn(10, callback=callback)
        assert teacher.outcomes[-1].steps_before == 0


def test_saved_progress_is_gone_on_with(tmp_path):
    first = TeacherCallback(LevelTeacher([NEAR, FAR], CONFIG))
    learn(first, n_steps=64, batch_size=64, steps=128)
    first.save(tmp_path / "teacher.json")
    second = TeacherCallback(LevelTeacher([NEAR, FAR], CONFIG))
    second.load(tmp_path / "teacher.json")
    assert second.teacher.status() == first.teacher.status()
    assert second.teacher.status().label == "level 2 of 2"


def test_environments_without_the_wrapper_are_refused_with_a_remedy():
    model = PPO("MlpPolicy", DummyVecEnv([PointEnv]), n_steps=64, device="cpu")
    with pytest.raises(InputError, match="no task distribution") as caught:
        model.learn(64, callback=TeacherCallback(UniformTeacher(NEAR, 64)))
    assert "TaskEnv" in caught.value.remedy


@pytest.mark.parametrize("vector", [DummyVecEnv, SubprocVecEnv])
def test_a_teacher_over_other_parameters_is_refused_before_the_first_step(vector):
    other = TaskDistribution.uniform(("height_mm",), np.array([1.0]), np.array([2.0]))
    model = PPO("MlpPolicy", vector([make_env]), n_steps=64, device="cpu")
    with pytest.raises(InputError, match="is over height_mm, the environment over distance_m, win"):
        model.learn(64, callback=TeacherCallback(UniformTeacher(other, 64)))
    assert model.num_timesteps == 0
    model.get_env().close()


def test_a_teacher_over_other_axes_is_refused_before_the_first_step():
    space = TaskSpace.grid(distance_m=[0.5, 1.0], wind=[0.0, 1.0])
    whole = space.declared({"wind": "integer"}).whole_range
    with pytest.raises(InputError, match="axes that are continuous and integer"):
        learn(TeacherCallback(UniformTeacher(whole, 64)), **PIECES[PPO])


def test_long_names_of_groups_are_told_apart_in_the_table_of_stable_baselines():
    names = [f"steps lower than half of the leg, {end}" for end in ("dry", "wet")]
    names += [f"steps lower than {third} of the leg, dry" for third in ("a quarter", "a fifth")]
    short = short_names(["near", *names])
    assert short[:3] == ["near", "steps lower …the leg, dry", "steps lower …the leg, wet"]
    assert short[3:] == ["steps lower…2…he leg, dry", "steps lower…3…he leg, dry"]
    regions = replace(REGIONS, names=tuple(names[:2]))
    table = io.StringIO()
    learner = learner_of(**PIECES[PPO])
    learner.set_logger(Logger(None, [HumanOutputFormat(table)]))
    learner.learn(60, callback=TeacherCallback(UniformTeacher(NEAR, 500), regions=regions))
    assert all(f"weight/{name} " in table.getvalue() for name in short[1:3])


@pytest.mark.parametrize("name", ["wandb", "mlflow"])
def test_a_service_that_is_asked_for_and_missing_is_named(name, tmp_path, monkeypatch):
    monkeypatch.setenv("SURMOUNT_LOG", name)
    monkeypatch.setitem(__import__("sys").modules, name, None)
    with pytest.raises(MissingExtraError, match=name):
        training_logger(tmp_path / "curriculum" / "network-0")


def test_an_unknown_service_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("SURMOUNT_LOG", "carrier-pigeon")
    with pytest.raises(ConfigError, match="carrier-pigeon"):
        training_logger(tmp_path / "a" / "b")


def test_weights_and_biases_itself_takes_the_scalars(tmp_path, monkeypatch):
    pytest.importorskip("wandb")
    monkeypatch.setenv("WANDB_MODE", "offline")
    monkeypatch.setenv("WANDB_DIR", str(tmp_path))
    monkeypatch.setenv("SURMOUNT_LOG", "wandb")
    logger = training_logger(tmp_path / "curriculum" / "network-0")
    for step in (100, 200):
        logger.record("curriculum/level", step // 100)
        logger.dump(step)
    run = logger.output_formats[-1]._run
    assert (run.name, run.project) == ("curriculum/network-0", "surmount")
    logger.close()
    (written,) = (tmp_path / "wandb").glob("offline-run-*/*.wandb")
    assert b"curriculum/level" in written.read_bytes()


def test_mlflow_itself_takes_the_scalars(tmp_path, monkeypatch):
    pytest.importorskip("mlflow")
    monkeypatch.setenv("MLFLOW_ALLOW_FILE_STORE", "true")
    monkeypatch.setenv("MLFLOW_TRACKING_URI", (tmp_path / "runs").as_uri())
    monkeypatch.setenv("SURMOUNT_LOG", "mlflow")
    logger = training_logger(tmp_path / "curriculum" / "network-0")
    for step in (100, 200):
        logger.record("curriculum/level", step // 100)
        logger.dump(step)
    logger.close()
    (written,) = (tmp_path / "runs").rglob("metrics/curriculum/level")
    assert [line.split()[1:] for line in written.read_text().splitlines()] == [
        ["1.0", "100"],
        ["2.0", "200"],
    ]


def test_a_service_that_begins_no_run_is_named_with_its_reason(tmp_path, monkeypatch):
    class Refusing:
        def init(self, **_):
            raise ConnectionError("no key")

    monkeypatch.setitem(__import__("sys").modules, "wandb", Refusing())
    monkeypatch.setenv("SURMOUNT_LOG", "wandb")
    with pytest.raises(InputError, match=r"`wandb` begins no run \(ConnectionError: no key\)"):
        training_logger(tmp_path / "a" / "b")


def test_weights_and_biases_and_mlflow_get_the_scalars_of_the_same_logger(tmp_path, monkeypatch):
    wandb, mlflow = Service(), Service()
    monkeypatch.setitem(__import__("sys").modules, "wandb", wandb)
    monkeypatch.setitem(__import__("sys").modules, "mlflow", mlflow)
    monkeypatch.setenv("SURMOUNT_LOG", ",".join(WRITERS))
    logger = training_logger(tmp_path / "curriculum" / "network-0")
    logger.record("curriculum/level", 2)
    logger.record("note", "words are no scalars")
    logger.dump(700)
    logger.close()
    assert ("log", ({"curriculum/level": 2.0},), {"step": 700}) in wandb.calls
    assert any(call[0] == "init" and call[2]["name"] == "curriculum/network-0"
               for call in wandb.calls)  # fmt: skip
    logged = [call for call in mlflow.calls if call[0] == "log_metric"]
    assert [(call[1][1:], call[2]) for call in logged] == [
        (("curriculum/level", 2.0), {"step": 700})
    ]
    assert mlflow.calls[-1][0] == "set_terminated"
    assert list((tmp_path / "curriculum" / "network-0").glob("events.*"))


class Service:
    """Notes every call of a service's client, which is not installed here."""

    def __init__(self, calls=None):
        self.calls = [] if calls is None else calls

    def __getattr__(self, name):
        if name in ("tracking", "info"):
            return self
        if name.endswith("_id"):
            return "7"

        def call(*arguments, **options):
            self.calls.append((name, arguments, options))
            return Service(self.calls)

        return call
