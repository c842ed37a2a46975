"""The history of a training as Parquet tables."""

from __future__ import annotations

from pathlib import Path

import polars as pl

from surmount.learn.history import History
from surmount.workflow.run_layout import EPISODES_FILE, HISTORY_FILE


def write_history(history: History, folder: Path) -> None:
    """Write one row per roll-out and one row per episode.

    ``history.parquet`` has ``steps``, ``reward`` (mean unnormalised reward per learning step),
    ``success`` (share of episodes, null where none ended) and ``label``; ``episodes.parquet`` has
    ``steps``, ``variant.<parameter>``, ``reward``, ``length``, ``success`` and ``diverged``.
    """
    rollouts = pl.DataFrame(
        {
            "steps": history.steps,
            "reward": history.reward,
            "success": history.success,
            "label": pl.Series(history.label, dtype=pl.String),
        }
    ).with_columns(pl.col("success").fill_nan(None))
    rollouts.write_parquet(folder / HISTORY_FILE)
    episodes = history.episodes
    variants = {
        f"variant.{name}": episodes.variant[:, index]
        for index, name in enumerate(history.parameters)
    }
    pl.DataFrame(
        {
            "steps": episodes.step,
            **variants,
            "reward": episodes.reward,
            "length": episodes.length,
            "success": episodes.success,
            "diverged": episodes.diverged,
        }
    ).write_parquet(folder / EPISODES_FILE)
