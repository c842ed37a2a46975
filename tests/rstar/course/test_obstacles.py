import numpy as np
import pytest

from surmount.core.errors import ConfigError
from surmount.rstar.course.config import CourseConfig, EnvConfig, StartConfig
from surmount.rstar.course.obstacles import (
    OBSTACLES,
    Poses,
    block_positions,
    blocks,
    find_obstacle,
    ground_m,
)
from surmount.rstar.course.start_poses import fixed_start, random_start
from surmount.rstar.robot import kinematics

COURSE = CourseConfig()


def test_variants_are_those_of_the_paper():
    # III-C: widths 180...320 by 10, heights 55...140 by 5, heights 21...50 by 1.
    expected = {
        "narrow-channel": (180, 320, 15),
        "low-entrance": (55, 140, 18),
        "step": (21, 50, 30),
    }
    assert set(OBSTACLES) == set(expected)
    for name, (first, last, count) in expected.items():
        variants = OBSTACLES[name].variants
        assert (variants[0], variants[-1], variants.size) == (first, last, count)
        assert np.diff(variants) == pytest.approx((last - first) / (count - 1))


def test_blocks_leave_exactly_the_opening_that_the_variant_names():
    for name, obstacle in OBSTACLES.items():
        sizes = obstacle.variants
        centre = block_positions(obstacle, COURSE, sizes)
        half = np.array([block.half_size_m for block in blocks(obstacle, COURSE)])
        low, high = centre - half, centre + half
        if name == "narrow-channel":
            opening = low[:, 0, 1] - high[:, 1, 1]
        elif name == "low-entrance":
            opening = low[:, 0, 2]
        else:
            opening = high[:, 0, 2]
        assert opening * 1e3 == pytest.approx(sizes)
        assert low[:, :, 0] == pytest.approx(0.0)


def test_no_way_leads_around_an_obstacle():
    # Past the blocks less floor remains than the narrowest robot's half width: it would topple.
    narrowest = kinematics.width_mm(0.0, 0.0, "wheels") * 1e-3 / 2
    for obstacle in OBSTACLES.values():
        centre = block_positions(obstacle, COURSE, obstacle.variants)
        half = np.array([block.half_size_m for block in blocks(obstacle, COURSE)])
        outer = (np.abs(centre[:, :, 1]) + half[:, 1]).min()
        assert COURSE.floor_half_width_m - outer < narrowest


def test_drawn_starts_keep_clear_of_the_obstacle_and_reach_the_whole_workspace():
    config = EnvConfig()
    for obstacle in OBSTACLES.values():
        rng = np.random.default_rng(0)
        size = float(obstacle.variants[obstacle.variants.size // 2])
        starts = [random_start(obstacle, config, size, rng) for _ in range(300)]
        for start in starts:
            pose = Poses(
                x_m=np.array([start.x_m]),
                y_m=np.array([start.y_m]),
                yaw_deg=np.zeros(1),
                sprawl_deg=np.array([start.sprawl_deg]),
                fbem_deg=np.array([start.fbem_deg]),
            )
            fits, ground = ground_m(obstacle, config.course, size, pose, "wheels")
            assert fits[0]
            stands = kinematics.standing_height_mm(start.sprawl_deg, start.fbem_deg, "wheels")
            assert start.z_m - ground[0] == pytest.approx(stands * 1e-3)
        x = np.array([start.x_m for start in starts])
        assert x.min() < -0.4
        assert (x > 0).mean() > 0.05


def test_starts_before_the_obstacle_leave_it_ahead():
    config = EnvConfig(start=StartConfig(region="before"))
    rng = np.random.default_rng(0)
    for _ in range(200):
        start = random_start(OBSTACLES["step"], config, 30.0, rng)
        _, front = kinematics.fore_aft_extent_mm(start.fbem_deg)
        assert start.x_m + front * 1e-3 < 0


def test_fixed_start_leaves_161_mm_between_front_wheels_and_face():
    start = fixed_start(EnvConfig())
    # Wheel fronts lie 72.8 + 30.58 mm ahead of the base at zero FBEM.
    assert -start.x_m - 0.10338 == pytest.approx(0.161)
    assert (start.sprawl_deg, start.fbem_deg) == (48.0, 0.0)


def test_an_unknown_obstacle_is_refused_with_the_choices():
    with pytest.raises(ConfigError, match="narrow-channel, low-entrance, step"):
        find_obstacle("wall")
