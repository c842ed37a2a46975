"""Peak memory of reading a large table of trials, in bytes per row.

    python benchmarks/analysis_memory.py [million rows, default 2]

Each reading runs in a process of its own; what that process takes before it reads (Python, NumPy,
polars) is left out. 4 features, 20 variants, 2 networks, trials of 1,000 steps.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from surmount import Trials, read_trials, write_trials

STEPS = 1_000


def trials(n_trials):
    rng = np.random.default_rng(0)
    index = np.arange(n_trials)
    features = rng.normal(size=(n_trials * STEPS, 4))
    features[:, 0] = np.tile(0.02 * np.arange(STEPS), n_trials)
    return Trials(
        parameters=("variant",),
        feature_names=("time_s", "sprawl_deg", "fbem_deg", "distance_m"),
        variant=20.0 + (index % 20)[:, None],
        network=index // 20 % 2,
        repetition=index // 40,
        success=rng.random(n_trials) < 0.5,
        starts=np.arange(n_trials + 1) * STEPS,
        features=features,
    )


def peak_bytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def measure(path):
    with tempfile.TemporaryDirectory() as folder:  # loads all that reading needs, polars included
        small = Path(folder) / f"small{path.suffix}"
        write_trials(small, trials(2))
        read_trials(small)
    before, started = peak_bytes(), time.perf_counter()
    n_rows = read_trials(path, minimum_variants=2, minimum_samples=20).n_samples
    seconds, used = time.perf_counter() - started, peak_bytes() - before
    print(
        f"{path.suffix:9s} {n_rows:,} rows: {seconds:.1f} s, {used / 2**20:.0f} MiB above "
        f"{before / 2**20:.0f} MiB, {used / n_rows:.0f} bytes a row",
        flush=True,
    )


def main():
    millions = sys.argv[1] if len(sys.argv) > 1 else "2"
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (".parquet", ".csv"):
            path = str(Path(folder) / f"trials{suffix}")
            # A process starts with its parent's peak: this one stays small.
            for step in ("--write", "--measure"):
                command = [sys.executable, __file__, step, path, millions]
                subprocess.run(command, check=True)  # noqa: S603 - this file itself


if __name__ == "__main__":
    step = sys.argv[1] if len(sys.argv) > 2 else ""
    if step == "--write":
        write_trials(Path(sys.argv[2]), trials(round(float(sys.argv[3]) * 1e6 / STEPS)))
    elif step == "--measure":
        measure(Path(sys.argv[2]))
    else:
        main()
