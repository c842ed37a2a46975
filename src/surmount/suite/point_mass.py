"""The point mass with a gate, as published: dynamics and rewards in free functions.

P. Klink et al., "Curriculum reinforcement learning via constrained optimal transport" (ICML 2022),
after P. Klink et al., "Self-paced deep reinforcement learning" (NeurIPS 2020). A mass is pushed
over a plane to a goal behind a wall with a gate, whose position and width are the task. All numbers
are the publications', as their authors' code has them.
"""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray

START = (0.0, 0.0, 3.0, 0.0)
"""x, its velocity, y, its velocity at the beginning."""
GOAL = (0.0, -3.0)
"""x and y of the goal."""
GOAL_DISTANCE = 6.0
"""From the start to the goal."""
SUCCESS_DISTANCE = 0.25
"""An episode succeeds if it ends nearer to the goal."""
WALL = 4.0
"""Positions are kept within plus and minus this."""
STRONGEST_ACTION = 10.0
"""Actions are kept within plus and minus this, on either axis."""
FORCE = 1.5
"""Acceleration by an action of one."""
NOISE = 0.05
"""Standard deviation of the acceleration's noise in each physics step."""
PHYSICS_STEP_S = 0.01
"""Length of a physics step of the dynamics."""
PHYSICS_STEPS = 10
"""Ticks for which an action is held."""
EPISODE_STEPS = 100
"""Steps after which an episode is cut."""
DECAY = 0.6
"""Of the reward exp(−this · distance)."""
LOWER, UPPER = (-4.0, 0.5), (4.0, 8.0)
"""Range of the gate's position and width."""
TARGETS = ((3.0, 0.5), (-3.0, 0.5))
"""Position and width of the gates that the publication wants learnt."""
TARGET_DEVIATION = 0.01
"""Standard deviation of its target tasks around these, on both axes."""
DISCOUNT = 0.95
"""γ of the publication's returns."""
CURROT_RETURN = (6.0, 6.3)
"""What CURROT ends at there: mean discounted return on the target tasks, read off the figure in its
authors' repository."""


def push(
    state: FloatArray, actions: FloatArray, task: FloatArray, rng: np.random.Generator
) -> tuple[FloatArray, BoolArray]:
    """Return the states after an action is held for :data:`PHYSICS_STEPS`, and who hit the wall.

    Parameters
    ----------
    state
        x, its velocity, y, its velocity; ``(env, 4)``.
    actions
        ``(env, 2)``.
    task
        Position and width of the gate, ``(env, 2)``.
    rng
        Draws the noise, the same numbers whoever hits the wall.
    """
    actions = np.clip(actions, -STRONGEST_ACTION, STRONGEST_ACTION)
    noise = rng.normal(0.0, NOISE, (PHYSICS_STEPS, len(state), 2))
    place, velocity = state[:, 0::2].copy(), state[:, 1::2].copy()
    crashed: BoolArray = np.zeros(len(state), dtype=np.bool_)
    for part in range(PHYSICS_STEPS):
        new = np.clip(place + PHYSICS_STEP_S * velocity, -WALL, WALL)
        before, after = place[:, 1], new[:, 1]
        crossing = ((before >= 0) & (after < 0)) | ((before <= 0) & (after > 0))
        velocity = np.where(
            crashed[:, None], 0.0, velocity + PHYSICS_STEP_S * (FORCE * actions + noise[part])
        )
        if crossing.any():
            share = before / np.where(crossing, before - after, 1.0)
            crossed_at = share * new[:, 0] + (1.0 - share) * place[:, 0]
            hit = crossing & ~crashed & (np.abs(crossed_at - task[:, 0]) > 0.5 * task[:, 1])
            new[hit, 0], new[hit, 1], velocity[hit] = crossed_at[hit], 0.0, 0.0
            crashed |= hit
        place = new
    moved = np.empty_like(state)
    moved[:, 0::2], moved[:, 1::2] = place, velocity
    return moved, crashed


def distance_to_goal(state: FloatArray) -> FloatArray:
    """Return the distance to the goal, ``(env,)``."""
    return np.hypot(state[:, 0] - GOAL[0], state[:, 2] - GOAL[1])


def rewards(distance: FloatArray) -> FloatArray:
    """Return the reward of a step that ends at such a distance, of its shape."""
    return np.exp(-DECAY * distance)


def right_groups(tasks: FloatArray) -> tuple[tuple[str, ...], IntArray]:
    """Return the groups that the way through the gate makes: straight on, left and right.

    Parameters
    ----------
    tasks
        Position and width, ``(task, 2)``.

    Returns
    -------
    tuple
        Names, and the group of each task, ``(task,)``.
    """
    aside = np.abs(tasks[:, 0]) > 0.5 * tasks[:, 1]
    group = np.where(aside, np.where(tasks[:, 0] < 0, 1, 2), 0)
    return ("straight", "left", "right"), group.astype(np.int64)
