import itertools

import mujoco
import numpy as np
import pytest

from surmount.core.errors import ConfigError
from surmount.rstar.robot import constants as c
from surmount.rstar.robot import kinematics
from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.model import add_robot
from surmount.rstar.robot.parts import SIDES
from surmount.rstar.robot.running_gear import wheel_names

TO_MM = 0.5  # the tolerance the project sets itself for compiled against closed form


def compiled(config: RobotConfig) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    add_robot(spec, config)
    return spec.compile()


def posed(model, sprawl, fbem, wheel=0.0):
    data = mujoco.MjData(model)
    for joint in range(1, model.njnt):
        name = model.joint(joint).name
        _, part = name.split("_", 1)
        angle = {"sprawl": sprawl, "fbem": fbem, "rear_rod": fbem, "carrier": -fbem}.get(
            part, wheel
        )
        data.qpos[model.jnt_qposadr[joint]] = np.deg2rad(angle)
    mujoco.mj_forward(model, data)
    return data


def support_mm(model, data, direction):
    """Largest extent of the colliding geoms along a direction, from the base, by their shapes."""
    solid = model.geom_contype > 0
    kind, size = model.geom_type[solid], model.geom_size[solid]
    box, cylinder = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER
    assert np.isin(kind, [box, cylinder]).all()
    local = direction @ data.geom_xmat[solid].reshape(-1, 3, 3)
    of_box = (np.abs(local) * size).sum(axis=1)
    of_cylinder = size[:, 0] * np.hypot(local[:, 0], local[:, 1]) + size[:, 1] * abs(local[:, 2])
    reach = np.where(kind == box, of_box, of_cylinder)
    return ((data.geom_xpos[solid] - data.body("base").xpos) @ direction + reach).max() * 1e3


@pytest.mark.parametrize("gear", ["wheels", "whegs", "both"])
def test_width_height_leg_and_shift_of_the_compiled_model_match_the_closed_forms(gear):
    model = compiled(RobotConfig(gear=gear))
    up, left = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    for sprawl, fbem in itertools.product(np.linspace(0, 180, 13), np.linspace(-72, 72, 5)):
        # Closed forms treat whegs as discs: turn the spokes through their period of 120 deg.
        turns = [0.0] if gear == "wheels" else np.arange(0, 120, 12)
        poses = [posed(model, sprawl, fbem, turn) for turn in turns]
        extent = {
            axis: max(support_mm(model, data, direction) for data in poses)
            for axis, direction in (("up", up), ("down", -up), ("left", left), ("right", -left))
        }
        assert extent["left"] + extent["right"] == pytest.approx(
            kinematics.width_mm(sprawl, fbem, gear), abs=TO_MM
        )
        assert extent["up"] == pytest.approx(
            kinematics.highest_point_mm(sprawl, fbem, gear), abs=TO_MM
        )
        assert -extent["down"] == pytest.approx(
            kinematics.lowest_point_mm(sprawl, fbem, gear), abs=TO_MM
        )
        data = poses[0]
        axle = (data.body("left_front").xpos + data.body("left_rear").xpos) / 2
        pivot = data.body("left_leg").xpos
        across = (axle - pivot)[1:] * 1e3
        assert np.hypot(*across) == pytest.approx(kinematics.leg_length_mm(fbem), abs=TO_MM)
        shift = (data.body("base").xpos - axle)[0] * 1e3
        assert shift == pytest.approx(kinematics.body_shift_mm(fbem), abs=TO_MM)


@pytest.mark.parametrize("gear", ["wheels", "both"])
@pytest.mark.parametrize("mass_kg", [0.5, c.SIMULATION_MASS_KG])
def test_masses_keep_the_simulations_fractions_at_any_total(gear, mass_kg):
    model = compiled(RobotConfig(gear=gear, mass_kg=mass_kg))
    mass = {model.body(i).name: model.body_mass[i] / mass_kg for i in range(1, model.nbody)}
    wheels = 4 if gear == "wheels" else 6
    assert sum(mass.values()) == pytest.approx(1.0)
    # Fractions of 2.484 kg, computed by hand.
    assert mass["base"] == pytest.approx(0.30596, abs=1e-5)
    assert mass["left_leg"] == mass["right_leg"] == pytest.approx(0.08857, abs=1e-5)
    assert mass["left_front_rod"] == pytest.approx(0.01610, abs=1e-5)
    assert mass["right_carrier"] == pytest.approx(0.22142 + (6 - wheels) / 2 * 0.00161, abs=1e-5)
    assert mass["left_front"] == pytest.approx(0.00161, abs=1e-5)


def test_commands_cover_the_published_ranges_and_rates():
    config = RobotConfig()
    model = compiled(config)
    radius_m = c.WHEEL_RADIUS_MM * 1e-3
    for side in SIDES:
        sprawl, fbem = model.actuator(f"{side}_sprawl"), model.actuator(f"{side}_fbem")
        assert np.rad2deg(sprawl.actrange) == pytest.approx([0, 180])
        assert np.rad2deg(fbem.actrange) == pytest.approx([-72, 72])
        assert np.rad2deg(sprawl.ctrlrange) == pytest.approx([-80, 80])
        assert np.rad2deg(fbem.ctrlrange) == pytest.approx([-80, 80])
    for name in wheel_names(config):
        wheel = model.actuator(name)
        assert wheel.actrange * radius_m == pytest.approx([-0.25, 0.25])
        assert wheel.ctrlrange * radius_m == pytest.approx([-1.0, 1.0])


@pytest.mark.parametrize("gear", ["wheels", "both"])
def test_parts_of_the_robot_keep_apart_over_the_whole_range(gear):
    # This is what lets the model do without collisions among the robot's own parts. Only the
    # motor nubs meet, at the end of the range: 2 x (28.8 - 28.57) mm = 0.46 mm at 180 deg.
    model = compiled(RobotConfig(gear=gear))
    solid = [geom for geom in range(model.ngeom) if model.geom_contype[geom]]
    body = model.geom("body").id
    left, right = (
        [g for g in solid if model.geom(g).name.startswith(side)] for side in ("left", "right")
    )
    pairs = [*((body, g) for g in left + right), *itertools.product(left, right)]
    nubs = (model.geom("left_nub").id, model.geom("right_nub").id)
    for sprawl, fbem in itertools.product((0, 45, 90, 135, 180), (-72, 0, 72)):
        data = posed(model, sprawl, fbem)
        gap_mm = {
            pair: mujoco.mj_geomDistance(model, data, *pair, 0.02, None) * 1e3 for pair in pairs
        }
        nub_gap = gap_mm.pop(nubs)
        assert min(gap_mm.values()) > 5.0
        assert nub_gap > (-0.47 if sprawl == 180 else 1.0)


def test_stops_keep_parts_apart_where_an_obstacle_is_stronger_than_the_servos():
    model = compiled(RobotConfig())
    body, left = (
        model.geom("body").id,
        [
            geom
            for geom in range(model.ngeom)
            if model.geom_contype[geom] and model.geom(geom).name.startswith("left")
        ],
    )
    for joint, sign in itertools.product(("left_sprawl", "left_fbem"), (-1, 1)):
        data = posed(model, 90, 0)
        hinge = model.joint(joint)
        # Half as strong again as the servo, against it.
        data.qfrc_applied[hinge.dofadr[0]] = sign * 1.5 * model.actuator(joint).forcerange[1]
        for _ in range(1200):
            mujoco.mj_step(model, data)
        beyond = sign * (data.joint(joint).qpos[0] - hinge.range[(sign + 1) // 2])
        assert -0.1 < np.degrees(beyond) < 0.5
        gaps = [mujoco.mj_geomDistance(model, data, body, geom, 0.02, None) for geom in left]
        assert min(gaps) > 0.003


def test_legs_pressed_together_at_the_end_of_the_sprawl_do_not_overlap_further():
    model = compiled(RobotConfig())
    data = posed(model, 180, 0)
    nubs = (model.geom("left_nub").id, model.geom("right_nub").id)
    for side in SIDES:
        data.act[model.actuator(f"{side}_sprawl").actadr[0]] = np.pi
        # Half the servo's torque: so hard the wheels pressed against a lintel of 124 mm.
        data.qfrc_applied[model.joint(f"{side}_sprawl").dofadr[0]] = 4.0
    for _ in range(400):
        mujoco.mj_step(model, data)
    assert -0.7 < mujoco.mj_geomDistance(model, data, *nubs, 0.02, None) * 1e3 < -0.46


def test_a_joint_set_free_far_from_its_target_turns_no_faster_than_its_motor():
    config = RobotConfig()
    model = compiled(config)
    data = posed(model, 0, 0)
    data.act[model.actuator("left_sprawl").actadr[0]] = np.radians(170)
    fastest = 0.0
    for _ in range(200):
        mujoco.mj_step(model, data)
        fastest = max(fastest, abs(data.joint("left_sprawl").qvel[0]))
    most = config.sprawl_torque_nm / config.sprawl_damping_nmsprad
    assert 0.5 * most < fastest < 1.1 * most


def on_floor(config, sprawl=48.0, fbem=0.0):
    """A robot standing on a plane, its servos holding the pose."""
    spec = mujoco.MjSpec()
    add_robot(spec, config)
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 0.1], contype=0, conaffinity=1
    )
    model = spec.compile()
    data = posed(model, sprawl, fbem)
    data.qpos[2] = kinematics.standing_height_mm(sprawl, fbem, config.gear) * 1e-3
    for side in SIDES:
        data.act[model.actuator(f"{side}_sprawl").id] = np.deg2rad(sprawl)
        data.act[model.actuator(f"{side}_fbem").id] = np.deg2rad(fbem)
    return model, data


@pytest.mark.parametrize("gear", ["wheels", "both"])
def test_servo_targets_of_both_sides_stay_equal_and_carriers_parallel_under_load(gear):
    config = RobotConfig(gear=gear)
    model, data = on_floor(config)
    rng = np.random.default_rng(0)
    worst = 0.0
    for step in range(round(20.0 / config.physics_step_s)):
        if step % round(0.2 / config.physics_step_s) == 0:
            rate = {"sprawl": rng.uniform(-1, 1), "fbem": rng.uniform(-1, 1)}
            drive = rng.uniform(-1, 1)
            for i in range(model.nu):
                part = model.actuator(i).name.split("_")[1]
                data.ctrl[i] = rate.get(part, drive) * model.actuator_ctrlrange[i, 1]
        mujoco.mj_step(model, data)
        for side in SIDES:
            tilt = data.joint(f"{side}_fbem").qpos + data.joint(f"{side}_carrier").qpos
            worst = max(worst, abs(np.rad2deg(tilt[0])))
        for part in ("sprawl", "fbem"):
            left, right = (data.act[model.actuator(f"{s}_{part}").id] for s in SIDES)
            assert left == right
    assert 0.0 < worst < 0.2  # degrees; the project's own bound


def test_mirrored_commands_give_mirrored_motion():
    # Each side gets commands of its own, so that the robot turns, rolls and drifts sideways.
    config = RobotConfig()
    plan = np.random.default_rng(3).uniform(-1, 1, (8, 2, 3))
    paths = []
    for swap in (False, True):
        model, data = on_floor(config)
        sides = ("right", "left") if swap else ("left", "right")
        path = []
        for commands in plan:
            for side, (speed, fbem, sprawl) in zip(sides, commands, strict=True):
                for name, rate in (
                    *((name, speed) for name in wheel_names(config) if name.startswith(side)),
                    (f"{side}_fbem", fbem),
                    (f"{side}_sprawl", sprawl),
                ):
                    servo = model.actuator(name).id
                    data.ctrl[servo] = rate * model.actuator_ctrlrange[servo, 1]
            mujoco.mj_step(model, data, round(0.1 / config.physics_step_s))
            joints = [
                data.joint(f"{side}_{part}").qpos[0]
                for side in sides
                for part in ("sprawl", "fbem", "carrier", "front", "rear")
            ]
            path.append([*data.qpos[:7], *joints])
        paths.append(np.array(path))
    mirror = np.ones(paths[0].shape[1])
    # Across the mid-plane y changes sign, and so do the rotations about x and z.
    mirror[[1, 4, 6]] = -1.0
    assert np.abs(paths[0][:, [1, 4, 6]]).max(axis=0).min() > 0.002  # it did turn and drift
    # Contacts are found and solved in another order: 1e-16 grows to some 1e-9 in 0.8 s.
    np.testing.assert_allclose(paths[0], paths[1] * mirror, atol=1e-6)


@pytest.mark.parametrize(
    "wrong",
    [
        {"gear": "tracks"},
        {"friction": -0.1},
        {"friction": float("nan")},
        {"mass_kg": 0.0},
        {"physics_step_s": 0.1},
        {"constraint_time_s": 0.002},
        {"constraint_time_s": float("inf")},
        {"sprawl_torque_nm": 0.0},
    ],
)
def test_a_robot_configuration_out_of_range_is_refused_by_name(wrong):
    with pytest.raises(ConfigError, match=next(iter(wrong))):
        RobotConfig(**wrong)
