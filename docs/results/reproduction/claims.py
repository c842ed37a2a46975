"""Every claim of the paper on some runs, as a table in Markdown: ``python claims.py RUN ...``.

Judged anew from trials and analysis by the rules of ADR 32, so that words are those of this
version: beside each difference of arms stands the smallest that would have been found.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from surmount.core.printing import say
from surmount.report.evidence import Findings
from surmount.report.results import read_run
from surmount.studies.paper.claims import claims_of


def rows(root: Path) -> Iterator[str]:
    """Write one row for each claim."""
    results = read_run(root)
    findings = Findings(
        analysis=results.analysis, comparison=results.comparison, tests=results.tests
    )
    for claim in claims_of(results.folder.task, findings):
        cells = (root.name, claim.claim, claim.paper, claim.ours, claim.verdict)
        yield f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"


if __name__ == "__main__":
    say("| run | claim | the paper | here | verdict |", "|---|---|---|---|---|")
    for name in sys.argv[1:]:
        say(*rows(Path(name)))
