"""The solids of RSTAR: materials, and geoms that touch the world or only show and weigh."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import mujoco

SIDES = {"left": 1.0, "right": -1.0}
"""Sides of the robot and the sign of their lateral coordinate."""

ROBOT_BIT, WORLD_BIT = 1, 1
"""Robot geoms have contype 1 and conaffinity 0, everything else 0 and 1: they meet only others."""


def add_materials(spec: mujoco.MjSpec) -> None:
    """Add the materials that the robot's geoms name."""
    colours = {
        "shell": (0.93, 0.46, 0.13, 1.0),
        "metal": (0.62, 0.65, 0.70, 1.0),
        "carrier": (0.16, 0.20, 0.27, 1.0),
        "tyre": (0.09, 0.09, 0.10, 1.0),
        "hub": (0.80, 0.82, 0.85, 1.0),
        "wheg": (0.85, 0.16, 0.20, 1.0),
    }
    for name, colour in colours.items():
        spec.add_material(name=name, rgba=colour, specular=0.4, shininess=0.5, reflectance=0.0)


def solid(
    body: mujoco.MjsBody,
    name: str,
    kind: mujoco.mjtGeom,
    *,
    size: tuple[float, ...],
    pos: tuple[float, float, float],
    material: str,
    friction: float,
    mass: float = 0.0,
    quat: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0),
) -> None:
    """Add a geom that touches the world; sizes and positions in m."""
    body.add_geom(
        name=name,
        type=kind,
        size=size,
        pos=pos,
        quat=quat,
        material=material,
        mass=mass,
        friction=[friction, 0.005, 0.0001],
        priority=1,
        condim=3,
        contype=ROBOT_BIT,
        conaffinity=0,
    )


def visual(
    body: mujoco.MjsBody,
    kind: mujoco.mjtGeom,
    *,
    size: tuple[float, ...],
    pos: tuple[float, float, float],
    material: str,
    mass: float = 0.0,
    quat: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0),
) -> None:
    """Add a geom that touches nothing: for the eye, and to carry its mass."""
    body.add_geom(
        type=kind,
        size=size,
        pos=pos,
        quat=quat,
        material=material,
        mass=mass,
        contype=0,
        conaffinity=0,
        group=2,
    )
