"""A table in Parquet vouches for itself: no flipped bit gives another value, or a panic."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys

import numpy as np
import polars as pl
import pytest
from example_trials import two_behaviours

from surmount.core.errors import InputError
from surmount.learn.snapshot import Snapshot
from surmount.trials.checksum import check, without_panics
from surmount.trials.table import read_trials, write_trials


def test_every_flipped_bit_is_noticed_or_without_effect(tmp_path):
    trials, path = two_behaviours(), tmp_path / "t.parquet"
    write_trials(path, trials)
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    noticed = 0
    for place in rng.integers(0, len(whole), 200):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        try:
            found = read_trials(path)
        except InputError:
            noticed += 1
            continue
        np.testing.assert_array_equal(found.features, trials.features)
        np.testing.assert_array_equal(found.success, trials.success)
    assert noticed > 180  # all but bits of the checksum's own name


def test_a_table_is_written_with_the_same_bytes_and_read_by_others(tmp_path):
    for name in ("a", "b"):
        write_trials(tmp_path / f"{name}.parquet", two_behaviours())
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    frame = pl.read_parquet(tmp_path / "a.parquet")
    check(tmp_path / "a.parquet")
    frame.write_parquet(tmp_path / "b.parquet")  # of somebody else: without a checksum
    assert read_trials(tmp_path / "b.parquet").n_trials == two_behaviours().n_trials


def test_a_truncated_table_is_refused(tmp_path):
    path = tmp_path / "t.parquet"
    write_trials(path, two_behaviours())
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InputError):
        read_trials(path)


def test_what_a_panic_prints_is_kept_back_and_nothing_else(capfd):
    with without_panics():
        os.write(2, b"a note of a library\n")
    assert capfd.readouterr().err == "a note of a library\n"
    with without_panics():
        os.write(2, b"thread '<unnamed>' panicked at crates/x.rs:1:2:\n")
    assert capfd.readouterr().err == ""


def test_damaged_parquet_of_others_prints_no_panic(tmp_path):
    """Bits flipped where Polars is known to panic among others; in a process of its own."""
    program = """
import sys
from pathlib import Path
import numpy as np
from surmount.core.errors import InputError
from surmount.trials.table import read_trials
path = Path(sys.argv[1])
whole = path.read_bytes()
rng = np.random.default_rng(1)
for _ in range(300):
    damaged = bytearray(whole)
    damaged[rng.integers(len(whole))] ^= 1 << int(rng.integers(8))
    path.write_bytes(damaged)
    try:
        read_trials(path)
    except InputError as error:
        assert "panicked" not in str(error), error
"""
    path = tmp_path / "t.parquet"
    write_trials(path, two_behaviours())
    pl.read_parquet(path).write_parquet(path)
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""


@pytest.mark.parametrize("kind", ["BF16", "F8_E4M3", "F8_E5M2"])
def test_a_network_of_a_type_that_numpy_lacks_is_refused(tmp_path, kind):
    size = 2 if kind == "BF16" else 1
    header = json.dumps({"w": {"dtype": kind, "shape": [1], "data_offsets": [0, size]}}).encode()
    path = tmp_path / "network.safetensors"
    path.write_bytes(struct.pack("<Q", len(header)) + header + b"\0" * size)
    with pytest.raises(InputError, match="not a network"):
        Snapshot.load(path)
