"""Runs a protocol over an object store that fails, stalls and tears writes, until it is finished.

    OMP_NUM_THREADS=1 python benchmarks/store_soak.py --out out/store

The store is the local disk under another name. Of its calls, given shares fail, stall, leave a part
of what was to be written and say so, or leave a part and report success. Each call of the run ends
where the store refuses, with an error of ours (anything else ends the soak), and is given again;
a folder that does not fit its hash is deleted in the store, as the remedy says. At last the run is
brought from the store into an empty folder, and every file is compared by its SHA-256 with a run
without a store.
"""

from __future__ import annotations

import argparse
import random
import re
import shutil
import sys
import time
from collections import Counter
from pathlib import Path
from typing import ClassVar

import fsspec
from fsspec.implementations.local import LocalFileSystem

from surmount.core.errors import IntegrityError, OutputError

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from small import run_small, small_config

from kill_soak import content

KINDS = ("fail", "stall", "tear", "tear in silence")
STALL_S = 1.0
MOST_CALLS = 10_000


class FlakyFiles(LocalFileSystem):
    """The local disk, unreliable."""

    protocol = ("flaky",)
    cachable = False
    shares: ClassVar[list[float]] = []
    met: ClassVar[Counter[str]] = Counter()
    rng: ClassVar[random.Random] = random.Random(0)  # noqa: S311

    @classmethod
    def _strip_protocol(cls, path):
        return super()._strip_protocol(str(path).removeprefix("flaky://"))

    def _fault(self, target: str = "", whole: bytes = b"") -> bool:
        """Fail, stall or tear; true if a write was torn in silence."""
        (kind,) = self.rng.choices([*KINDS, ""], [*self.shares, 1.0 - sum(self.shares)])
        if not target:  # nothing is written that could be torn
            kind = kind if kind in ("fail", "stall") else ""
        self.met[kind] += 1
        if kind == "stall":
            time.sleep(STALL_S)
        if kind.startswith("tear"):
            Path(target).write_bytes(whole[: len(whole) // 2])
        if kind in ("fail", "tear"):
            raise ConnectionError("the connection was lost")
        return kind == "tear in silence"

    def exists(self, path, **kwargs):
        self._fault()
        return super().exists(path, **kwargs)

    def cat_file(self, path, start=None, end=None, **kwargs):
        self._fault()
        return super().cat_file(path, start, end, **kwargs)

    def get_file(self, path1, path2, **kwargs):
        self._fault()
        return super().get_file(path1, path2, **kwargs)

    def put_file(self, path1, path2, **kwargs):
        if not self._fault(self._strip_protocol(path2), Path(path1).read_bytes()):
            super().put_file(path1, path2, **kwargs)

    def pipe_file(self, path, value, **kwargs):
        if not self._fault(self._strip_protocol(path), value):
            super().pipe_file(path, value, **kwargs)


def until_finished(root: Path, networks: int, url: str) -> Counter[str]:
    """Give the same command until it succeeds; returns how often each kind of error ended it."""
    told: Counter[str] = Counter()
    while sum(told.values()) < MOST_CALLS:
        try:
            run_small(root, small_config(networks=networks), url=url)
        except (OutputError, IntegrityError) as error:
            told[type(error).__name__] += 1
            named = re.search(r"Delete (\S+) there", error.remedy)
            if named:
                shutil.rmtree(named[1])
        else:
            return told
    sys.exit(f"not finished after {MOST_CALLS} calls")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shares", default="0.03,0.03,0.1,0.1", help=f"of {', '.join(KINDS)}")
    parser.add_argument("--networks", type=int, default=2)
    parser.add_argument("--reference", type=Path, help="run to compare with; made if not given")
    parser.add_argument("--out", type=Path, default=Path("out/store"))
    chosen = parser.parse_args()
    shutil.rmtree(chosen.out, ignore_errors=True)
    chosen.out.mkdir(parents=True)
    reference = chosen.reference or chosen.out / "reference"
    run_small(reference, small_config(networks=chosen.networks))
    expected = content(reference)
    began = time.monotonic()
    FlakyFiles.shares = [float(share) for share in chosen.shares.split(",")]
    fsspec.register_implementation("flaky", FlakyFiles)
    told: Counter[str] = Counter()
    for name in ("run", "elsewhere"):  # the second brings everything from the store
        url = f"flaky://{(chosen.out / 'store').resolve()}"
        told += until_finished(chosen.out / name, chosen.networks, url)
        if content(chosen.out / name) != expected:
            sys.exit(f"{chosen.out / name} differs from the reference")
    met = {kind: FlakyFiles.met[kind] for kind in KINDS}
    print(f"{len(expected)} files identical, in the folder and brought from the store; of "
          f"{FlakyFiles.met.total():,} calls {met}; the run ended and went on "
          f"{sum(told.values())} times ({dict(told)}), {time.monotonic() - began:.0f} s",
          flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
