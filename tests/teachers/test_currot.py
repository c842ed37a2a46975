"""CURROT's particles go to the target by the cheapest ways, as far as success allows."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from toy_learner import WHOLE

from surmount.core.errors import ConfigError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.currot import CurrotConfig, CurrotTeacher
from surmount.teachers.transport import matching, moved_towards

TARGET = TaskDistribution.uniform(("x",), np.array([0.9]), np.array([1.0]))


def test_the_matching_is_the_cheapest_of_all_permutations():
    rng = np.random.default_rng(0)
    for _ in range(20):
        one, other = rng.random((5, 2)), rng.random((5, 2))
        rows, columns = matching(one, other)
        found = np.square(one[rows] - other[columns]).sum()
        least = min(
            np.square(one - other[list(order)]).sum() for order in itertools.permutations(range(5))
        )
        assert found == pytest.approx(least, rel=1e-12)


def test_moves_solve_the_program_as_a_general_solver_does():
    scipy_optimize = pytest.importorskip("scipy.optimize")
    rng = np.random.default_rng(1)
    particles, targets = rng.random((6, 2)), rng.random((6, 2))
    squared = np.square(targets - particles).sum(axis=1)
    moved = moved_towards(particles, targets, lambda points: 1.0 - points[:, 0], 0.2, 0.15)
    ways = targets - particles
    bounds = []
    for particle, way in zip(particles, ways, strict=True):
        if particle[0] > 0.8:
            bounds.append((0.0, 0.0))
        else:
            bounds.append((0.0, 1.0 if way[0] <= 0 else min(1.0, (0.8 - particle[0]) / way[0])))
    found = scipy_optimize.minimize(
        lambda share: ((1 - share) ** 2 * squared).mean(),
        np.zeros(6),
        bounds=bounds,
        constraints=[{"type": "ineq", "fun": lambda share: 0.15**2 - (share**2 * squared).mean()}],
        options={"ftol": 1e-14, "maxiter": 1_000},
    )
    left = np.square(targets - moved).sum(axis=1).mean()
    assert np.sqrt(np.square(moved - particles).sum(axis=1).mean()) <= 0.15 + 1e-9
    # Sound places are looked at on a grid of 1/32 of each way.
    assert left == pytest.approx(found.fun, abs=2e-3)


def teacher_of() -> CurrotTeacher:
    return CurrotTeacher(WHOLE, TARGET, total_steps=10**6, seed=0, config=CurrotConfig())


def play(teacher: CurrotTeacher, skill: float, episodes: int) -> None:
    for _ in range(episodes):
        task = teacher.sample()[0]
        teacher.update_on_episode(0.0, 10, task, float(task[0] < skill))


def test_particles_begin_over_the_range_and_stay_until_something_succeeds():
    teacher = teacher_of()
    before = teacher.particles
    assert before.mean() == pytest.approx(0.5, abs=0.1)
    play(teacher, -1.0, 200)
    np.testing.assert_array_equal(teacher.particles, before)


def test_particles_wait_at_the_edge_of_success_and_reach_the_target_once_it_moves():
    teacher = teacher_of()
    play(teacher, 0.4, 800)
    # The estimate falls to one half within a kernel's width of the edge.
    assert 0.2 < np.quantile(teacher.particles, 0.9) < 0.55
    play(teacher, 2.0, 1_000)
    assert teacher.particles.min() >= 0.85
    assert teacher.distribution().upper.max() <= 1.0


@pytest.mark.parametrize("changes", [{"particles": 0}, {"success_bound": 2.0}, {"bandwidth": 0.0}])
def test_settings_out_of_range_are_refused(changes):
    with pytest.raises(ConfigError, match=next(iter(changes))):
        CurrotConfig(**changes)
