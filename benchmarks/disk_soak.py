"""Runs a protocol on a disk that is full again and again, with others at its folder.

    OMP_NUM_THREADS=1 python benchmarks/disk_soak.py --out out/disk

The disk is a tmpfs that grows by a step whenever `surmount reproduce` has ended because it is full:
with exit code 4 and a sentence that names the folder, which is checked. While each call runs, a
second process is started on the same folder, which has to be refused. At last every file of every
stage is compared by its SHA-256 with a run on another disk. Needs a system where users may mount in
a namespace of their own (`unshare -rm`).
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from small import SMALL, run_small, small_config

from kill_soak import content

PROGRAM = "from surmount.cli.main import main; main()"
LOCK_S = 600.0


def command(root: Path, networks: int) -> list[str]:
    options = [f"--set={key}={json.dumps(value)}" for key, value in SMALL.items()]
    return [
        *(sys.executable, "-c", PROGRAM, "reproduce", "narrow-channel", "--out", str(root)),
        *(*options, "--set", f"networks={networks}", "--processes", "0"),
    ]


def second_is_refused(root: Path, networks: int, first: subprocess.Popen) -> bool:
    """Start a second process once the first holds the folder; false if the first ended before."""
    given_up = time.monotonic() + LOCK_S
    while not (root / "logs" / "run.log").exists() and time.monotonic() < given_up:
        if first.poll() is not None:
            return False
        time.sleep(0.05)
    second = subprocess.run(  # noqa: S603
        command(root, networks), capture_output=True, text=True, check=False
    )
    if first.poll() is not None:
        return False
    if second.returncode != 4 or "Another process" not in second.stderr:
        sys.exit(f"the second process was not refused:\n{second.stdout}{second.stderr}")
    return True


def inside(out: Path, networks: int, start_kb: int, step_kb: int) -> None:
    """Run within a namespace of its own, where mounting is allowed."""
    disk = out / "disk"
    size, full, refused = start_kb, 0, 0
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", str(disk)]
    subprocess.run(mount, check=True)  # noqa: S603
    while True:
        root = disk / "run"
        with (out / f"call-{full}.txt").open("w+", encoding="utf-8") as told:
            first = subprocess.Popen(  # noqa: S603
                command(root, networks), stdout=subprocess.DEVNULL, stderr=told
            )
            refused += second_is_refused(root, networks, first)
            code = first.wait()
            told.seek(0)
            text = " ".join(told.read().split())
        if code == 0:
            break
        if code != 4 or f"{root} is full" not in text or "Traceback" in text:
            sys.exit(f"code {code} on a disk of {size} kB:\n{text}")
        full, size = full + 1, size + step_kb
        grow = ["mount", "-o", f"remount,size={size}k", str(disk)]
        subprocess.run(grow, check=True)  # noqa: S603
    shutil.copytree(disk / "run" / "stages", out / "run" / "stages")
    print(f"full {full} times from {start_kb} to {size - step_kb} kB, finished with {size} kB; a "
          f"second process was refused {refused} times", flush=True)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--networks", type=int, default=2)
    parser.add_argument("--start", type=int, default=100, help="kB of the disk at first")
    parser.add_argument("--step", type=int, default=200, help="kB that it grows by")
    parser.add_argument("--reference", type=Path, help="run to compare with; made if not given")
    parser.add_argument("--out", type=Path, default=Path("out/disk"))
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    out = chosen.out.resolve()
    if chosen.inside:
        inside(out, chosen.networks, chosen.start, chosen.step)
        return
    shutil.rmtree(out, ignore_errors=True)
    (out / "disk").mkdir(parents=True)
    reference = chosen.reference or out / "reference"
    run_small(reference, small_config(networks=chosen.networks))
    given = [sys.executable, __file__, *sys.argv[1:], "--inside"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(["unshare", "-rm", *given], env=environment, check=False)  # noqa: S603, S607
    if done.returncode:
        sys.exit(done.returncode)
    expected = content(reference)
    if content(out / "run") != expected:
        sys.exit("the run differs from the reference")
    print(f"{len(expected)} files identical", flush=True)


if __name__ == "__main__":
    main()
