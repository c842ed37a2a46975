"""Disks, permissions, clocks, impatient users: each is told, nothing is lost or overwritten."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from small import SMALL, content, run_small, small_config

from surmount.core.records import read_record, write_record
from surmount.workflow.store import sole_user

OPTIONS = [f"--set={key}={json.dumps(value)}" for key, value in SMALL.items()]
HANGING_S = 1800.0
"""Whoever waits longer waits in vain: far more than the slowest machine takes."""
COMMAND = [sys.executable, "-c", "from surmount.cli.main import main; main()", "reproduce"]


def namespace_is_possible() -> bool:
    if shutil.which("unshare") is None:
        return False
    done = subprocess.run(["unshare", "-rm", "true"], capture_output=True, check=False)  # noqa: S607
    return done.returncode == 0


needs_mounts = pytest.mark.skipif(
    not namespace_is_possible(), reason="this system lets no user mount: `unshare -rm` fails"
)


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    root = tmp_path_factory.mktemp("expected")
    run_small(root, small_config())
    return content(root)


def reproduce(root: Path, *options: str) -> list[str]:
    return [*COMMAND, "narrow-channel", "--out", str(root), *OPTIONS, *options]


def in_namespace(script: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run a shell script that may mount, with arguments from $1 on."""
    return subprocess.run(  # noqa: S603
        ["unshare", "-rm", "sh", "-c", script, "sh", *map(str, arguments)],  # noqa: S607
        capture_output=True,
        text=True,
        check=False,
    )


@needs_mounts
@pytest.mark.slow
def test_a_full_disk_is_told_and_with_more_space_the_run_goes_on(expected, tmp_path):
    """A disk of 300 kB takes the first networks and no more; then it grows."""
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    disk.mkdir()
    script = (
        'disk=$1; kept=$2; shift 2; mount -t tmpfs -o size=300k none "$disk" || exit 99; '
        '"$@"; echo "code $?"; mount -o remount,size=64m "$disk"; "$@"; echo "code $?"; '
        'cp -r "$disk/run" "$kept"'
    )
    done = in_namespace(script, disk, kept, *reproduce(disk / "run", "--processes", "0"))
    assert done.stdout.count("code 4") == 1, done.stdout + done.stderr
    assert done.stdout.count("code 0") == 1, done.stdout + done.stderr
    assert f"{disk}/run is full" in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.stderr
    assert content(kept) == expected


@needs_mounts
def test_a_read_only_folder_is_told(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    script = 'disk=$1; shift; mount -t tmpfs -o ro none "$disk" || exit 99; "$@"'
    done = in_namespace(script, disk, *reproduce(disk / "run", "--processes", "0"))
    assert done.returncode == 4
    assert f"{disk}/run is read-only" in done.stderr
    assert "Choose an --out folder that can be written." in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(os.geteuid() == 0, reason="the administrator may write everywhere")
def test_a_folder_without_permission_is_told(tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    done = subprocess.run(  # noqa: S603
        reproduce(locked / "run"), capture_output=True, text=True, check=False
    )
    assert done.returncode == 4
    assert "may not be written" in done.stderr


def test_a_second_process_on_the_folder_is_refused_and_changes_nothing(tmp_path):
    with sole_user(tmp_path):
        done = subprocess.run(  # noqa: S603
            reproduce(tmp_path), capture_output=True, text=True, check=False
        )
    assert done.returncode == 4
    assert f"Another process is working in {tmp_path}" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == [".lock"]


@pytest.mark.slow
def test_clocks_that_go_back_change_nothing(expected, tmp_path, monkeypatch):
    """The clock of the system runs backwards, and files come from the future."""
    moments = iter(range(2_000_000_000, 0, -3600))
    monkeypatch.setattr(time, "time", lambda: float(next(moments)))
    first = small_config()
    run_small(tmp_path, first)
    for path in tmp_path.rglob("*"):
        os.utime(path, (4e9, 4e9))
    shutil.rmtree(tmp_path / "stages" / "test-control")
    _, watcher = run_small(tmp_path, first)
    assert sorted(watcher.started) == ["test-control/network-0", "test-control/network-1"]
    assert content(tmp_path) == expected
    assert all(seconds >= 0 for seconds in read_record(tmp_path / "timings.json").values())


@pytest.mark.slow
def test_one_ctrl_c_saves_and_two_end_at_once_and_the_run_goes_on(expected, tmp_path):
    root, told = tmp_path / "run", tmp_path / "told"
    with told.open("w", encoding="utf-8") as output:
        process = subprocess.Popen(  # noqa: S603
            reproduce(root, "--processes", "2"),
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    wait_until(lambda: any(root.glob("checkpoints/**/*.safetensors")))
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: the workers get it too
    wait_until(lambda: "Ctrl-C again ends at once" in told.read_text(encoding="utf-8"))
    os.killpg(process.pid, signal.SIGINT)
    process.wait(timeout=HANGING_S)
    assert process.returncode == 130, told.read_text(encoding="utf-8")
    assert "Traceback" not in told.read_text(encoding="utf-8")
    assert not list(root.rglob("*.json.*.tmp"))
    wait_until(lambda: not _group_lives(process.pid))  # no worker is left behind
    run_small(root, small_config())
    assert content(root) == expected


def wait_until(moment: Callable[[], bool]) -> None:
    """Wait for a moment that comes sooner or later, and fail if it does not."""
    given_up = time.monotonic() + HANGING_S
    while not moment():
        assert time.monotonic() < given_up
        time.sleep(0.02)


def _group_lives(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("threads", [2, 5])
def test_any_number_of_threads_and_processes_gives_the_same_bytes(expected, tmp_path, threads):
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    program = Path(__file__).parents[1] / "support" / "small_program.py"
    for processes in (0, threads):
        root = tmp_path / f"processes-{processes}"
        subprocess.run(  # noqa: S603
            [sys.executable, str(program), str(root), json.dumps({"processes": processes})],
            env=os.environ | dict.fromkeys(names, str(threads)),
            check=True,
        )
        assert content(root) == expected


def test_a_damaged_journal_costs_timings_and_nothing_else(tmp_path):
    run_small(tmp_path, small_config(networks=1))
    made = content(tmp_path)
    (tmp_path / "timings.json").write_text("{", encoding="utf-8")
    write_record(tmp_path / "restarts.json", {"analysis": "many"})
    (tmp_path / "index.json").unlink()
    _, watcher = run_small(tmp_path, small_config(networks=1))
    assert watcher.started == []
    assert content(tmp_path) == made
    assert len(read_record(tmp_path / "index.json")["stages"]) == len(made)
