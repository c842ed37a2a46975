"""A network on somebody's own environment, drawn by the environment's own ``render``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError, InputError
from surmount.envs.observations import stacked
from surmount.envs.own_family import OwnFamily
from surmount.envs.task_env import TaskEnv
from surmount.envs.video import Frame
from surmount.experiment.origin import config_of, home
from surmount.learn.choice import make_actor
from surmount.learn.snapshot import Snapshot
from surmount.workflow.run_folder import open_run
from surmount.workflow.run_layout import (
    CONTROL,
    CURRICULUM,
    INITIATION,
    NETWORK_FILE,
    RUN,
    per_network,
)

FRAMES = "rgb_array"
"""Mode in which environments return what they draw."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmedEpisode:
    """One episode as it was drawn.

    Attributes
    ----------
    task
        Its task by name.
    frames
        One after the reset and one after each step, of even width and height.
    is_success
        How it ended.
    step_s
        Seconds from frame to frame.
    """

    task: dict[str, Any]
    frames: list[Frame]
    is_success: bool
    step_s: float


def own_network(
    source: Path, *, task: str | None, stage: str | None, network: int
) -> tuple[Path, OwnFamily] | None:
    """Return a network and its family, where that is anybody's environment; else ``None``.

    Parameters
    ----------
    source
        A run's folder, or a ``network.safetensors``.
    task
        Family of a network that does not tell what it was trained on.
    stage
        Of a run; the furthest trained network if None.
    network
        Number of the network of a run.

    Raises
    ------
    ConfigError
        If the run has no such network.
    """
    if (source / RUN).is_file():
        run = open_run(source)
        if ":" not in run.task:
            return None
        kinds = (CURRICULUM, CONTROL, INITIATION)
        wanted = [stage] if stage else [per_network(kind, network) for kind in kinds]
        found = [
            name for name in wanted if name in run.stages and NETWORK_FILE in run.stages[name].files
        ]
        if not found:
            raise ConfigError(
                f"{source} has no trained network {wanted[0]}.",
                remedy="Give --stage of a finished training, such as initiation/network-0.",
            )
        source = run.stages[found[0]].path(NETWORK_FILE)
    elif source.suffix != ".safetensors" or not source.is_file():
        return None
    run, _ = home(source)
    config = config_of(str(source), run=run, network=Snapshot.load(source), task=task)
    family = config.family
    return (source, family) if isinstance(family, OwnFamily) else None


def film_network(
    path: Path,
    family: OwnFamily,
    *,
    variants: Sequence[FloatArray] = (),
    seed: int = 0,
    deterministic: bool = False,
) -> Iterator[FilmedEpisode]:
    """Draw one episode of a network on each variant.

    Parameters
    ----------
    path
        A ``network.safetensors``.
    family
        The environment's.
    variants
        Tasks, each of shape ``(parameter,)``; the last of the grid if none are given.
    seed
        Of episodes and actions.
    deterministic
        Whether to act without drawing.

    Raises
    ------
    InputError
        If the environment draws no frames, or the network does not fit it.
    """
    env = family.make()
    try:
        _let_draw(env)
        actor = make_actor(Snapshot.load(path), env.observation_space, env.action_space)
        for task in variants or (env.space.variants[-1],):
            act = actor.begin(1, np.random.default_rng(seed), deterministic=deterministic)
            observation, info = env.reset(seed=seed, options={"variant": task})
            frames = [_frame(env)]
            ended = False
            while not ended:
                actions = act(stacked([observation], env.observation_space))
                observation, _, terminated, truncated, info = env.step(actions[0])
                frames.append(_frame(env))
                ended = terminated or truncated
            yield FilmedEpisode(
                task=dict(env.space.named(env.task)),
                frames=frames,
                is_success=bool(info["is_success"]),
                step_s=env.step_s,
            )
    finally:
        env.close()


def _let_draw(env: TaskEnv) -> None:
    """Ask an environment that was made without drawing to draw, as far as it can."""
    inner: Any = env.unwrapped
    if env.render_mode == FRAMES:
        return
    if FRAMES not in (inner.metadata.get("render_modes") or ()):
        raise InputError(
            "The environment does not say that it draws frames.",
            remedy=f"Let its `metadata` name the render mode {FRAMES}, and make it with "
            f'render_mode="{FRAMES}".',
        )
    inner.render_mode = FRAMES


def _frame(env: TaskEnv) -> Frame:
    drawn: Any = env.render()
    if not isinstance(drawn, np.ndarray) or drawn.ndim != 3:
        raise InputError(
            f"The environment's `render` returned {type(drawn).__name__}, not a picture.",
            remedy=f'Make it with render_mode="{FRAMES}".',
        )
    height, width = (side - side % 2 for side in drawn.shape[:2])  # as films must have them
    return np.ascontiguousarray(drawn[:height, :width, :3], dtype=np.uint8)
