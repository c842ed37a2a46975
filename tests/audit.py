"""Looks up known vulnerabilities of what ``constraints.txt`` pins.

Where no database can be reached, or it does not answer in time, that is said and nothing fails: a
check of this tree must not depend on the network. A vulnerability that is found fails.
"""

from __future__ import annotations

import importlib.util
import json
import socket
import subprocess
import sys
from pathlib import Path

HOST = "pypi.org"
"""Where pip-audit looks up advisories."""
REACH_S = 2.0
ANSWER_S = 60.0
CONSTRAINTS = Path(__file__).parent.parent / "constraints.txt"


def main() -> int:
    """Return 1 if a vulnerability is known, else 0."""
    if importlib.util.find_spec("pip_audit") is None:
        return _skip("pip-audit is not installed")
    try:
        socket.create_connection((HOST, 443), timeout=REACH_S).close()
    except OSError as error:
        return _skip(f"{HOST} cannot be reached ({error})")
    command = [sys.executable, "-m", "pip_audit", "--requirement", str(CONSTRAINTS), "--no-deps",
               "--disable-pip", "--format", "json", "--progress-spinner", "off"]  # fmt: skip
    try:
        done = subprocess.run(  # noqa: S603
            command, capture_output=True, text=True, check=False, timeout=ANSWER_S
        )
        packages = json.loads(done.stdout)["dependencies"]
    except (subprocess.TimeoutExpired, ValueError, KeyError) as error:
        return _skip(f"no answer from the database ({type(error).__name__})")
    found = [
        f"{package['name']} {package['version']}: {advisory['id']}, "
        f"corrected in {', '.join(advisory['fix_versions']) or 'no version yet'}"
        for package in packages
        for advisory in package.get("vulns", [])
    ]
    print("\n".join(found) or f"{len(packages)} packages, no known vulnerability")
    return int(bool(found))


def _skip(reason: str) -> int:
    print(f"Dependencies were not audited: {reason}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
