"""A log is drawn as closely as it tells, and refused where it tells nonsense."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.core.errors import InputError
from surmount.rstar.course.config import CourseConfig, EnvConfig
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.film.motion import record_motion
from surmount.rstar.film.replay import CAPTION, logged_features, replay_log, support_m
from surmount.rstar.robot.kinematics import standing_height_mm
from surmount.trials.trials import Trials

CHANNEL = find_obstacle("narrow-channel")
CONFIG = EnvConfig()


def spread_and_drive(observations, x_m):
    """Drive on, the body swinging forward and the legs closing: a pilot."""
    return np.array([[0.5, 0.3, -0.3]])


@pytest.fixture(scope="module")
def simulated():
    return record_motion(CHANNEL, CONFIG, 300.0, spread_and_drive, caption="", longest_s=1.5)


def test_on_level_ground_a_log_is_drawn_as_it_was_simulated(simulated):
    drawn = replay_log(CHANNEL, CONFIG, 300.0, simulated.features, success=False)
    rows = np.searchsorted(simulated.time_s, drawn.time_s - 1e-9)
    truth = simulated.qpos[rows]
    assert drawn.duration_s == pytest.approx(1.5)
    # Position along the course: heights that are 3 mm off at most make the 30 mm by which the base
    # comes to stand above the target point, 0.35 m away, a position that is 0.3 mm off at most.
    np.testing.assert_allclose(drawn.qpos[:, 0], truth[:, 0], atol=3e-4)
    # Height: the closed form knows no sag of the servos and tyres under the weight.
    np.testing.assert_allclose(drawn.qpos[:, 2], truth[:, 2], atol=0.003)
    # Tilt: as driven, within 1.5°.
    np.testing.assert_allclose(drawn.qpos[:, 3:7], truth[:, 3:7], atol=0.013)
    # Joints of the legs are the logged angles, sides alike; wheels roll up to their slip.
    legs = [7, 8, 9, 12, 13, 14, 15, 18]
    np.testing.assert_allclose(drawn.qpos[:, legs], truth[:, legs], atol=0.02)
    assert drawn.caption == CAPTION
    assert "logged for 1.50 s" in drawn.outcome


def test_a_log_of_level_poses_gives_back_where_they_were():
    # x, sprawl and FBEM of poses as low and as high as the robot stands on the floor.
    x_m = np.array([-0.4, -0.2, 0.0, 0.2, 0.3])
    sprawl, fbem = np.array([0.0, 30, 48, 70, 90]), np.array([0.0, 72, 0, -72, 40])
    above_m = (
        standing_height_mm(sprawl, fbem, "wheels") - standing_height_mm(48, 0, "wheels")
    ) / 1e3
    assert np.ptp(above_m) > 0.08
    rows = np.stack([np.arange(5.0), sprawl, fbem, np.hypot(0.32 - x_m, above_m)], axis=1)
    drawn = replay_log(CHANNEL, CONFIG, 300.0, rows, success=False)
    np.testing.assert_allclose(drawn.qpos[:, 0], x_m, atol=1e-12)


def test_the_last_row_of_a_success_lies_beyond_the_target():
    rows = np.array([[0.0, 48, 0, 0.1], [0.1, 48, 0, 0.01], [0.2, 48, 0, 0.02]])
    target = CONFIG.course.target_m
    reached = replay_log(CHANNEL, CONFIG, 300.0, rows, success=True)
    assert reached.qpos[:, 0] == pytest.approx([target - 0.1, target - 0.01, target + 0.02])
    failed = replay_log(CHANNEL, CONFIG, 300.0, rows, success=False)
    assert failed.qpos[-1, 0] == pytest.approx(target - 0.02)


def test_a_wheel_at_a_step_touches_its_edge():
    step, course, radius, height = find_obstacle("step"), CourseConfig(), 0.03058, 0.025
    axle_m = np.array([-0.1, -0.02, 0.0, 0.1, course.obstacle_length_m + 0.02, 0.5])
    lifted = support_m(step, course, 1e3 * height, axle_m)
    assert lifted[[0, 2, 3, 5]] == pytest.approx([0.0, height, height, 0.0])
    # On the edge, the axle is a radius away from it.
    for at, edge in ((1, 0.0), (4, course.obstacle_length_m)):
        away = np.hypot(axle_m[at] - edge, lifted[at] + radius - height)
        assert away == pytest.approx(radius)
    assert (support_m(CHANNEL, course, 300.0, axle_m) == 0).all()


def test_a_robot_on_a_step_is_drawn_level_on_top_and_tilted_on_the_way():
    step = find_obstacle("step")
    ahead, above = 0.32 - np.array([-0.3, 0.0, 0.15]), np.array([0.0, 0.0, 0.04])
    # Half-way up, the base is raised by half the step, and lowered by the tilt of its legs.
    tilt, stand = np.arcsin(40 / 145.6), standing_height_mm(48, 0, "wheels") / 1e3
    above[1] = 0.02 - stand * (1 - np.cos(tilt))
    distance = np.hypot(ahead, above)
    rows = np.stack([np.arange(3.0), np.full(3, 48.0), np.zeros(3), distance], axis=1)
    before, on_the_edge, on_top = replay_log(step, CONFIG, 40.0, rows, success=False).qpos
    assert on_top[2] - before[2] == pytest.approx(0.04)
    assert before[3:7] == pytest.approx([1, 0, 0, 0])
    assert on_top[3:7] == pytest.approx([1, 0, 0, 0])
    # Front wheels 40 mm higher than the rear ones, 145.6 mm apart, nose up.
    assert np.rad2deg(2 * np.arctan2(-on_the_edge[5], on_the_edge[3])) == pytest.approx(
        np.rad2deg(np.arcsin(40 / 145.6))
    )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ((1, 0, 0.0), "`time_s` does not increase"),
        ((1, 1, 300.0), "sprawl 300°"),
        ((1, 2, -90.0), "FBEM -90°"),
    ],
)
def test_nonsense_is_refused(change, sentence):
    rows = np.array([[0.0, 48, 0, 0.1], [0.1, 48, 0, 0.05]])
    row, column, value = change
    rows[row, column] = value
    with pytest.raises(InputError, match=sentence):
        replay_log(CHANNEL, CONFIG, 300.0, rows, success=False)


def test_features_are_taken_by_name_and_missing_ones_named():
    table = {
        "parameters": ("variant",),
        "variant": np.array([[300.0]]),
        "network": np.array([0]),
        "repetition": np.array([0]),
        "success": np.array([True]),
        "starts": np.array([0, 1]),
    }
    names = ("fbem_deg", "distance_m", "time_s", "sprawl_deg")
    trials = Trials(feature_names=names, features=np.array([[1.0, 2.0, 3.0, 4.0]]), **table)
    assert logged_features(trials, 0).tolist() == [[3.0, 4.0, 1.0, 2.0]]
    trials = Trials(feature_names=("time_s",), features=np.array([[3.0]]), **table)
    with pytest.raises(InputError, match="no feature `sprawl_deg`"):
        logged_features(trials, 0)
