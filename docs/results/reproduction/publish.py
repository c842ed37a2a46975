"""Take what a repository should show of a run: ``python publish.py RUN FOLDER [NETWORKS]``.

The page, the same in Markdown, figures with their data, configuration and versions, curriculum,
analysis and statistics; and of the first NETWORKS (two, as many as the paper had) what acting
needs: ``surmount evaluate FOLDER/networks/curriculum-0.safetensors`` works at once.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from surmount.core.run_folder import open_run
from surmount.core.run_layout import ANALYSIS, RUN, STATISTICS, TRAININGS
from surmount.experiment import stages
from surmount.learn import Snapshot, acting_only
from surmount.report import write_report


def publish(root: Path, folder: Path, networks: int = 2) -> None:
    """Copy it."""
    page = write_report(root)
    run = open_run(root)
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    (folder / "networks").mkdir(exist_ok=True)
    for path in (page, page.with_suffix(".md"), root / RUN):
        shutil.copy(path, folder)
    for path in sorted((root / "figures").iterdir()):
        if path.suffix in {".png", ".csv"}:
            shutil.copy(path, folder / "figures")
    analysis, statistics = run.stages[ANALYSIS], run.stages[STATISTICS]
    for path in (
        analysis.path(stages.CURRICULUM),
        analysis.path(stages.ANALYSIS),
        statistics.path("statistics.json"),
    ):
        shutil.copy(path, folder)
    for kind in TRAININGS:
        for index, artefact in list(run.numbered(kind).items())[:networks]:
            network = acting_only(Snapshot.load(artefact.path(stages.NETWORK)))
            network.save(folder / "networks" / f"{kind}-{index}.safetensors")


if __name__ == "__main__":
    publish(Path(sys.argv[1]), Path(sys.argv[2]), *map(int, sys.argv[3:]))
