"""Each teacher samples the region that its publication promises, when it promises it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from toy_learner import VARIANTS, WHOLE, ToyLearner, toy_context, train

from surmount.core.errors import ConfigError, InputError
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.catalogue import TEACHERS, make_teacher
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.learning_progress import LearningProgressConfig, LearningProgressTeacher
from surmount.teachers.promotion import PromotionTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.self_paced import (
    SelfPacedConfig,
    SelfPacedTeacher,
    divergence,
    self_paced_step,
)

CELLS = TaskCells(("x",), VARIANTS)
BUDGET = {"total_steps": 10**6, "seed": 0}
ADAPTIVE = [
    "promote-demote", "learning-progress", "learnability", "alp-gmm", "plr", "spdl", "mastery",
    "frontier", "frontier-cells", "frontier-parameters",
]  # fmt: skip
"""Success-guided sampling is not among them: its windows of 100 episodes a variant lag behind this
learner, whose edge passes a variant in 40."""


def tell(teacher, task, success, *, reward=None, error=0.0):
    value = 10.0 * success if reward is None else reward
    teacher.update_on_episode(value, 10, np.array([task]), float(success), value_error=error)


def shares(teacher) -> np.ndarray:
    """Probability of each of 20 equal parts of the range."""
    tasks = teacher.distribution().sample(np.random.default_rng(0), 20_000)[:, 0]
    return np.histogram(tasks, bins=20, range=(0, 1))[0] / 20_000


@pytest.mark.parametrize("name", TEACHERS)
def test_sampled_frequencies_match_the_distribution(name):
    teacher = make_teacher(name, toy_context())
    train(teacher, ToyLearner(0), 30)
    distribution = teacher.distribution()
    tasks = teacher.sample(20_000)[:, 0]
    edges = np.linspace(0, 1, 6)
    inside = np.clip(
        (np.minimum(distribution.upper, edges[1:]) - np.maximum(distribution.lower, edges[:-1])),
        0,
        None,
    )
    width = distribution.upper - distribution.lower
    point = (distribution.lower >= edges[:-1]) & (distribution.lower < edges[1:])
    within = np.where(width > 0, inside / np.where(width > 0, width, 1), point)
    expected = distribution.weights @ within
    found = np.histogram(tasks, bins=edges)[0] / tasks.size
    # Five standard errors of a share of one half among 20,000 draws.
    np.testing.assert_allclose(found, expected, atol=5 * 0.5 / np.sqrt(20_000))


@pytest.mark.parametrize("name", TEACHERS)
def test_the_state_is_json_and_goes_on_identically(name):
    first, second = make_teacher(name, toy_context()), make_teacher(name, toy_context())
    train(first, ToyLearner(1), 25)
    first.sample(3)
    second.load_state_dict(json.loads(json.dumps(first.state_dict(), allow_nan=False)))
    assert second.state_dict() == first.state_dict()
    runs = []
    for teacher in (first, second):
        tasks = np.concatenate(train(teacher, ToyLearner(2), 20))
        runs.append(np.concatenate([tasks, teacher.sample(5)[:, 0]]))
    np.testing.assert_array_equal(*runs)
    assert second.status() == first.status()


def test_levels_at_a_budget_saved_without_a_count_of_their_own_draw_on_as_before():
    first, second = make_teacher("paper", toy_context()), make_teacher("paper", toy_context())
    first.sample(3)
    state = first.state_dict()
    assert state.pop("draws") == state["levels"]["draws"] == 1  # older states have the latter alone
    second.load_state_dict(state)
    np.testing.assert_array_equal(second.sample(5), first.sample(5))


@pytest.mark.parametrize("name", TEACHERS)
def test_the_state_of_another_teacher_or_of_other_tasks_is_refused(name):
    teacher = make_teacher(name, toy_context())
    for other in {"uniform", "plr", "paper", "spdl"} - {name}:
        if name != "hardest" or other != "uniform":  # one kind, but other tasks
            with pytest.raises(InputError, match=r"another (teacher|curriculum)"):
                teacher.load_state_dict(make_teacher(other, toy_context()).state_dict())
    context = toy_context()
    groups = tuple(
        replace(
            group,
            variants=2 * group.variants,
            boxes=tuple(
                replace(box, lower=2 * box.lower, upper=2 * box.upper) for box in group.boxes
            ),
        )
        for group in context.curriculum.groups
    )
    moved = replace(
        context,
        curriculum=replace(context.curriculum, groups=groups),
        variants=2 * VARIANTS,
        whole_range=TaskDistribution.uniform(("x",), np.array([0.0]), np.array([2.0])),
    )
    with pytest.raises(InputError, match="other tasks"):
        teacher.load_state_dict(make_teacher(name, moved).state_dict())


@pytest.mark.parametrize("name", TEACHERS)
def test_a_loop_that_tells_of_episodes_alone_gets_as_far_as_one_with_rollouts(name):
    by_episode, by_rollout = (make_teacher(name, toy_context(total_steps=1_000)) for _ in range(2))
    learner = ToyLearner(0)
    while not by_rollout.finished:
        outcome = learner.rollout(by_rollout.distribution(), 5)
        ended = outcome.episodes
        spread = replace(outcome, rewards=np.repeat(ended.reward / ended.length, ended.length))
        by_rollout.update_on_rollout(spread)
        for index in range(ended.step.size):
            assert not by_episode.finished
            by_episode.update_on_episode(
                float(ended.reward[index]),
                int(ended.length[index]),
                ended.variant[index],
                float(ended.success[index]),
                value_error=float(outcome.value_errors[index]),
            )
    assert by_episode.finished
    assert by_episode.state_dict() == by_rollout.state_dict()


@pytest.mark.parametrize("name", TEACHERS)
def test_it_ends_with_the_first_rollout_that_reaches_the_budget(name):
    teacher = make_teacher(name, toy_context(total_steps=1_001))
    assert len(train(teacher, ToyLearner(0), 100)) == 6  # 20 episodes of 10 steps each
    assert teacher.finished
    assert teacher.status().planned_steps == 1_001


@pytest.mark.parametrize("name", TEACHERS)
def test_seeds_matter_and_repeat(name):
    tasks = [make_teacher(name, toy_context(seed=seed)).sample(50).tolist() for seed in (0, 0, 1)]
    assert tasks[0] == tasks[1]
    assert tasks[0] != tasks[2]


@pytest.mark.parametrize("name", ["alp-gmm", "spdl", "promote-demote"])
def test_seeds_matter_to_what_is_pushed(name):
    pushed = []
    for seed in (0, 1):
        teacher = make_teacher(name, toy_context(seed=seed))
        for index in range(300):
            task = 1.0 if name == "promote-demote" else (index % 100) / 100
            tell(teacher, task, name == "promote-demote" or index % 3 == 0, error=0.1)
            if name == "promote-demote":  # each success on the last row restarts somewhere
                teacher._rows[-1] += 1
        pushed.append(teacher.distribution().to_record())
    assert pushed[0] != pushed[1]


def skill_after(name: str) -> float:
    """Mean skill of three learners after 2,400 episodes; the edge passes the range in 900."""
    learners = [ToyLearner(seed, growth=0.001) for seed in range(3)]
    for seed, learner in enumerate(learners):
        train(make_teacher(name, toy_context(seed=seed)), learner, 120)
    return float(np.mean([learner.skill for learner in learners]))


@pytest.fixture(scope="module")
def uniform_skill() -> float:
    return skill_after("uniform")


@pytest.mark.parametrize("name", ADAPTIVE)
def test_an_adaptive_teacher_brings_the_learner_farther_than_uniform_tasks(name, uniform_skill):
    assert uniform_skill == pytest.approx(0.1 + 2_400 * 0.001 * 0.2, abs=0.05)
    # ALP-GMM gains least: it begins with 250 uniform episodes and keeps a fifth of them.
    assert skill_after(name) > 1.05 * uniform_skill


def test_learning_progress_follows_change_up_or_down_and_leaves_what_is_constant():
    teacher = LearningProgressTeacher(CELLS, **BUDGET, config=LearningProgressConfig())
    for _ in range(200):
        tell(teacher, 0.0, True)
        tell(teacher, 1.0, False)
        tell(teacher, 0.2, True)
        tell(teacher, 0.5, False)
    for _ in range(10):
        tell(teacher, 0.5, True)  # newly learnt
        tell(teacher, 0.2, False)  # newly forgotten
    progress = teacher.progress()
    assert set(np.argsort(progress)[-2:]) == {4, 10}
    assert progress[0] < 1e-3
    assert progress[20] == 0.0
    weights = teacher.distribution().weights
    assert weights[20] == pytest.approx(0.2 / 21)  # the uniform share alone
    assert weights[[4, 10]].sum() > 0.7


def test_learning_progress_does_not_take_what_was_mastered_before_for_progress():
    teacher = LearningProgressTeacher(CELLS, **BUDGET, config=LearningProgressConfig())
    for index in range(10):
        for cell, task in enumerate(VARIANTS[:, 0]):
            tell(teacher, task, index > 5 if cell == 10 else cell < 10)
    assert teacher.progress()[:10].max() == 0.0
    assert teacher.distribution().weights[10] == pytest.approx(0.8 + 0.2 / 21)


def test_learnability_is_largest_where_half_succeeds():
    config = LearnabilityConfig(uniform_share=0.1, shrinkage_episodes=0.0)
    teacher = LearnabilityTeacher(CELLS, **BUDGET, config=config)
    for episodes, mastered in ((10, 11 / 12), (40, 1.0)):  # one of each is added up to twenty
        for index in range(episodes):
            for cell, task in enumerate(VARIANTS[:, 0]):
                tell(teacher, task, index % 2 == 0 if cell == 7 else cell < 7)
        p = np.where(np.arange(21) < 7, mastered, 1 - mastered)
        p[7] = 0.5
        expected = 0.1 / 21 + 0.9 * p * (1 - p) / (p * (1 - p)).sum()
        np.testing.assert_allclose(teacher.distribution().weights, expected, rtol=1e-12)
    assert teacher.distribution().weights[7] == pytest.approx(0.9 + 0.1 / 21)


def test_promotion_moves_up_on_success_down_on_failure_and_restarts_after_the_last_row():
    teacher = PromotionTeacher(CELLS, (1,), learners=3, **BUDGET)
    assert teacher.rows().tolist() == [3] + [0] * 20
    tell(teacher, 0.0, True)
    assert teacher.rows()[:3].tolist() == [2, 1, 0]
    tell(teacher, 0.05, False)
    assert teacher.rows()[:3].tolist() == [3, 0, 0]
    tell(teacher, 0.5, True)  # nobody stands there any more
    assert teacher.rows()[:3].tolist() == [3, 0, 0]
    teacher.update_on_episode(0.0, 10, np.array([0.0]), 0.5)  # half of the way
    assert teacher.rows()[:3].tolist() == [3, 0, 0]
    for row in range(20):
        tell(teacher, VARIANTS[row, 0], True)
    assert teacher.rows()[20] == 1
    teacher.update_on_episode(0.0, 10, np.array([1.0]), 0.5)
    assert teacher.rows()[20] == 1
    tell(teacher, 1.0, True)
    assert teacher.rows().sum() == 3
    reverse = PromotionTeacher(CELLS, (-1,), learners=1, **BUDGET)
    assert (reverse.distribution().sample(np.random.default_rng(0), 50) >= 0.975).all()


def test_replay_first_sees_every_variant_then_ranks_value_errors_and_staleness():
    config = ReplayConfig(temperature=0.5, staleness=0.25)
    teacher = ReplayTeacher(CELLS, **BUDGET, config=config)
    np.testing.assert_allclose(teacher.distribution().weights, np.full(21, 1 / 21))
    for cell in range(7):
        tell(teacher, VARIANTS[cell, 0], False, error=[3.0, 9.0, 1.0, 2.0, 0.5, 0.1, 0.2][cell])
    weights = teacher.distribution().weights
    np.testing.assert_allclose(weights[7:], np.full(14, 1 / 21))  # unseen: 14 of 21
    rank = np.array([2, 1, 4, 3, 5, 7, 6])
    by_score = rank**-2.0 / (rank**-2.0).sum()
    by_age = np.arange(6, -1, -1) / 21
    np.testing.assert_allclose(weights[:7], (0.75 * by_score + 0.25 * by_age) / 3, rtol=1e-12)


def test_replay_says_what_it_lacks_without_value_errors():
    teacher = ReplayTeacher(CELLS, **BUDGET, config=ReplayConfig())
    with pytest.raises(InputError, match="value error"):
        teacher.update_on_episode(1.0, 10, np.array([0.5]), 1.0)


def test_alp_gmm_is_uniform_at_first_then_goes_where_the_return_changes():
    teacher = AlpGmmTeacher(WHOLE, **BUDGET, config=AlpGmmConfig())
    rng = np.random.default_rng(0)
    for index in range(500):
        task = float(rng.random())
        if index == 249:
            assert teacher.distribution() is WHOLE
        # Returns jump between 0.6 and 0.8 and are constant elsewhere.
        reward = 10.0 * rng.random() if 0.6 < task < 0.8 else 5.0
        tell(teacher, task, False, reward=reward)
    share = shares(teacher)
    assert share[12:16].sum() > 0.6  # uniform tasks: 0.2
    # 0.2 of all draws are uniform; 5 standard errors of such a share among 20,000 draws.
    assert share[:8].sum() >= 0.4 * 0.2 - 5 * np.sqrt(0.08 * 0.92 / 20_000)


def test_alp_gmm_without_any_change_stays_uniform():
    teacher = AlpGmmTeacher(WHOLE, **BUDGET, config=AlpGmmConfig(fit_episodes=20))
    for index in range(40):
        tell(teacher, index / 40, False)
    assert teacher.distribution() is WHOLE


def test_progress_of_alp_gmm_is_measured_from_the_nearest_earlier_task():
    teacher = AlpGmmTeacher(WHOLE, **BUDGET, config=AlpGmmConfig())
    for task, reward in ((0.1, 4.0), (0.9, -2.0), (0.0, 0.0), (0.4, 7.0), (0.5, 7.0), (0.6, 7.0)):
        tell(teacher, task, False, reward=reward)
    for task, reward in ((0.2, 1.0), (0.8, -2.5), (0.21, 3.0)):
        tell(teacher, task, False, reward=reward)
    assert teacher.state_dict()["progress"] == pytest.approx([0.0] * 6 + [3.0, 0.5, 2.0])


def self_paced(seed=0) -> SelfPacedTeacher:
    easy = TaskDistribution.uniform(("x",), np.array([0.0]), np.array([0.2]))
    return SelfPacedTeacher(
        WHOLE, easy, total_steps=10**6, seed=seed, config=SelfPacedConfig(update_episodes=200)
    )


def test_self_paced_learning_begins_with_the_easy_group_and_waits_for_success():
    teacher = self_paced()
    assert teacher.mean == pytest.approx([0.1])
    assert teacher.deviation == pytest.approx([0.2 / np.sqrt(12)])
    tasks = teacher.sample(200)
    for task in tasks[:, 0]:
        tell(teacher, task, False)
    assert teacher.mean == pytest.approx([0.1])  # nothing succeeded: it stays


def test_self_paced_learning_reaches_the_whole_range_once_everything_succeeds():
    teacher = self_paced()
    means = [float(teacher.mean[0])]
    for _ in range(40):
        for task in teacher.sample(200)[:, 0]:
            tell(teacher, task, True)
        means.append(float(teacher.mean[0]))
    assert means[1] < 0.2  # one step is short
    assert np.diff(means).min() > -0.02
    assert means[-1] == pytest.approx(0.5, abs=0.02)
    assert teacher.deviation[0] == pytest.approx(1 / np.sqrt(12), rel=0.05)


def test_a_self_paced_step_keeps_its_bounds():
    config = SelfPacedConfig()
    rng = np.random.default_rng(0)
    now, target = np.array([0.2, np.log(0.08)]), np.array([0.5, np.log(0.29)])
    tasks = now[0] + 0.08 * rng.standard_normal((400, 1))
    success = (tasks[:, 0] < 0.25).astype(float)
    step = self_paced_step(now, target, tasks, success, config)
    assert divergence(step, now) <= 1.05 * config.step_bound
    assert divergence(step, target) < divergence(now, target)
    ratio = np.exp(
        -(((tasks[:, 0] - step[0]) / np.exp(step[1])) ** 2) / 2
        + ((tasks[:, 0] - now[0]) / 0.08) ** 2 / 2
    ) * 0.08 / np.exp(step[1])  # fmt: skip
    assert (ratio * success).mean() >= config.success_bound - 1e-3
    down = self_paced_step(now, target, tasks, (tasks[:, 0] < 0.18).astype(float), config)
    assert down[0] < now[0]  # too hard: back to easier tasks


def test_the_divergence_is_that_of_gaussians():
    first, second = np.array([0.3, np.log(0.2)]), np.array([0.6, np.log(0.4)])
    x = np.linspace(-3, 4, 200_001)
    log = [
        -(((x - mean) / np.exp(log_std)) ** 2) / 2 - log_std - np.log(2 * np.pi) / 2
        for mean, log_std in (first, second)
    ]
    integral = np.trapezoid(np.exp(log[0]) * (log[0] - log[1]), x)
    assert divergence(first, second) == pytest.approx(integral, rel=1e-6)


def test_cells_tile_the_range_with_several_parameters():
    grid = np.array([[a, b] for a in (0.0, 1.0, 4.0) for b in (10.0, 20.0)])
    cells = TaskCells(("a", "b"), grid)
    rng = np.random.default_rng(0)
    area = np.prod(cells.upper - cells.lower, axis=1)
    assert area.sum() == pytest.approx(4.0 * 10.0)
    for task in rng.uniform([0, 10], [4, 20], (200, 2)):
        cell = cells.locate(task)
        assert (cells.lower[cell] <= task).all()
        assert (task <= cells.upper[cell]).all()
    assert cells.locate(np.array([9.0, 30.0])) == 5
    assert cells.by_difficulty((1, -1))[[0, -1]].tolist() == [1, 4]


def test_an_unknown_teacher_names_the_nearest():
    with pytest.raises(ConfigError, match="Unknown teacher `alpgmm`") as caught:
        make_teacher("alpgmm", toy_context())
    assert "`alp-gmm`" in caught.value.remedy


@pytest.mark.parametrize(
    ("config", "field"),
    [
        (lambda: ReplayConfig(temperature=0), "temperature"),
        (lambda: ReplayConfig(staleness=2), "staleness"),
        (lambda: AlpGmmConfig(fit_episodes=1), "fit_episodes"),
        (lambda: AlpGmmConfig(uniform_share=0.0), "uniform_share"),
        (lambda: LearnabilityConfig(window_episodes=0), "window_episodes"),
        (lambda: LearnabilityConfig(shrinkage_episodes=-1.0), "shrinkage_episodes"),
        (lambda: LearningProgressConfig(fast_rate=1.5), "fast_rate"),
        (lambda: SelfPacedConfig(step_bound=-1.0), "step_bound"),
    ],
)
def test_settings_out_of_range_are_refused(config, field):
    with pytest.raises(ConfigError, match=field):
        config()


SOUND = {"episode_return": 1.0, "length": 10, "task": [0.5], "progress": 1.0}
UNSOUND = [
    ({"episode_return": np.nan}, r"return is nan \(task 0\.5\)"),
    ({"episode_return": np.inf}, r"return is inf \(task 0\.5\)"),
    ({"progress": np.nan}, r"progress is nan \(task 0\.5\)"),
    ({"progress": 40.0}, r"progress is 40\.0 \(task 0\.5\)"),
    ({"progress": -0.1}, r"progress is -0\.1 \(task 0\.5\)"),
    ({"length": 0}, r"length is 0 \(task 0\.5\)"),
    ({"task": [np.nan]}, r"task is \[nan\]"),
    ({"task": [0.5, 0.5]}, r"task is \[0\.5, 0\.5\]"),
    ({"covered": np.nan}, r"covered share is nan \(task 0\.5\)"),
]


@pytest.mark.parametrize("name", TEACHERS)
def test_an_episode_that_nothing_can_be_learnt_from_is_refused_and_changes_nothing(name):
    teacher = make_teacher(name, toy_context())
    before = teacher.state_dict()
    for unsound, sentence in UNSOUND:
        with pytest.raises(InputError, match=f"An episode's {sentence}"):
            teacher.update_on_episode(**SOUND | unsound, value_error=0.0)
    assert teacher.state_dict() == before
    teacher.update_on_episode(**SOUND, value_error=0.0)
    assert teacher.state_dict() != before


@pytest.mark.parametrize("name", TEACHERS)
def test_a_rollout_with_such_an_episode_is_refused_as_a_whole(name):
    teacher = make_teacher(name, toy_context())
    before = teacher.state_dict()
    outcome = ToyLearner(0).rollout(teacher.distribution(), 5)
    task = outcome.episodes.variant[3, 0]
    returns = np.where(np.arange(5) == 3, np.nan, outcome.episodes.reward)
    lost = replace(outcome, episodes=replace(outcome.episodes, reward=returns))
    with pytest.raises(InputError, match=f"return is nan \\(task {task}\\)"):
        teacher.update_on_rollout(lost)
    with pytest.raises(InputError, match="A reward of the roll-out is not finite"):
        teacher.update_on_rollout(replace(outcome, rewards=outcome.rewards + np.nan))
    assert teacher.state_dict() == before


def test_a_task_with_one_value_for_two_parameters_is_refused():
    cells = TaskCells(("x", "y"), np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]))
    teacher = LearnabilityTeacher(cells, config=LearnabilityConfig(), **BUDGET)
    with pytest.raises(InputError, match=r"task is \[1\.0\].*\(x, y\)"):
        teacher.update_on_episode(1.0, 10, np.array([1.0]), 1.0)
