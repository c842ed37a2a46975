"""On a real Ray cluster the protocol survives the death of a worker, and gives the same bytes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small import content, run_small, small_config

pytest.importorskip("ray", reason="Ray is not installed: pip install 'surmount[cluster]'")
from ray_head import ray_cluster, workers_at

PROGRAM = Path(__file__).parents[1] / "support" / "small_program.py"
VICTIM = "curriculum/network-0"
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def cluster():
    with ray_cluster(workers=2) as found:
        yield found


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    root = tmp_path_factory.mktemp("here")
    run_small(root, small_config())
    return content(root)


def start(cluster, root: Path, **options) -> subprocess.Popen:
    address, environment = cluster
    given = {"processes": None, "kind": "ray", "address": address, **options}
    return subprocess.Popen(  # noqa: S603
        [sys.executable, str(PROGRAM), str(root), json.dumps(given)], env=environment
    )


def watched(root: Path) -> dict:
    return json.loads((root / "watched.json").read_text(encoding="utf-8"))


def test_a_worker_killed_in_mid_stage_changes_no_byte(cluster, expected, tmp_path):
    root = tmp_path / "run"
    driver = start(cluster, root)
    deadline = time.monotonic() + 1800
    killed = False
    while not killed and driver.poll() is None and time.monotonic() < deadline:
        begun = list(
            root.glob(f"checkpoints/{VICTIM}/*/training.safetensors")
        )  # it has saved itself: mid-stage
        for pid in workers_at(f"ray::{VICTIM}") if begun else []:
            os.kill(pid, signal.SIGKILL)
            killed = True
        time.sleep(0.01)
    assert driver.wait(timeout=1800) == 0
    assert killed
    assert watched(root)["lost"] == [VICTIM]
    assert json.loads((root / "restarts.json").read_text()) == {VICTIM: 1}
    resumed = [said for stage, said in watched(root)["said"] if stage == VICTIM]
    assert any(said.startswith("went on from the checkpoint") for said in resumed)
    assert content(root) == expected


def test_workers_that_do_not_see_the_folder_work_through_an_object_store(
    cluster, expected, tmp_path
):
    root = tmp_path / "run"
    driver = start(cluster, root, url=f"file://{tmp_path}/store")
    assert driver.wait(timeout=1800) == 0
    assert content(root) == expected
    assert content(tmp_path / "store") == expected
