"""Kills its own process at moments that `aimed_kills.py` names; for soaks, in every worker.

Python imports this module by itself where its folder is on ``PYTHONPATH``. The environment variable
``SURMOUNT_AIM`` names a folder with one file per kill, called ``<moment>@<stage>`` with ``%`` for
each slash, holding the process to kill besides, or 0. Whoever comes to the moment takes the file
away, so that each kill happens once.
"""

from __future__ import annotations

import importlib.machinery
import os
import signal
import sys
import time
from pathlib import Path

MOMENTS = (
    "within a checkpoint",
    "after a checkpoint",
    "before the manifest",
    "between manifest and rename",
    "after the rename",
    "before it is told",
)


def reached(moment: str, stage: str) -> None:
    """Kill this process, and another one if so wanted, if it is aimed at here."""
    name = f"{moment}@{stage.replace('/', '%')}"
    aim, hit = Path(os.environ["SURMOUNT_AIM"], name), Path(os.environ["SURMOUNT_HITS"], name)
    try:
        aim.rename(hit)
    except OSError:
        return
    victim = int(Path(os.environ["SURMOUNT_HITS"], "driver").read_text(encoding="utf-8"))
    if hit.read_text(encoding="utf-8") == "run":
        os.kill(victim, signal.SIGKILL)
    os.kill(os.getpid(), signal.SIGKILL)


def stage_of(path: Path, below: str) -> str:
    """Return the stage whose folder a file lies in: ``<below>/<stage>/<key>/<file>``."""
    parts = path.parts
    return "/".join(parts[parts.index(below) + 1 : -2]) if below in parts else ""


def watch_records(module) -> None:
    write = module.write_atomically

    def watched(path, content):
        stage = stage_of(path, "checkpoints")
        if stage:
            half = path.with_name(f".{path.name}.00000000.tmp")
            if Path(os.environ["SURMOUNT_AIM"], f"{MOMENTS[0]}@{stage.replace('/', '%')}").exists():
                half.write_bytes(content[: len(content) // 2])
            reached(MOMENTS[0], stage)
        write(path, content)
        if stage:
            reached(MOMENTS[1], stage)

    module.write_atomically = watched


def watch_store(module) -> None:
    write, drop = module.write_record, module.LocalStore.drop_checkpoint

    def watched_write(path, record):
        stage = stage_of(path, "stages") if path.name == module.MANIFEST else ""
        if stage:
            reached(MOMENTS[2], stage)
        write(path, record)
        if stage:
            reached(MOMENTS[3], stage)

    def watched_drop(self, stage, key):
        reached(MOMENTS[4], stage)
        drop(self, stage, key)
        reached(MOMENTS[5], stage)

    module.write_record, module.LocalStore.drop_checkpoint = watched_write, watched_drop


def watch_workers(module) -> None:
    """Let a worker look for the run itself: its parent may be the server that it is forked from."""

    def die_with(run: int) -> None:
        while os.path.exists(f"/proc/{run}"):  # noqa: PTH110 - no more is loaded than needed
            time.sleep(module.WATCH_INTERVAL_S)
        os._exit(1)

    module._die_with = die_with  # noqa: SLF001


WATCHED = {
    "surmount.core.records": watch_records,
    "surmount.workflow.store": watch_store,
    "surmount.workflow.local_processes": watch_workers,
}


class Finder:
    """Lets a module be watched as soon as it is imported."""

    @staticmethod
    def find_spec(name, path=None, _target=None):
        watch = WATCHED.get(name)
        spec = importlib.machinery.PathFinder.find_spec(name, path) if watch else None
        if spec is None or watch is None or spec.loader is None:
            return None
        run = spec.loader.exec_module

        def run_and_watch(module):
            run(module)
            watch(module)

        spec.loader.exec_module = run_and_watch
        return spec


if "SURMOUNT_AIM" in os.environ:
    sys.meta_path.insert(0, Finder)
