"""``surmount check``: whether one's own environment keeps the contract."""

from __future__ import annotations

from typing import Annotated

import tyro

from surmount.core.printing import say

BROKEN = 3
"""Exit code where a clause does not hold, as for an input that cannot be used."""


def check(environment: Annotated[str, tyro.conf.Positional], *, seed: int = 0) -> int:
    """Verify the contract of an environment before hours are spent on it.

    Runs episodes of random actions: the task must change what happens, success must be told,
    features must be finite and vary, seeds must matter and repeat, episodes must have a time
    limit (docs/own-environment.md). Notes name what holds and is worth a look.

    Args:
        environment: The function that makes it, as my_module:make_env.
        seed: Of episodes and actions.
    """
    from surmount.envs.check import check_contract
    from surmount.envs.loading import load_make_env

    findings = check_contract(load_make_env(environment), seed=seed)
    for finding in findings:
        say(f"{'holds ' if finding.holds else 'BROKEN'}  {finding.clause}: {finding.sentence}")
        if not finding.holds:
            say(f"        {finding.remedy}")
        if finding.note:
            say(f"        Note: {finding.note}")
    broken = sum(not finding.holds for finding in findings)
    if broken:
        say(f"{broken} of {len(findings)} clauses broken.")
        return BROKEN
    say(f"All {len(findings)} clauses hold.")
    return 0
