"""A real Ray cluster on loopback: a head without cores, and workers' nodes of one core each."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

NODE_OPTIONS = ("--object-store-memory=80000000", "--disable-usage-stats", "--block")
START_S = 1800.0


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def ray_cluster(workers: int):
    """Start a head and so many nodes that know one secret; yields address and environment."""
    folder = tempfile.mkdtemp(prefix="ray", dir="/tmp")
    port = free_port()
    address = f"127.0.0.1:{port}"
    head = [
        "--head",
        f"--port={port}",
        "--num-cpus=0",
        "--include-dashboard=false",
        f"--temp-dir={folder}",
        "--node-ip-address=127.0.0.1",
    ]
    environment = os.environ | {
        "RAY_AUTH_MODE": "token",
        "RAY_AUTH_TOKEN": secrets.token_hex(32),
        "RAY_worker_niceness": "0",  # Ray would give way to everything else
        "RAY_USAGE_STATS_ENABLED": "0",
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    node = [f"--address={address}", "--num-cpus=1", "--node-ip-address=127.0.0.1"]
    processes: list[subprocess.Popen] = []
    try:
        for number, options in enumerate([head, *[node] * workers]):
            log = Path(folder) / f"node-{number}.log"
            processes.append(_start(options, log, environment))
        yield address, environment
    finally:
        for process in reversed(processes):
            _end(process)
        shutil.rmtree(folder, ignore_errors=True)


def workers_at(title: str) -> list[int]:
    """Return the processes of Ray whose title begins so: ``"ray::initiation/network-0"``."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            if path.read_bytes().decode(errors="replace").startswith(title):
                found.append(int(path.parent.name))
    return found


def _start(options: list[str], log: Path, environment: dict[str, str]) -> subprocess.Popen:
    """Start a node and wait until it says that it runs."""
    program = Path(sys.executable).with_name("ray")
    with log.open("wb") as file:
        process = subprocess.Popen(  # noqa: S603
            [str(program), "start", *options, *NODE_OPTIONS],
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env=environment,
        )
    deadline = time.monotonic() + START_S
    while time.monotonic() < deadline and process.poll() is None:
        if "Ray runtime started" in log.read_text(errors="replace"):
            return process
        time.sleep(0.1)
    _end(process)
    raise RuntimeError(log.read_text(errors="replace"))


def _end(process: subprocess.Popen) -> None:
    """End a node and everything it started: first asked, then killed."""
    with contextlib.suppress(ProcessLookupError, subprocess.TimeoutExpired):
        os.killpg(process.pid, signal.SIGTERM)
        process.wait(timeout=10)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
