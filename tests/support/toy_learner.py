"""A learner whose right curriculum is known: it learns only at the edge of what it can do.

Tasks are numbers from 0 (easy) to 1 (hard). The learner succeeds up to its skill, with a soft edge,
and its skill grows by practising tasks at this edge; all others teach it nothing.
"""

from __future__ import annotations

import numpy as np

from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.catalogue import TeacherContext, TeachersConfig
from surmount.teachers.given_groups import GivenGroupsConfig
from surmount.teachers.teacher import Episodes, RolloutOutcome

VARIANTS = np.linspace(0.0, 1.0, 21)[:, None]
WHOLE = TaskDistribution.uniform(("x",), np.array([0.0]), np.array([1.0]))
EDGE = 0.05
"""Width of the edge: uniform tasks teach for 4 · EDGE, a fifth, of what tasks at the edge do."""
EPISODE_STEPS = 10


class ToyLearner:
    """Draws tasks as environments do, from whatever distribution was pushed last."""

    def __init__(self, seed: int, *, skill: float = 0.1, growth: float = 0.005) -> None:
        self.rng = np.random.default_rng(seed)
        self.skill = skill
        self.growth = growth

    def play(self, task: float) -> tuple[float, bool, float]:
        chance = 1.0 / (1.0 + np.exp((task - self.skill) / EDGE))
        success = bool(self.rng.random() < chance)
        edge = 4.0 * chance * (1.0 - chance)  # 1 at the skill, 0 far from it
        self.skill = min(1.0, self.skill + self.growth * edge)
        return 10.0 * success, success, edge

    def rollout(self, distribution: TaskDistribution, episodes: int) -> RolloutOutcome:
        tasks = distribution.sample(self.rng, episodes)
        played = [self.play(float(task)) for task in tasks[:, 0]]
        reward, success, error = (np.array(column) for column in zip(*played, strict=True))
        steps = np.arange(1, episodes + 1) * EPISODE_STEPS
        return RolloutOutcome(
            rewards=np.zeros(episodes * EPISODE_STEPS),
            episodes=Episodes(
                step=steps,
                variant=tasks,
                reward=reward,
                length=np.full(episodes, EPISODE_STEPS),
                success=success,
                diverged=np.zeros(episodes, dtype=np.bool_),
            ),
            value_errors=error,
        )


def train(teacher, learner: ToyLearner, rollouts: int, *, episodes: int = 20) -> list[np.ndarray]:
    """Return the tasks of each roll-out."""
    tasks = []
    for _ in range(rollouts):
        if teacher.finished:
            break
        outcome = learner.rollout(teacher.distribution(), episodes)
        teacher.update_on_rollout(outcome)
        tasks.append(outcome.episodes.variant[:, 0])
    return tasks


def toy_curriculum() -> Curriculum:
    """Three groups of seven variants, two levels."""
    groups = tuple(
        Group(
            name=name,
            variants=VARIANTS[low : low + 7],
            success_rate=rate,
            boxes=(
                Box(
                    lower=np.array([max(0.0, low / 20 - 0.025)]),
                    upper=np.array([min(1.0, low / 20 + 0.325)]),
                    weight=7.0,
                ),
            ),
        )
        for name, low, rate in (("easy", 0, 0.97), ("medium", 7, 0.3), ("difficult", 14, 0.0))
    )
    return Curriculum(
        parameters=("x",),
        groups=groups,
        levels=(
            Level(dominant="medium", weights=(0.2, 0.7, 0.1)),
            Level(dominant="difficult", weights=(0.2, 0.1, 0.7)),
        ),
        success_threshold=0.95,
    )


def toy_context(*, seed: int = 0, total_steps: int = 10**6) -> TeacherContext:
    rates = np.repeat([0.97, 0.3, 0.0], 7)
    return TeacherContext(
        curriculum=toy_curriculum(),
        variants=VARIANTS,
        success_rate=rates,
        whole_range=WHOLE,
        harder=(1,),
        total_steps=total_steps,
        seed=seed,
        environments=9,
        teachers=TeachersConfig(given_groups=GivenGroupsConfig(boundaries=(0.325, 0.675))),
    )
