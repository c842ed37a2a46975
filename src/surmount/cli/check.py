"""``surmount check``: whether one's own environment keeps the contract."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Generator
from contextlib import contextmanager
from typing import Annotated

import tyro

from surmount.core.printing import say

BROKEN = 3
"""Exit code where a clause does not hold, as for an input that cannot be used."""


def check(
    environment: Annotated[str, tyro.conf.Positional], *, seed: int = 0, time_limit_s: int = 120
) -> int:
    """Verify the contract of an environment before hours are spent on it.

    Runs episodes of random actions: the task must change what happens, success must be told,
    features must be finite and vary, seeds must matter and repeat, episodes must have a time
    limit (docs/own-environment.md). Each clause is told as soon as it is known.
    Notes name what holds and is worth a look.

    Args:
        environment: The function that makes it, as my_module:make_env.
        seed: Of episodes and actions.
        time_limit_s: Seconds after which the check ends, whatever the environment is doing.
    """
    from surmount.envs.check import contract_findings
    from surmount.envs.loading import load_make_env

    findings: dict[str, bool] = {}
    with _at_most(time_limit_s):
        for finding in contract_findings(load_make_env(environment), seed=seed):
            told = "holds " if finding.holds else "BROKEN"
            say(f"{told}  {finding.clause}: {finding.sentence}")
            if not finding.holds:
                say(f"        {finding.remedy}")
            if finding.note:
                say(f"        Note: {finding.note}")
            sys.stdout.flush()
            findings[finding.clause] = finding.holds
    broken = sum(not holds for holds in findings.values())
    if broken:
        say(f"{broken} of {len(findings)} clauses broken.")
        return BROKEN
    say(f"All {len(findings)} clauses hold.")
    return 0


@contextmanager
def _at_most(seconds: int) -> Generator[None]:
    """Raise ``TimeoutError`` in what runs for longer; without effect where there is no alarm."""
    if not hasattr(signal, "SIGALRM") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def ring(*_: object) -> None:
        raise TimeoutError(f"the check took longer than {seconds} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(max(seconds, 1))
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
