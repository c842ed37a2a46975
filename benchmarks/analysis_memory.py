"""Time and peak memory of reading and of analysing a large table, beside Polars' own scan of it.

    python benchmarks/analysis_memory.py [million rows, default 3]

Each measurement runs in a process of its own; what that process takes before (Python, libraries,
a small table read or analysed) is left out. The scan is what Polars takes to read all columns with
its own types, and checks nothing. Reading is `surmount.read_trials`, analysing the
command `surmount analyze` with its defaults, bootstrap and page included. 4 features, 20 variants,
2 networks, trials of 1,000 steps.
"""

from __future__ import annotations

import contextlib
import io
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import polars as pl

from surmount import Analysis, Trials, read_trials, write_trials
from surmount.cli.main import run

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


def scan(path, _folder):
    lazy = pl.scan_parquet(path) if path.suffix == ".parquet" else pl.scan_csv(path)
    return lazy.collect(engine="streaming").height


def read(path, _folder):
    return read_trials(path, minimum_variants=2, minimum_samples=20).n_samples


def analyse(path, folder):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert run(["analyze", str(path), "--out", str(folder)]) == 0
    return int(Analysis.load(Path(folder) / "analysis.json").n_recorded.sum())


STEPS_MEASURED = {"--scan": scan, "--read": read, "--analyse": analyse}


def measure(work, path):
    with tempfile.TemporaryDirectory() as folder:
        small = Path(folder) / f"small{path.suffix}"
        write_trials(small, trials(40))
        work(small, Path(folder) / "small")  # loads all that the work needs
        before, started = peak_bytes(), time.perf_counter()
        n_rows = work(path, Path(folder) / "large")
    seconds, used = time.perf_counter() - started, peak_bytes() - before
    print(
        f"{work.__name__} {path.suffix:9s} {n_rows:,} rows: {seconds:.1f} s, "
        f"{used / 2**20:.0f} MiB above {before / 2**20:.0f} MiB, {used / n_rows:.0f} bytes a row",
        flush=True,
    )


def main():
    millions = sys.argv[1] if len(sys.argv) > 1 else "3"
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (".parquet", ".csv"):
            path = str(Path(folder) / f"trials{suffix}")
            # A process starts with its parent's peak: this one stays small.
            for step in ("--write", "--scan", "--read", "--analyse"):
                command = [sys.executable, __file__, step, path, millions]
                subprocess.run(command, check=True)  # noqa: S603 - this file itself


if __name__ == "__main__":
    step = sys.argv[1] if len(sys.argv) > 2 else ""
    if step == "--write":
        write_trials(Path(sys.argv[2]), trials(round(float(sys.argv[3]) * 1e6 / STEPS)))
    elif step in STEPS_MEASURED:
        measure(STEPS_MEASURED[step], Path(sys.argv[2]))
    else:
        main()
