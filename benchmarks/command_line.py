"""Processor time until the command line answers, beside an empty Python and NumPy's import.

    python benchmarks/command_line.py [--repeats N]

Calls take turns; each figure is the median of the processor time (user and system) of a process of
its own with one thread, and its ratio to `python -c pass` in the same run. The first calls warm the
caches and do not count. Ends with 1 where the list of verbs, the version or a mistyped verb takes
0.5 s or more; on a busy machine everything takes longer, and the ratios tell more.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys

from surmount.cli.main import CONFIGURED, VERBS

LIMIT_S = 0.5
LIMITED = ("surmount --help", "surmount --version", "surmount reprodcue")
EMPTY = ("-c", "pass")
CALLS = {
    "python -c pass": EMPTY,
    'python -c "import numpy"': ("-c", "import numpy"),
    'python -c "import surmount"': ("-c", "import surmount"),
    **{
        f"surmount {' '.join(call)}": ("-m", "surmount", *call)
        for call in (
            ["--help"],
            ["--version"],
            ["reprodcue"],
            *([verb, "--help"] for verb in VERBS),
            *([verb, "step", "--help"] for verb in CONFIGURED),
            ["tasks"],
            ["config", "step"],
        )
    },
}


def processor_s(arguments):
    """Return the processor time of a Python process in s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(  # noqa: S603
        [sys.executable, *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        check=False,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=5, help="default: %(default)s")
    repeats = parser.parse_args().repeats
    times = {name: [] for name in CALLS}
    for turn in range(repeats + 1):
        for name, arguments in CALLS.items():
            taken_s = processor_s(arguments)
            if turn:
                times[name].append(taken_s)
    median_s = {name: statistics.median(found) for name, found in times.items()}
    empty_s = median_s["python -c pass"]
    print(f"{'call':36} {'processor time':>14}  of an empty Python")
    for name, taken_s in median_s.items():
        print(f"{name:36} {taken_s:12.3f} s  {taken_s / empty_s:6.1f}")
    return int(any(median_s[name] >= LIMIT_S for name in LIMITED))


if __name__ == "__main__":
    sys.exit(main())
