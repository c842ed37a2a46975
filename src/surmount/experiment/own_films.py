"""A network on somebody's own environment, drawn by the environment's own ``render``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError, InputError, cause
from surmount.envs.making import time_limit
from surmount.envs.observations import stacked
from surmount.envs.own_family import OwnFamily
from surmount.envs.screen import drawn_off_screen
from surmount.envs.task_env import TaskEnv
from surmount.envs.video import Frame
from surmount.experiment.origin import NO_CHANGES, config_of, home
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
        One after the reset and one after each step, or each so many, of even width and height;
        always the last.
    is_success
        How it ended.
    steps
        Its length.
    step_s
        Seconds of a step.
    """

    task: dict[str, Any]
    frames: list[Frame]
    is_success: bool
    steps: int
    step_s: float


def own_network(
    source: Path,
    *,
    task: str | None,
    stage: str | None,
    network: int,
    changes: Mapping[str, Any] = NO_CHANGES,
) -> tuple[Path, OwnFamily, Any] | None:
    """Return a network, its family and the settings, where that is anybody's; else ``None``.

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
    changes
        The user's overrides, by dotted keys of the configuration.

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
    config = config_of(
        str(source), run=run, network=Snapshot.load(source), task=task, changes=changes
    )
    family = config.family
    return (source, family, config.env) if isinstance(family, OwnFamily) else None


def film_network(
    path: Path,
    family: OwnFamily,
    *,
    variants: Sequence[FloatArray] = (),
    seed: int = 0,
    deterministic: bool = False,
    settings: Any = None,
    most_frames: int | None = None,
    most_px: int | None = None,
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
    settings
        The family's settings; its defaults if None.
    most_frames
        Frames that the longest possible episode may have: so many steps are passed over between
        frames; all are drawn if None.
    most_px
        Width and height that larger frames are reduced to; as they are if None.

    Raises
    ------
    InputError
        If the environment draws no frames, or the network does not fit it.
    """
    env = family.make(settings)
    every = 1 if most_frames is None else -(-time_limit(env) // most_frames)
    try:
        actor = make_actor(Snapshot.load(path), env.observation_space, env.action_space)
        for task in variants or (env.space.variants[-1],):
            act = actor.begin(1, np.random.default_rng(seed), deterministic=deterministic)
            observation, info = env.reset(seed=seed, options={"variant": task})
            _let_draw(env)  # a wrapper may have chosen another environment for the task
            frames = [_frame(env, most_px)]
            ended, steps = False, 0
            while not ended:
                actions = act(stacked([observation], env.observation_space))
                observation, _, terminated, truncated, info = env.step(actions[0])
                ended, steps = terminated or truncated, steps + 1
                if ended or steps % every == 0:
                    frames.append(_frame(env, most_px))
            yield FilmedEpisode(
                task=dict(env.space.named(env.task)),
                frames=frames,
                is_success=bool(info["is_success"]),
                steps=steps,
                step_s=env.step_s,
            )
    finally:
        env.close()


def can_draw(family: OwnFamily, settings: Any) -> bool:
    """Whether an environment says that it draws frames."""
    env = family.make(settings)
    try:
        return env.render_mode == FRAMES or _says_so(env)
    finally:
        env.close()


def _says_so(env: TaskEnv) -> bool:
    return FRAMES in (env.unwrapped.metadata.get("render_modes") or ())


def _let_draw(env: TaskEnv) -> None:
    """Ask an environment that was made without drawing to draw, as far as it can."""
    inner: Any = env.unwrapped
    if env.render_mode == FRAMES:
        return
    if not _says_so(env):
        raise InputError(
            "The environment does not say that it draws frames.",
            remedy=f"Let its `metadata` name the render mode {FRAMES}, and make it with "
            f'render_mode="{FRAMES}".',
        )
    inner.render_mode = FRAMES


def _frame(env: TaskEnv, most_px: int | None) -> Frame:
    try:
        with drawn_off_screen():
            drawn: Any = env.render()
    except Exception as error:  # it is the user's, or a machine's that cannot draw
        raise InputError(
            f"The environment's `render` fails ({cause(error)}).",
            remedy="Call it by itself first; without a display, MuJoCo needs EGL (libegl1).",
        ) from error
    if not isinstance(drawn, np.ndarray) or drawn.ndim != 3:
        raise InputError(
            f"The environment's `render` returned {type(drawn).__name__}, not a picture.",
            remedy=f'Make it with render_mode="{FRAMES}".',
        )
    frame = np.asarray(drawn[:, :, :3], dtype=np.uint8)
    height, width = frame.shape[:2]
    share = 1.0 if most_px is None else min(1.0, most_px / max(height, width))
    # Even sides, as films must have them.
    across, down = (max(2, int(side * share) // 2 * 2) for side in (width, height))
    if share < 1.0:
        return np.asarray(Image.fromarray(frame).resize((across, down), Image.Resampling.BOX))
    return np.ascontiguousarray(frame[:down, :across])
