"""The world around the robot: floor, obstacle blocks, light and camera, compiled to one model."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import hashlib
from functools import cache

import mujoco

from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import POST_HEIGHT_M, POST_THICKNESS_M, Obstacle, blocks
from surmount.rstar.robot.model import add_robot
from surmount.rstar.robot.parts import WORLD_BIT

FLOOR_THICKNESS_M = 0.04
"""Thickness of the floor; nothing lies below."""

CONTACT_IMPEDANCE = (0.95, 0.99, 0.001, 0.5, 2.0)
"""MuJoCo's ``solimp``: with its defaults (0.9 to 0.95) wedged wheels sank 16 mm into walls (ADR
20)."""

CAMERA = "track"
"""Name of the usual camera."""

_DIAGONAL = ((-0.36, -0.56, 0.22), (0.84, -0.54, 0.0, 0.193, 0.300, 0.934), 36.0)
CAMERAS = {
    CAMERA: _DIAGONAL,
    "side": ((0.0, -0.62, 0.06), (1.0, 0.0, 0.0, 0.0, 0.096, 0.995), 40.0),
    "front": ((0.62, 0.0, 0.30), (0.0, 1.0, 0.0, -0.436, 0.0, 0.900), 38.0),
    "top": ((0.0, 0.0, 0.75), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0), 42.0),
}
"""Cameras that go along with the robot, by name: position relative to its base in m, image axes
right and up, vertical field of view in degrees."""

COURSE_CAMERA = "course"
"""Name of the camera that stands still and shows the way from the start to the target."""


def build_model(obstacle: Obstacle, config: EnvConfig) -> mujoco.MjModel:
    """Compile robot and course, see :func:`describe`."""
    return describe(obstacle, config).compile()


@cache
def model_hash(obstacle: Obstacle, config: EnvConfig) -> str:
    """Return the SHA-256 of robot and course as MuJoCo's XML, to tell results of two models apart.

    Settings say what differs between experiments of one version of Surmount. The model says what
    has changed between versions: a stop, a mass, how contacts give way.
    """
    return hashlib.sha256(describe(obstacle, config).to_xml().encode()).hexdigest()


def describe(obstacle: Obstacle, config: EnvConfig) -> mujoco.MjSpec:
    """Describe robot and course.

    Parameters
    ----------
    obstacle
        Family of obstacles; its blocks are mocap bodies, in the order of
        :func:`~surmount.rstar.course.obstacles.blocks`, whose positions set the variant.
    config
        Course and robot.
    """
    spec = mujoco.MjSpec()
    spec.modelname = f"rstar-{obstacle.name}"
    add_robot(spec, config.robot)
    _add_materials(spec)
    _add_floor(spec, config)
    for block in blocks(obstacle, config.course):
        body = spec.worldbody.add_body(name=block.name, mocap=True)
        _add_box(body, block.name, block.half_size_m, "obstacle")
    if obstacle.name == "step":
        spec.material("obstacle").rgba[3] = 1.0
    if obstacle.name == "low-entrance":
        _add_posts(spec, config)
    _add_target_line(spec, config)
    _add_view(spec)
    for geom in spec.geoms:
        if geom.contype or geom.conaffinity:
            geom.solref = [config.robot.constraint_time_s, 1.0]
            geom.solimp = CONTACT_IMPEDANCE
    return spec


def _add_materials(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.86, 0.91, 0.96],
        rgb2=[0.55, 0.66, 0.78],
        width=256,
        height=256,
    )
    spec.add_texture(
        name="floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.74, 0.77, 0.80],
        rgb2=[0.66, 0.69, 0.73],
        width=256,
        height=256,
    )
    floor = spec.add_material(name="floor", reflectance=0.0, specular=0.1, shininess=0.1)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "floor"
    floor.texuniform = True
    floor.texrepeat = [10, 10]
    # Walls and lintel let the robot be seen through them.
    spec.add_material(name="obstacle", rgba=[0.30, 0.50, 0.68, 0.5], specular=0.2, shininess=0.3)
    spec.add_material(name="post", rgba=[0.40, 0.43, 0.48, 0.6], specular=0.2, shininess=0.3)
    spec.add_material(name="target", rgba=[0.20, 0.62, 0.35, 1.0], specular=0.1)


def _add_box(
    body: mujoco.MjsBody,
    name: str,
    half_size_m: tuple[float, float, float],
    material: str,
    pos: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> None:
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=half_size_m,
        pos=pos,
        material=material,
        contype=0,
        conaffinity=WORLD_BIT,
    )


def _add_floor(spec: mujoco.MjSpec, config: EnvConfig) -> None:
    course = config.course
    half_length = (course.floor_rear_m + course.floor_front_m) / 2
    _add_box(
        spec.worldbody,
        "floor",
        (half_length, course.floor_half_width_m, FLOOR_THICKNESS_M / 2),
        "floor",
        ((course.floor_front_m - course.floor_rear_m) / 2, 0.0, -FLOOR_THICKNESS_M / 2),
    )


def _add_posts(spec: mujoco.MjSpec, config: EnvConfig) -> None:
    course = config.course
    lateral = course.floor_half_width_m - POST_THICKNESS_M / 2
    half_size = (0.02, POST_THICKNESS_M / 2, POST_HEIGHT_M / 2)
    for name, y in (("left", lateral), ("right", -lateral)):
        for place, x in (("front", 0.02), ("rear", course.obstacle_length_m - 0.02)):
            _add_box(
                spec.worldbody,
                f"{name}_{place}_post",
                half_size,
                "post",
                (x, y, POST_HEIGHT_M / 2),
            )


def _add_target_line(spec: mujoco.MjSpec, config: EnvConfig) -> None:
    course = config.course
    spec.worldbody.add_geom(
        name="target",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.004, course.floor_half_width_m, 0.0004],
        pos=[course.target_m, 0.0, 0.0],
        material="target",
        contype=0,
        conaffinity=0,
        group=2,
    )


def _add_view(spec: mujoco.MjSpec) -> None:
    spec.visual.global_.offwidth = 1920
    spec.visual.global_.offheight = 1080
    spec.visual.quality.shadowsize = 2048
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.25, 0.25, 0.25]
    spec.visual.headlight.specular = [0.1, 0.1, 0.1]
    spec.visual.map.znear = 0.01
    spec.stat.extent = 1.0
    spec.stat.center = [0.0, 0.0, 0.05]
    spec.worldbody.add_light(
        pos=[-0.5, -0.8, 1.6],
        dir=[0.35, 0.45, -1.0],
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        diffuse=[0.65, 0.65, 0.62],
        specular=[0.2, 0.2, 0.2],
        castshadow=True,
    )
    base = spec.body("base")
    for name, (position_m, axes, field_deg) in CAMERAS.items():
        base.add_camera(
            name=name,
            mode=mujoco.mjtCamLight.mjCAMLIGHT_TRACK,
            pos=position_m,
            xyaxes=axes,
            fovy=field_deg,
        )
    spec.worldbody.add_camera(
        name=COURSE_CAMERA,
        pos=[-0.22, -0.85, 0.38],
        xyaxes=[0.959, -0.282, 0.0, 0.0985, 0.335, 0.937],
        fovy=40,
    )
