"""Stages for tests of the runner: at the top level of a module, so that workers find them."""

from __future__ import annotations

import os
import signal
import time

from surmount.core.errors import LearningError
from surmount.core.records import read_record, write_record
from surmount.workflow.graph import StageKind
from surmount.workflow.monitor import Interrupted, Progress


def number(context):
    """Write a number that depends on configuration and seed, and note the call."""
    _note_call(context)
    write_record(context.output / "n.json", {"n": context.config["n"] + context.seed})


def total(context):
    """Write the sum of all inputs."""
    _note_call(context)
    numbers = [read_record(part.path("n.json"))["n"] for part in context.inputs["parts"]]
    write_record(context.output / "n.json", {"n": sum(numbers)})


HANGING_S = 1800.0
"""Whoever waits longer waits in vain: far more than the slowest machine takes."""


def count_slowly(context):
    """Count to 50 with a checkpoint at every step, and stop when asked.

    With ``hold_at``, a count from 0 goes no further than this until it is asked.
    """
    _note_call(context)
    path = context.checkpoint / "count.json"
    first = done = read_record(path)["done"] if path.exists() else 0
    context.monitor.log(f"starts at {done}")
    while done < 50:
        given_up = time.monotonic() + HANGING_S
        while first == 0 and done == context.config.get("hold_at"):
            if context.monitor.should_stop():
                break
            if time.monotonic() > given_up:
                raise TimeoutError
            time.sleep(0.01)
        if context.monitor.should_stop():
            raise Interrupted
        time.sleep(0.02)
        done += 1
        write_record(path, {"done": done})
        context.monitor.progress(Progress(label="counting", done=done, planned=50))
    write_record(context.output / "n.json", {"n": done})


def fail(context):
    """Find something wrong."""
    raise LearningError("The weights are not finite.", remedy="Lower the learning rate.")


def die(context):
    """Be killed, a number of times: as by the system when memory runs out."""
    died = len(list(context.checkpoint.iterdir()))
    if died < context.config["times"]:
        (context.output / "half").write_text("written", encoding="utf-8")
        (context.checkpoint / f"death-{died}").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    write_record(context.output / "n.json", {"n": died})


KINDS = {
    function.__name__: StageKind(
        name=function.__name__, function=function, legacy=f"toys:{function.__name__}"
    )
    for function in (number, total, count_slowly, fail, die)
}


def deaths(root):
    """Return the marks that :func:`die` left."""
    return list(root.rglob("death-*"))


def _note_call(context):
    context.logs.mkdir(parents=True, exist_ok=True)
    with (context.logs / "calls").open("a", encoding="utf-8") as file:
        file.write(f"{context.name}\n")
