"""What a running experiment shows: bars on a terminal, plain lines elsewhere, and a log file."""

from __future__ import annotations

import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Column

from surmount.core.printing import escaped
from surmount.workflow.executor import StageEvent
from surmount.workflow.monitor import Progress as StageProgress
from surmount.workflow.store import Artefact, output_errors

WIDE = 90
"""Characters from which bars have room for numbers beside them."""
PLAIN_INTERVAL_S = 20.0
"""Without a terminal, each stage prints a progress line at most this often."""


class RunDisplay:
    """Watches a run, for people.

    Parameters
    ----------
    console
        Where to show it.
    log
        File that every sentence is appended to, with its time.
    """

    def __init__(self, console: Console, log: Path) -> None:
        self._console = console
        with output_errors(log.parent):
            log.parent.mkdir(parents=True, exist_ok=True)
            self._log = log.open("a", encoding="utf-8")
        wide = console.width >= WIDE
        columns = (
            (
                TextColumn("{task.description}"),
                BarColumn(bar_width=24),
                MofNCompleteColumn(),
                TextColumn("{task.fields[rate]}"),
                TimeRemainingColumn(compact=True),
                TextColumn("[dim]{task.fields[values]}"),
            )
            if wide
            else (
                TextColumn("{task.description}", table_column=Column(no_wrap=True, max_width=28)),
                TaskProgressColumn("{task.percentage:>3.0f} %"),
                TimeRemainingColumn(compact=True),
            )
        )
        # In a notebook bars are boxes that fill a page: it gets lines, as a log file does.
        self._lively = console.is_terminal and not console.is_jupyter
        self._bars = Progress(*columns, console=console, disable=not self._lively)
        self._wide = wide
        self._tasks: dict[str, TaskID] = {}
        self._begun: dict[str, tuple[float, int]] = {}
        self._told_at: dict[str, float] = {}

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bars.stop()
        self._log.close()

    def listen(self, event: StageEvent) -> None:
        """Take what a running stage tells."""
        if isinstance(event.told, str):
            self._say(event.stage, event.told)
        else:
            self._advance(event.stage, event.told)

    def note(self, sentence: str) -> None:
        """Say something about the run as a whole."""
        self._say("run", sentence)

    def stage_reused(self, artefact: Artefact) -> None:
        """Say that a stage was finished before."""
        self._say(artefact.stage, "kept from an earlier call: every file fits its hash")

    def stage_outdated(self, stage: str, folders: Sequence[Path]) -> None:
        """Say that a stage is run though it was finished, and where that is."""
        self._say(
            stage,
            "was finished before, but not from what it is made from now: it is run again, and "
            f"stays in {', '.join(map(str, folders))}",
        )

    def stage_started(self, stage: str) -> None:
        """Begin a bar."""
        self._tasks[stage] = self._bars.add_task(escape(stage), total=None, rate="", values="")
        self._say(stage, "begins", quietly=self._lively)

    def stage_finished(self, artefact: Artefact, seconds: float) -> None:
        """End a bar."""
        stage = artefact.stage
        if stage in self._tasks:
            self._bars.remove_task(self._tasks.pop(stage))
        self._say(stage, f"finished in {seconds:.0f} s")

    def stage_lost(self, stage: str, *, again: bool) -> None:
        """End the bar of a stage whose worker was lost."""
        if stage in self._tasks:
            self._bars.remove_task(self._tasks.pop(stage))
        then = "it is run again from its last checkpoint" if again else "it is given up"
        self._say(stage, f"its worker was killed or lost; {then}")

    def _advance(self, stage: str, progress: StageProgress) -> None:
        now = time.monotonic()
        began, done_then = self._begun.setdefault(stage, (now, progress.done))
        elapsed = now - began
        rate = (progress.done - done_then) / elapsed if elapsed > 0 else 0.0
        values = ", ".join(f"{name} {value:.3g}" for name, value in progress.values.items())
        rate_text = f"{rate:,.0f} {progress.unit}/s" if rate else ""
        planned = progress.planned
        if stage in self._tasks:
            self._bars.update(
                self._tasks[stage],
                description=escape(stage)
                + (f" [dim]{escape(progress.label)}" if self._wide else ""),
                completed=progress.done,
                total=None if planned is None else max(planned, progress.done),
                rate=rate_text,
                values=escape(values),
            )
        if not self._lively and (now - self._told_at.get(stage, float("-inf")) >= PLAIN_INTERVAL_S):
            self._told_at[stage] = now
            count = f"{progress.done:,}" + ("" if planned is None else f" of {planned:,}")
            parts = [progress.label, f"{count} {progress.unit}", rate_text]
            if planned is not None and rate:
                parts.append(f"{max(0, planned - progress.done) / rate:,.0f} s left")
            parts.append(values)
            line = f"{stage}: {', '.join(part for part in parts if part)}"
            self._console.print(escaped(line), highlight=False, markup=False, soft_wrap=True)

    def _say(self, stage: str, sentence: str, *, quietly: bool = False) -> None:
        sentence = escaped(sentence)
        moment = datetime.now(UTC).isoformat(timespec="seconds")
        self._log.write(f"{moment} {stage}: {sentence}\n")
        self._log.flush()
        if not quietly:
            text = f"[bold]{escape(stage)}[/bold]: {escape(sentence)}"
            self._bars.console.print(text, highlight=False, soft_wrap=True)
