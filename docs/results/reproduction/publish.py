"""Take what a repository should show of a run: ``python publish.py RUN FOLDER [NETWORK ...]``.

The page, the same in Markdown, figures with their data, configuration and versions, curriculum,
analysis and statistics; the outcome of every trial (``outcomes.parquet``) and every episode that
was learnt from (``episodes.parquet``); and of each NETWORK named by its number what acting needs:
``surmount evaluate FOLDER/networks/curriculum-0.safetensors`` works at once.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

import polars as pl
from PIL import Image

from surmount.learn.snapshot import Snapshot, acting_only
from surmount.report.pages import write_report
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import RunFolder, open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    ANALYSIS_FILE,
    CURRICULUM_FILE,
    EPISODES_FILE,
    NETWORK_FILE,
    RUN,
    STATISTICS,
    STATISTICS_FILE,
    TRAININGS,
    TRIALS,
    TRIALS_FILE,
    taught,
    taught_trials,
)


def publish(root: Path, folder: Path, networks: Sequence[int]) -> None:
    """Copy it."""
    page = write_report(root)
    run = open_run(root)
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    (folder / "networks").mkdir(exist_ok=True)
    for path in (page, page.with_suffix(".md"), root / RUN):
        shutil.copy(path, folder)
    for path in sorted((root / "figures").iterdir()):
        if path.suffix == ".csv":
            shutil.copy(path, folder / "figures")
        if path.suffix == ".png":  # a quarter of the size; the vector pictures are in the page
            Image.open(path).convert("RGB").quantize(256).save(
                folder / "figures" / path.name, optimize=True
            )
    analysis, statistics = run.stages[ANALYSIS], run.stages[STATISTICS]
    for path in (
        analysis.path(CURRICULUM_FILE),
        analysis.path(ANALYSIS_FILE),
        statistics.path(STATISTICS_FILE),
    ):
        shutil.copy(path, folder)
    outcomes(run).write_parquet(folder / "outcomes.parquet", compression_level=19)
    episodes(run).write_parquet(folder / "episodes.parquet", compression_level=19)
    for kind in (*TRAININGS, *(taught(teacher) for teacher in teachers(run))):
        found = run.numbered(kind)
        for index in networks:
            artefact = found[index]
            network = acting_only(Snapshot.load(artefact.path(NETWORK_FILE)))
            network.save(folder / "networks" / f"{kind.split('/')[-1]}-{index}.safetensors")


def teachers(run: RunFolder) -> list[str]:
    """Return the teachers besides the protocol's own arms that trained in a run."""
    return sorted({name.split("/")[1] for name in run.stages if name.startswith(taught(""))})


def episodes(run: RunFolder) -> pl.DataFrame:
    """Return one row per episode of every training: steps, task, reward, length, success."""
    kinds = {kind: kind for kind in TRAININGS} | {name: taught(name) for name in teachers(run)}
    return pl.concat(
        pl.read_parquet(artefact.path(EPISODES_FILE)).select(
            pl.lit(name).alias("learnt"), pl.lit(network).alias("network"), pl.all()
        )
        for name, kind in kinds.items()
        for network, artefact in run.numbered(kind).items()
    )


def outcomes(run: RunFolder) -> pl.DataFrame:
    """Return one row per trial: what had been learnt, on which variant, and what became of it."""
    tables: list[pl.DataFrame] = []
    tested = {**TRIALS, **{name: taught_trials(name) for name in teachers(run)}}
    for learnt, stage in tested.items():
        for artefact in run.numbered(stage).values():
            trials = read_trials(artefact.path(TRIALS_FILE))
            columns = {
                "learnt": [learnt] * trials.n_trials,
                "network": trials.network,
                **dict(zip(trials.parameters, trials.variant.T, strict=True)),
                "repetition": trials.repetition,
                "success": trials.success,
                "end_s": trials.final("time_s"),
                "sprawl_path_deg": trials.path_length("sprawl_deg"),
                "fbem_path_deg": trials.path_length("fbem_deg"),
            }
            tables.append(pl.DataFrame(columns))
    return pl.concat(tables)


if __name__ == "__main__":
    publish(Path(sys.argv[1]), Path(sys.argv[2]), [int(number) for number in sys.argv[3:]])
