"""Memory of one training over ten million learning steps.

    OMP_NUM_THREADS=1 python benchmarks/memory_soak.py --steps 10000000 --out out/memory

Trains on the low entrance through the shipped trainer, with checkpoints, and reads the resident
memory of the process (``/proc/self/statm``) after every roll-out. Networks are small and steps
short (two physics steps), so that they are affordable; what could grow (history, episodes,
checkpoints, logger) is what a long run has. Writes the readings as CSV and a figure.
"""

from __future__ import annotations

import argparse
import csv
import os
import time
from pathlib import Path

import numpy as np
import torch
from matplotlib.figure import Figure

from surmount.core.configuration import override
from surmount.experiment.presets import preset
from surmount.learn.trainer import Checkpointing, Trainer
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import SilentMonitor

CHANGES = {
    "env.step_s": 0.005,
    "env.episode_s": 1.0,
    "learner.num_envs": 64,
    "learner.hidden_layers": [16, 16],
    "learner.rollout_steps": 512,
    "learner.batch_size": 32768,
    "learner.epochs": 1,
}
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
SETTLED = 0.1
"""Share of the run after which memory should no longer grow."""


class Reader(SilentMonitor):
    """Reads memory whenever training tells of progress."""

    def __init__(self, file) -> None:
        self.rows: list[tuple[int, float, float]] = []
        self._began = time.monotonic()
        self._writer = csv.writer(file, lineterminator="\n")
        self._file = file
        self._writer.writerow(["steps", "seconds", "resident_mb"])

    def progress(self, progress) -> None:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
        seconds = round(time.monotonic() - self._began, 1)
        row = (progress.done, seconds, round(pages * PAGE_BYTES / 1e6, 2))
        self.rows.append(row)
        self._writer.writerow(row)
        self._file.flush()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--out", type=Path, default=Path("out/memory"))
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    chosen.out.mkdir(parents=True, exist_ok=True)
    config = override(preset("low-entrance", "paper"), CHANGES)
    family = config.family
    whole_range = family.space(config.env).whole_range
    teacher = UniformTeacher(whole_range, chosen.steps, label="soak")
    env = family.training_env(config.env, config.learner.num_envs)
    with (chosen.out / "memory.csv").open("w", encoding="utf-8") as file:
        reader = Reader(file)
        trainer = Trainer(env, teacher, config.learner, seed=0, log_folder=chosen.out / "logs")
        checkpointing = Checkpointing(
            path=chosen.out / "checkpoint.safetensors", interval_steps=300_000
        )
        training = trainer.run(reader, checkpointing)
    steps, seconds, memory = np.array(reader.rows).T
    settled = steps >= SETTLED * steps[-1]
    slope = np.polyfit(steps[settled], memory[settled], 1)[0] * 1e6
    episodes = training.history.episodes.step.size
    print(f"{steps[-1]:,.0f} steps in {seconds[-1]:,.0f} s, {episodes:,} episodes")
    print(f"{memory[settled][0]:.1f} MB after a tenth, {memory[-1]:.1f} MB at the end, at most "
          f"{memory.max():.1f} MB; {slope:+.3f} MB per million steps")  # fmt: skip
    draw(steps, memory, chosen.out / "memory.png")


def draw(steps, memory, path: Path) -> None:
    figure = Figure(figsize=(7.2, 3.0), layout="constrained")
    axes = figure.subplots()
    axes.plot(steps / 1e6, memory, linewidth=1.2)
    axes.set(xlabel="learning steps (millions)", ylabel="resident memory (MB)")
    axes.set_ylim(0, 1.25 * memory.max())
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main()
