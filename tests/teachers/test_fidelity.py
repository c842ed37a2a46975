"""The field's teachers against the formulas of their publications, written anew, step by step.

References are loops over plain lists that follow the publications and what their authors' code
does; fixed sequences of episodes go to both. Where a teacher departs on purpose (its docstring says
so), the reference departs alike, and says so here.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import multivariate_normal, norm
from toy_learner import VARIANTS, WHOLE

from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.learning_progress import LearningProgressConfig, LearningProgressTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.self_paced import SelfPacedConfig, SelfPacedTeacher, self_paced_step

CELLS = TaskCells(("x",), VARIANTS)
COUNT = len(VARIANTS)
BUDGET = {"total_steps": 10**6, "seed": 0}


def sequence(seed: int, episodes: int):
    """Cells, successes and value errors of a fixed sequence; the last two cells never come up."""
    rng = np.random.default_rng(seed)
    for index in range(episodes):
        cell = int(rng.integers(COUNT - 2))
        chance = min(1.0, max(0.0, 0.2 + index / episodes - cell / COUNT))
        yield cell, float(rng.random() < chance), float(rng.exponential())


def shared(measure: list[float], share: float) -> list[float]:
    """In proportion to a measure beside a uniform share, as our teachers draw."""
    total = sum(measure)
    if total == 0:
        return [1 / len(measure)] * len(measure)
    return [share / len(measure) + (1 - share) * value / total for value in measure]


def test_learning_progress_follows_kanitscheider_at_every_episode():
    """Two exponential averages, f(p) = (1 − θ) p / (p + θ (1 − 2p)), |f(fast) − f(slow)|."""
    config = LearningProgressConfig()
    teacher = LearningProgressTeacher(CELLS, **BUDGET, config=config)
    fast: dict[int, float] = {}
    slow: dict[int, float] = {}

    def stretched(p: float) -> float:
        theta = config.low_success_emphasis
        return (1 - theta) * p / (p + theta * (1 - 2 * p))

    for cell, success, _ in sequence(0, 400):
        teacher.update_on_episode(0.0, 10, VARIANTS[cell], success)
        fast[cell] = fast.get(cell, success) + config.fast_rate * (
            success - fast.get(cell, success)
        )
        slow[cell] = slow.get(cell, success) + config.slow_rate * (
            success - slow.get(cell, success)
        )
        progress = [
            abs(stretched(fast[one]) - stretched(slow[one])) if one in fast else 0.0
            for one in range(COUNT)
        ]
        found = teacher.distribution().weights
        np.testing.assert_allclose(found, shared(progress, config.uniform_share), atol=1e-12)


@pytest.mark.parametrize("shrinkage", [0.0, 2.0])
def test_learnability_is_p_times_one_minus_p_at_every_episode(shrinkage):
    config = LearnabilityConfig(window_episodes=8, shrinkage_episodes=shrinkage)
    teacher = LearnabilityTeacher(CELLS, **BUDGET, config=config)
    seen: list[list[float]] = [[] for _ in range(COUNT)]
    for cell, success, _ in sequence(1, 400):
        teacher.update_on_episode(0.0, 10, VARIANTS[cell], success)
        seen[cell].append(success)
        windows = [own[-8:] for own in seen]
        together = [value for own in windows for value in own]
        pooled = (1 + sum(together)) / (2 + len(together))
        learnable = []
        for own in windows:
            if shrinkage:
                p = (sum(own) + shrinkage * pooled) / (len(own) + shrinkage)
            elif len(own) == 8:
                p = sum(own) / 8
            else:
                p = (1 + sum(own)) / (2 + len(own))
            learnable.append(p * (1 - p))
        found = teacher.distribution().weights
        np.testing.assert_allclose(found, shared(learnable, config.uniform_share), rtol=1e-12)


def test_pooling_tells_variants_apart_that_never_fill_a_window():
    """With four episodes a variant the rule without pooling takes all for nearly alike."""
    shares = []
    for shrinkage in (0.0, 2.0):
        teacher = LearnabilityTeacher(
            CELLS, **BUDGET, config=LearnabilityConfig(shrinkage_episodes=shrinkage)
        )
        for index in range(4 * COUNT):
            cell = index % COUNT
            half = index >= 2 * COUNT
            success = float(half) if cell == 3 else 0.0
            teacher.update_on_episode(0.0, 10, VARIANTS[cell], success)
        shares.append(float(teacher.distribution().weights[3]))
    assert shares[1] > 2 * shares[0]


def test_replay_follows_jiang_at_every_episode():
    """P = (1 − ρ) P_S + ρ P_C: ranks to the power −1/β, staleness counted up for all others."""
    config = ReplayConfig()
    teacher = ReplayTeacher(CELLS, **BUDGET, config=config)
    scores: dict[int, float] = {}
    staleness: dict[int, float] = {}
    for cell, success, error in sequence(2, 300):
        teacher.update_on_episode(0.0, 10, VARIANTS[cell], success, value_error=error)
        staleness = {one: age + 1 for one, age in staleness.items()}
        scores[cell], staleness[cell] = error, 0.0
        in_order = sorted(scores, key=lambda one: -scores[one])
        power = {one: (place + 1) ** (-1 / config.temperature)
                 for place, one in enumerate(in_order)}  # fmt: skip
        old = sum(staleness.values())
        expected = []
        for one in range(COUNT):
            if one not in scores:
                expected.append(1 / COUNT)  # an unseen level, by the share that is unseen
                continue
            stale = staleness[one] / old if old else 1 / len(scores)
            replay = (1 - config.staleness) * power[one] / sum(power.values())
            expected.append(len(scores) / COUNT * (replay + config.staleness * stale))
        np.testing.assert_allclose(teacher.distribution().weights, expected, rtol=1e-9, atol=1e-15)


def alp_sequence(teacher: AlpGmmTeacher, episodes: int):
    """Feed returns that rise in the middle of the range; give tasks, returns and progress."""
    rng = np.random.default_rng(3)
    tasks: list[float] = []
    returns: list[float] = []
    progress: list[float] = []
    for index in range(episodes):
        task = float(rng.random())
        value = 10 * index / episodes * math.exp(-(((task - 0.6) / 0.1) ** 2)) + rng.normal(0, 0.1)
        if len(tasks) > 5:
            nearest = min(range(len(tasks)), key=lambda one: abs(tasks[one] - task))
            progress.append(abs(value - returns[nearest]))
        else:
            progress.append(0.0)
        teacher.update_on_episode(value, 10, np.array([task]), 0.0)
        tasks.append(task)
        returns.append(value)
    return tasks, progress


def test_alp_gmm_follows_portelas_in_progress_choice_of_mixture_and_weights():
    config = AlpGmmConfig(fit_episodes=100, points=20_000)
    teacher = AlpGmmTeacher(WHOLE, **BUDGET, config=config)
    tasks, progress = alp_sequence(teacher, 300)
    state = teacher.state_dict()
    np.testing.assert_allclose(state["progress"], progress, rtol=1e-12)
    mixture = state["mixture"]
    # The kept mixture is of the newest N pairs, and its AIC is no higher than that of a mixture
    # whose parts are fitted by hand to halves of the range.
    pairs = np.column_stack([tasks, progress])[-100:]
    weights = np.asarray(mixture["weights"])
    means = np.asarray(mixture["means"])
    covariances = np.asarray(mixture["covariances"])

    def aic(parts) -> float:
        density = sum(
            weight * multivariate_normal(mean, covariance).pdf(pairs)
            for weight, mean, covariance in parts
        )
        return 2 * (6 * len(parts) - 1) - 2 * float(np.log(density).sum())

    low = pairs[:, 0] < np.median(pairs[:, 0])
    by_hand = [
        (0.5, half.mean(axis=0), np.cov(half.T, bias=True)) for half in (pairs[low], pairs[~low])
    ]
    assert 2 <= weights.size <= config.max_components
    assert aic(list(zip(weights, means, covariances, strict=True))) <= aic(by_hand)
    # A Gaussian is drawn by its mean progress, not by its weight; a task from its marginal.
    share = np.maximum(means[:, 1], 0) / np.maximum(means[:, 1], 0).sum()
    grid = np.linspace(0, 1, 4_001)
    density = sum(
        one * norm(mean[0], math.sqrt(covariance[0, 0])).pdf(grid)
        for one, mean, covariance in zip(share, means, covariances, strict=True)
    )
    density /= density.sum()
    expected = [
        config.uniform_share * 0.2 + (1 - config.uniform_share) * density[part].sum()
        for part in np.array_split(np.arange(4_001), 5)
    ]
    drawn = teacher.distribution().sample(np.random.default_rng(0), 40_000)[:, 0]
    found = np.histogram(drawn, bins=np.linspace(0, 1, 6))[0] / drawn.size
    # Two draws of 20,000 and 40,000: five standard errors of a share of one half.
    np.testing.assert_allclose(found, expected, atol=5 * 0.5 * math.sqrt(1 / 20_000 + 1 / 40_000))


def reference_step(now, target, tasks, success, config, *, start):
    """Solve Klink's problem anew for one parameter, over mean and logarithm of the deviation.

    Minimise KL(p ‖ target) with the importance-weighted success at least V_LB and KL(p ‖ before)
    at most ε: written with densities of SciPy and solved by another method, from several starts.
    """

    def kl(first, second) -> float:
        (m, s), (n, t) = first, second
        v, w = math.exp(s) ** 2, math.exp(t) ** 2
        return 0.5 * (v / w + (m - n) ** 2 / w - 1 + math.log(w / v))

    def performance(candidate) -> float:
        new = norm(candidate[0], math.exp(candidate[1])).pdf(tasks[:, 0])
        old = norm(now[0], math.exp(now[1])).pdf(tasks[:, 0])
        return float((new / old * success).mean())

    def penalised(candidate) -> float:
        over = max(0.0, kl(candidate, now) - config.step_bound)
        under = max(0.0, config.success_bound - performance(candidate))
        return kl(candidate, target) + 1e4 * (over**2 + under**2)

    found = minimize(
        penalised, start, method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-10,
                                                         "maxiter": 4_000},
    )  # fmt: skip
    return found.x, kl, performance


def test_self_paced_learning_solves_klinks_problem_step_by_step():
    config = SelfPacedConfig(update_episodes=200)
    easy = TaskDistribution.uniform(("x",), np.array([0.0]), np.array([0.2]))
    teacher = SelfPacedTeacher(WHOLE, easy, total_steps=10**6, seed=0, config=config)
    target = np.array([0.5, math.log(1 / math.sqrt(12))])
    for skill in (0.25, 0.3, 0.4, 0.5):
        now = np.array([teacher.mean[0], math.log(teacher.deviation[0])])
        tasks = teacher.sample(200)
        success = (tasks[:, 0] < skill).astype(float)
        expected, kl, performance = reference_step(now, target, tasks, success, config, start=now)
        step = self_paced_step(now, target, tasks, success, config)
        for task, good in zip(tasks, success, strict=True):
            teacher.update_on_episode(0.0, 10, task, float(good))
        np.testing.assert_allclose(
            [teacher.mean[0], math.log(teacher.deviation[0])], step, rtol=1e-6
        )
        assert kl(step, now) <= 1.05 * config.step_bound
        assert performance(step) >= config.success_bound - 0.01
        # The penalty lets the reference exceed its bounds by a little, so it may be a little lower.
        assert kl(step, target) == pytest.approx(kl(expected, target), abs=0.01)
