import subprocess
import sys

import surmount.stats

ALONE = """
import sys, types
parent = types.ModuleType("surmount")
parent.__path__ = [sys.argv[1]]  # this room without what the package's own face imports
sys.modules["surmount"] = parent
import surmount.stats
print("scipy.stats" in sys.modules)
"""


def test_the_statistics_are_imported_without_scipy_stats_which_takes_half_a_second():
    room = surmount.stats.__path__[0].removesuffix("stats")
    found = subprocess.run(  # noqa: S603 - our own code
        [sys.executable, "-c", ALONE, room], capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == "False"
