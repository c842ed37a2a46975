"""Progress that a person can follow: on a narrow terminal, and in a file from the first moment."""

from __future__ import annotations

import io

from rich.console import Console

from surmount.workflow.display import RunDisplay
from surmount.workflow.executor import StageEvent
from surmount.workflow.monitor import Progress


def _shown(tmp_path, *, width, terminal):
    stream = io.StringIO()
    console = Console(file=stream, width=width, force_terminal=terminal, legacy_windows=False)
    with RunDisplay(console, tmp_path / "run.log") as display:
        display.stage_started("curriculum/network-0")
        display.listen(
            StageEvent(
                stage="curriculum/network-0",
                told=Progress(
                    label="level 1",
                    done=500,
                    planned=1000,
                    unit="steps",
                    values={"reward": 0.25, "success": 0.5},
                ),
            )
        )
        if terminal:
            display._bars.refresh()
    return stream.getvalue()


def test_at_fifty_columns_a_stage_is_one_line_with_its_share(tmp_path):
    shown = _shown(tmp_path, width=50, terminal=True)
    lines = [line for line in shown.splitlines() if "curriculum/network-0" in line]
    assert any("50 %" in line for line in lines)
    assert "reward" not in shown


def test_a_file_has_a_line_as_soon_as_a_stage_begins_and_its_numbers(tmp_path):
    shown = _shown(tmp_path, width=80, terminal=False)
    assert shown.splitlines()[0] == "curriculum/network-0: begins"
    assert "500 of 1,000 steps" in shown
    assert "success 0.5" in shown
