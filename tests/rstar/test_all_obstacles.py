"""All three obstacles at once: each is the single family's, and the policy is told which it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surmount.core.errors import ConfigError, InputError
from surmount.envs.registry import find_family
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.kinds import AXES, KINDS, PARAMETERS, hardness, sizes_mm
from surmount.rstar.course.mixed import MixedVectorEnv
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.family import ObstacleFamily
from surmount.tasks.cells import TaskCells
from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions
from surmount.teachers.catalogue import TeachersConfig, require_space

CONFIG = EnvConfig()
SHORT = replace(CONFIG, episode_s=0.2)
FAMILY = find_family("rstar/all")
SPACE = FAMILY.space(CONFIG)
CELLS = TaskCells(SPACE.parameters, SPACE.variants, SPACE.axes)


def test_the_variants_are_those_of_the_three_families():
    assert len(SPACE.variants) == 15 + 18 + 30
    for place, kind in enumerate(KINDS):
        own = SPACE.variants[SPACE.variants[:, 0] == place, 1]
        assert (own[0], own[-1]) == (0.0, 1.0)
        assert sizes_mm(kind, own[-1]) == kind.hardest
        np.testing.assert_allclose(np.sort(sizes_mm(kind, own)), kind.variants, rtol=1e-12)
        np.testing.assert_allclose(hardness(kind, sizes_mm(kind, own)), own, atol=1e-12)
    assert SPACE.named(SPACE.variants[-1]) == {"obstacle": "step", "hardness": 1.0}


def test_cells_tile_each_kind_and_never_reach_into_another():
    assert (CELLS.lower[:, 0] == CELLS.upper[:, 0]).all()
    for place in range(3):
        own = CELLS.variants[:, 0] == place
        lower, upper = CELLS.lower[own, 1], CELLS.upper[own, 1]
        assert (lower[0], upper[-1]) == (0.0, 1.0)
        np.testing.assert_allclose(lower[1:], upper[:-1], atol=1e-12)
    tasks = SPACE.whole_range.sample(np.random.default_rng(0), 3_000)
    assert np.bincount(tasks[:, 0].astype(int)).min() > 800
    found = np.array([CELLS.locate(task) for task in tasks])
    assert (CELLS.variants[found, 0] == tasks[:, 0]).all()


def test_a_group_may_hold_variants_of_several_kinds():
    boxes = [
        Box(lower=CELLS.lower[cell], upper=CELLS.upper[cell], weight=1.0) for cell in range(63)
    ]
    hard = [14, 31, 32, 62]  # a channel, two entrances, a step
    rest = [cell for cell in range(63) if cell not in hard]
    groups = tuple(
        Group(
            name=name,
            variants=SPACE.variants[cells],
            success_rate=rate,
            boxes=tuple(boxes[cell] for cell in cells),
        )
        for name, rate, cells in (("easy", 0.9, rest), ("hard", 0.1, hard))
    )
    curriculum = Curriculum(
        parameters=PARAMETERS,
        groups=groups,
        levels=(Level(dominant="hard", weights=(0.2, 0.8)),),
        success_threshold=0.95,
        axes=AXES,
    )
    drawn = curriculum.group_distribution(1).sample(np.random.default_rng(0), 4_000)
    # Four standard errors of shares of a quarter, a half and a quarter.
    np.testing.assert_allclose(np.bincount(drawn[:, 0].astype(int)) / 4_000, [0.25, 0.5, 0.25],
                               atol=0.03)  # fmt: skip
    regions = Regions.of(Curriculum.from_record(curriculum.to_record()))
    assert set(regions.index(drawn).tolist()) == {1}
    np.testing.assert_allclose(regions.shares(curriculum.level_distribution(0)), [0.2, 0.8])


def test_every_obstacle_goes_as_in_its_own_family():
    rng = np.random.default_rng(0)
    tasks = np.array([[0, 0.1], [1, 0.2], [2, 0.9], [0, 1.0], [1, 0.7], [2, 0.0]])
    mixed = MixedVectorEnv(6, config=CONFIG, autoreset=False, start="fixed")
    mixed.reset(seed=7, options={"variant": tasks[::-1]})  # every environment changes its kind
    seen, infos = mixed.reset(seed=8, options={"variant": tasks})
    singles = []
    for place, kind in enumerate(KINDS):
        env = ObstacleFamily(OBSTACLES[kind.name]).trial_env(CONFIG, 2)
        sizes = sizes_mm(kind, tasks[tasks[:, 0] == place, 1])
        singles.append((env, *env.reset(options={"variant": sizes})))
    for _ in range(60):
        actions = rng.uniform(-0.2, 1.0, (6, 3))
        outcome = []
        for place, (env, alone, told) in enumerate(singles):
            own = tasks[:, 0] == place
            kept = [0, *([1] if place == 2 else []), *range(2, 6), -1]  # pitch at steps alone
            np.testing.assert_array_equal(seen[own][:, kept], alone)
            flags = seen[own][:, 6:9]
            assert (flags.argmax(axis=1) == place).all()
            assert (flags.sum(axis=1) == -1).all()
            np.testing.assert_array_equal(infos["features"][own], told["features"])
            np.testing.assert_array_equal(infos["size_mm"][own], told["variant"][:, 0])
            outcome.append(env.step(actions[own]))
        seen, reward, ended, cut, infos = mixed.step(actions)
        for place, (_, expected, over, late, _) in enumerate(outcome):
            own = tasks[:, 0] == place
            np.testing.assert_array_equal(reward[own], expected)
            np.testing.assert_array_equal(ended[own], over)
            np.testing.assert_array_equal(cut[own], late)
        singles = [
            (env, step[0], step[-1]) for (env, *_), step in zip(singles, outcome, strict=True)
        ]
    np.testing.assert_array_equal(infos["variant"], tasks)


def test_an_environment_changes_its_kind_when_an_episode_ends_and_goes_on_from_a_state():
    env = FAMILY.training_env(SHORT, 9)
    seen, infos = env.reset(seed=1)
    rng = np.random.default_rng(0)
    kinds = [infos["variant"][:, 0]]
    saved, went_on = None, []
    for step in range(70):
        actions = rng.uniform(-1, 1, (9, 3))
        if step == 35:
            saved = env.state_dict()
        before = infos["variant"]
        seen, reward, ended, cut, infos = env.step(actions)
        done = ended | cut
        kinds.append(infos["variant"][:, 0])
        assert (seen[:, 6:9].argmax(axis=1) == infos["variant"][:, 0]).all()
        assert env.single_observation_space.contains(seen[0])
        if done.any():
            np.testing.assert_array_equal(infos["final_info"]["variant"][done], before[done])
            assert (infos["features"][done, 0] == 0).all()
        if step >= 35:
            went_on.append((actions, seen, reward))
    changes = np.diff(np.stack(kinds), axis=0) != 0
    assert changes.any(axis=0).sum() >= 5
    other = FAMILY.training_env(SHORT, 9)
    other.reset(seed=2)
    other.load_state_dict(saved)
    for actions, expected, reward in went_on:
        seen, again, *_ = other.step(actions)
        np.testing.assert_array_equal(seen, expected)
        np.testing.assert_array_equal(again, reward)
    env.close()
    other.close()


def test_seeds_repeat_and_tasks_are_drawn_from_what_was_pushed():
    env = FAMILY.training_env(SHORT, 4)
    only = SPACE.variants[40]
    env.set_task_distribution(TaskDistribution.uniform(PARAMETERS, only, only, AXES))
    first, infos = env.reset(seed=3)
    assert (infos["variant"] == only).all()
    again, _ = env.reset(seed=3)
    np.testing.assert_array_equal(first, again)


def test_what_does_not_fit_is_refused():
    env = FAMILY.training_env(SHORT, 2)
    one = np.array([1.0, 0.5])
    with pytest.raises(InputError, match="other axes"):
        env.set_task_distribution(TaskDistribution.uniform(PARAMETERS, one, one))
    for wrong in (np.array([3.0, 0.5]), np.array([1.0, 1.5])):
        with pytest.raises(InputError):
            env.reset(options={"variant": np.stack([wrong, wrong])})
    with pytest.raises(InputError, match="not been reset"):
        env.step(np.zeros((2, 3)))
    with pytest.raises(ConfigError, match="distances"):
        require_space("alp-gmm", SPACE, TeachersConfig())
    for name in ("paper", "mastery", "frontier", "frontier-cells", "frontier-parameters", "plr"):
        require_space(name, SPACE, TeachersConfig())
