"""``surmount view``: a policy, a manoeuvre or logged trials in MuJoCo's viewer."""

from __future__ import annotations

from typing import Annotated

import tyro

from surmount.cli.showing import Shown


def view(
    shown: tyro.conf.OmitArgPrefixes[Shown],
    *,
    speed: Annotated[float, tyro.conf.arg(metavar="FACTOR")] = 1.0,
) -> int:
    """Show the robot in a window, over and over, until it is closed; needs a display.

    The mouse turns and moves the view; space pauses, the arrow keys step.

    Args:
        shown: What to show.
        speed: Speed against real time: 0.25 is slow motion.
    """
    from surmount.cli.motions import shown_motions
    from surmount.rstar.film.playback import play
    from surmount.rstar.robot.config import require_range

    require_range("speed", speed, 0.001, 1000.0)
    play(shown_motions(shown), speed)
    return 0
