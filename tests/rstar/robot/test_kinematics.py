import numpy as np
import pytest

from surmount.rstar.robot import constants as c
from surmount.rstar.robot.kinematics import (
    body_shift_mm,
    height_mm,
    leg_length_mm,
    leg_point_mm,
    standing_height_mm,
    width_mm,
)

SPRAWL = np.linspace(0.0, 180.0, 361)
TO_A_MM = 0.5  # published extents are whole millimetres


def test_extents_of_the_geometry_are_the_published_ones():
    fbem = np.linspace(-72.0, 72.0, 145)
    down = width_mm(0.0, fbem)
    # Published: width 115-290 mm, height 42-125 mm, length 150 mm. The sourced dimensions give
    # a largest width of 288.3 mm, 0.6 % short of the published figure.
    assert down.min() == pytest.approx(115, abs=TO_A_MM)
    assert width_mm(SPRAWL, 0.0).max() == pytest.approx(290, abs=2.0)
    low_to_high = height_mm(np.linspace(0.0, 90.0, 181)[:, None], fbem[None])
    assert height_mm(90.0, 0.0) == pytest.approx(42, abs=TO_A_MM)
    assert low_to_high.max() == pytest.approx(125, abs=TO_A_MM)
    assert pytest.approx(150) == c.BAR_LENGTH_MM


def test_start_pose_is_248_mm_wide_and_94_5_mm_high_with_both_gears_fitted():
    assert width_mm(c.START_SPRAWL_DEG, c.START_FBEM_DEG) == pytest.approx(248, abs=TO_A_MM)
    assert height_mm(c.START_SPRAWL_DEG, c.START_FBEM_DEG) == pytest.approx(94.5, abs=TO_A_MM)


def test_narrowest_channel_and_lowest_entrance_need_the_sprawl_that_the_sources_name():
    # 180 mm needs s <= 22 deg (f = 0) or <= 37 deg (|f| = 72 deg); 55 mm needs s >= 74 or >= 65.
    fine = np.linspace(0.0, 90.0, 9001)
    for fbem, narrow, low in ((0.0, 22, 74), (72.0, 37, 65), (-72.0, 37, 65)):
        assert fine[width_mm(fine, fbem) <= 180].max() == pytest.approx(narrow, abs=1.0)
        assert fine[height_mm(fine, fbem) <= 55].min() == pytest.approx(low, abs=1.0)


def test_leg_length_and_body_shift_follow_the_rod():
    # A rod of 50.09 mm at 72 deg: cosine 0.30902, sine 0.95106.
    assert leg_length_mm(0.0) == pytest.approx(83.92, abs=1e-9)
    assert leg_length_mm([-72.0, 72.0]) == pytest.approx([49.309, 49.309], abs=1e-3)
    assert body_shift_mm([-72.0, 0.0, 72.0]) == pytest.approx([-47.638, 0.0, 47.638], abs=1e-3)


def test_leg_points_turn_from_down_through_outwards_to_up():
    lateral, height = leg_point_mm([0.0, 90.0, 180.0], 50.0, 10.0)
    assert lateral == pytest.approx([38.57, 78.57, 18.57])
    assert height == pytest.approx([-50.0, 10.0, 50.0])


def test_closed_forms_broadcast_over_sprawl_and_fbem():
    grid = standing_height_mm(SPRAWL[:, None], np.linspace(-72, 72, 7)[None], "wheels")
    assert grid.shape == (361, 7)
    assert grid[0, 3] == pytest.approx(float(standing_height_mm(0.0, 0.0, "wheels")))
    assert (grid >= c.BODY_BOTTOM_MM).all()  # never lower than lying on the belly
