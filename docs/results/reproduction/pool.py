"""The arms over the networks of one or several runs: ``python pool.py TASK OUTCOMES.parquet ...``.

Reads what ``publish.py`` wrote, pairs arms network by network over all runs, and prints tables in
Markdown: each network's success, and differences with 95 % t-intervals over networks and the
smallest difference that a paired t-test would have found in four of five cases.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import polars as pl

from surmount.core.printing import say
from surmount.stats.detectable import detectable_between
from surmount.stats.differences import network_difference
from surmount.studies.paper.results import PAPER_RESULTS

HARDEST = {"step": {"hardest quarter": (43.0, 50.0)}}
"""What the plan names besides all variants and the paper's recovered groups, in mm."""
PAIRS = (("curriculum", "control"), ("given-groups", "control"), ("given-groups", "curriculum"))


def ranges(task: str) -> dict[str, tuple[float, float]]:
    """Return the sizes in mm over which success is averaged: all, and the paper's groups."""
    groups = (group.range_mm for group in PAPER_RESULTS[task].groups)
    named = {"{:g}-{:g}".format(*sizes): sizes for sizes in groups}
    return {"all": (0.0, np.inf), **named, **HARDEST.get(task, {})}


def scores(task: str, paths: list[Path]) -> pl.DataFrame:
    """Return one row per run, network and arm, with the mean success of each range in points."""
    tables: list[pl.DataFrame] = []
    for path in paths:
        table = pl.read_parquet(path)
        size = next(name for name in table.columns if name.endswith("_mm"))
        variants = table.group_by("learnt", "network", size).agg(pl.col("success").mean())
        tables.append(
            variants.group_by("learnt", "network")
            .agg(
                (100 * pl.col("success").filter(pl.col(size).is_between(low, high)).mean()).alias(
                    name
                )
                for name, (low, high) in ranges(task).items()
            )
            .with_columns(pl.lit(path.parent.name).alias("run"))
        )
    return pl.concat(tables).sort("run", "network", "learnt")


def lines(table: pl.DataFrame, names: list[str]) -> Iterator[str]:
    """Write the tables."""
    yield "| run, network | " + " | ".join(f"{name} mm" for name in names) + " |"
    yield "|---" * (1 + len(names)) + "|"
    arms = [arm for arm in ("initiation", "control", "curriculum", "given-groups")
            if arm in table["learnt"]]  # fmt: skip
    for (run, network), rows in table.group_by("run", "network", maintain_order=True):
        by_arm = {row["learnt"]: row for row in rows.to_dicts()}
        cells = [" / ".join(f"{by_arm[arm][name]:.0f}" for arm in arms) for name in names]
        yield f"| {run}, {network} | " + " | ".join(cells) + " |"
    yield f"\nPercent of trials: {' / '.join(arms)}.\n"
    yield "| difference, points | networks | " + " | ".join(f"{name} mm" for name in names) + " |"
    yield "|---" * (2 + len(names)) + "|"
    for first, second in PAIRS:
        if first in arms and second in arms:
            one, two = (_matrix(table, arm, names) for arm in (first, second))
            cells = [_difference(one[:, i], two[:, i]) for i in range(len(names))]
            yield f"| {first} − {second} | {len(one)} | " + " | ".join(cells) + " |"


def _matrix(table: pl.DataFrame, arm: str, names: list[str]) -> np.ndarray:
    return table.filter(pl.col("learnt") == arm).select(names).to_numpy()


def _difference(one: np.ndarray, two: np.ndarray) -> str:
    found = network_difference(one, two, paired=True)
    if found.lower is None:
        return f"{found.estimate:+.1f}"
    least = detectable_between(one - two)
    return f"{found.estimate:+.1f} ({found.lower:+.1f} to {found.upper:+.1f}; {least:.0f})"


if __name__ == "__main__":
    task, *found = sys.argv[1:]
    for line in lines(scores(task, [Path(path) for path in found]), [*ranges(task)]):
        say(line)
