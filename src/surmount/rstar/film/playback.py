"""Motions in a window, over and over, in real time."""

from __future__ import annotations

import time
from collections.abc import Sequence

from surmount.rstar.course.window import Window
from surmount.rstar.film.motion import Motion, Puppet

HOLD_S = 1.5
"""How long the end of a motion stays in view, in s."""
STEP_S = 0.02
"""What an arrow key moves, in s of the motion."""
REDRAW_S = 1 / 60
SPACE, RIGHT, LEFT = 32, 262, 263
"""Codes of keys: pause, a step on, a step back."""


class Transport:
    """Which moment of which motion to show: runs in real time, pauses, steps, begins again.

    Parameters
    ----------
    motions
        Shown one after the other, and then again from the first.
    speed
        Speed against real time.
    """

    def __init__(self, motions: Sequence[Motion], speed: float) -> None:
        self._motions = motions
        self._speed = speed
        self._index = 0
        self._time_s = 0.0
        self._paused = False

    def press(self, key: int) -> None:
        """Take a key: space pauses and goes on, right and left pause and step."""
        if key == SPACE:
            self._paused = not self._paused
        elif key in (RIGHT, LEFT):
            self._paused = True
            step_s = STEP_S if key == RIGHT else -STEP_S
            self._time_s = min(max(self._time_s + step_s, 0.0), self.motion.duration_s)

    def advance(self, elapsed_s: float) -> None:
        """Let so much real time pass, in s."""
        if self._paused:
            return
        self._time_s += elapsed_s * self._speed
        if self._time_s > self.motion.duration_s + HOLD_S * self._speed:
            self._index = (self._index + 1) % len(self._motions)
            self._time_s = 0.0

    @property
    def motion(self) -> Motion:
        """The motion that is shown."""
        return self._motions[self._index]

    @property
    def time_s(self) -> float:
        """Its moment that is shown, in s."""
        return min(self._time_s, self.motion.duration_s)

    @property
    def caption(self) -> tuple[str, str]:
        """What is shown, as two columns of lines."""
        motion = self.motion
        clock = f"{self.time_s:.2f} s{' (paused)' if self._paused else ''}"
        rows = {
            motion.obstacle.name: f"{motion.size_mm:g} mm",
            "shown": motion.caption,
            "keys": "space: pause, arrows: step",
            "time": clock,
        }
        if self.time_s >= motion.duration_s - 1e-9:
            rows["end"] = motion.outcome
        return "\n".join(rows), "\n".join(rows.values())


def play(motions: Sequence[Motion], speed: float = 1.0) -> None:
    """Show motions on one course in a window until it is closed.

    Parameters
    ----------
    motions
        Of one obstacle family and configuration.
    speed
        Speed against real time.

    Raises
    ------
    SurmountError
        If no window can be opened here.
    """
    transport = Transport(motions, speed)
    shown = transport.motion
    puppet = Puppet(shown)
    window = Window(puppet.model, puppet.at(0.0), REDRAW_S, transport.press)
    now = time.monotonic()
    try:
        while window.is_open:
            if transport.motion is not shown:
                shown = transport.motion
                puppet.follow(shown)
            puppet.at(transport.time_s)
            window.sync(transport.caption)
            before, now = now, time.monotonic()
            transport.advance(now - before)
    finally:
        window.close()
