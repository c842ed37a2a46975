"""Files from strangers are data: refused with a sentence, nothing executed, nothing let out."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import struct
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from example_trials import two_behaviours
from small import content, run_first_stages, small_config

from surmount.cli.main import run
from surmount.core.errors import InputError, IntegrityError, OutputError, SurmountError
from surmount.core.records import read_record, write_atomically, write_record
from surmount.envs.registry import find_family
from surmount.learn.rollouts import Actor
from surmount.learn.snapshot import Snapshot
from surmount.report.figures.stills import csv_text
from surmount.rstar.course.config import EnvConfig
from surmount.tasks.curriculum import Curriculum
from surmount.trials.table import read_trials, write_trials
from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.object_store import ObjectStore
from surmount.workflow.run_folder import open_run
from surmount.workflow.store import LocalStore, sole_user

KEY = "k" * 64


class Payload:
    """Pickled, it writes a file when it is loaded."""

    def __init__(self, path: Path) -> None:
        self._path = str(path)

    def __reduce__(self):
        return Path.touch, (Path(self._path),)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return run_first_stages(tmp_path_factory.mktemp("run"), small_config())


@pytest.fixture
def copied(finished, tmp_path):
    return Path(shutil.copytree(finished, tmp_path / "run"))


def call(capsys, *arguments) -> tuple[int, str]:
    code = run([str(argument) for argument in arguments])
    err = capsys.readouterr().err
    assert "Traceback" not in err
    return code, err


@pytest.mark.parametrize(
    "name", ["trials.parquet", "trials.csv", "curriculum.json", "network.safetensors"]
)
@pytest.mark.parametrize("packed", [False, True], ids=["pickle", "zip"])
def test_a_pickle_by_any_name_is_refused_and_not_loaded(capsys, tmp_path, name, packed):
    mark, path = tmp_path / "executed", tmp_path / name
    hostile = pickle.dumps(Payload(mark))
    if packed:  # as PyTorch saves
        with zipfile.ZipFile(path, "w") as file:
            file.writestr("archive/data.pkl", hostile)
    else:
        path.write_bytes(hostile)
    calls = {
        "trials.parquet": ["analyze", path, "--out", tmp_path / "out"],
        "trials.csv": ["analyze", path, "--out", tmp_path / "out"],
        "curriculum.json": ["show", path],
        "network.safetensors": ["render", path, "--task", "step", "--out", tmp_path / "a.png"],
    }
    code, err = call(capsys, *calls[name])
    assert code == 3
    assert name in err
    assert not mark.exists()
    assert not (tmp_path / "out").exists()


def test_yaml_with_tags_is_no_configuration(capsys, tmp_path):
    path = tmp_path / "config.yaml"
    path.write_text(f"seed: !!python/object/apply:pathlib.Path.touch [{tmp_path}/executed]\n")
    code, err = call(capsys, "config", "step", "--config", path)
    assert code == 2
    assert "read as TOML" in err
    assert not (tmp_path / "executed").exists()


@pytest.mark.parametrize("device", ["/dev/zero", "pipe"])
@pytest.mark.parametrize("verb", ["config", "show", "analyze"])
def test_what_never_ends_is_not_read(capsys, tmp_path, device, verb):
    if device == "pipe":
        path = tmp_path / "pipe.json"
        os.mkfifo(path)
    else:
        path = Path(device)
    options = {
        "config": ["config", "step", "--config", path],
        "show": ["show", path],
        "analyze": ["analyze", path, "--out", tmp_path / "out"],
    }
    code, err = call(capsys, *options[verb])
    assert code in (2, 3)
    assert "file" in err


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 20_000, "[1e999999]", '{"a": NaN}'])
def test_absurd_json_is_refused(capsys, tmp_path, text):
    path = tmp_path / "curriculum.json"
    path.write_text(text, encoding="utf-8")
    code, err = call(capsys, "show", path)
    assert code == 3
    assert str(path) in err


def test_a_record_may_begin_with_a_byte_order_mark(tmp_path):
    write_record(tmp_path / "r.json", {"a": 1})
    marked = b"\xef\xbb\xbf" + (tmp_path / "r.json").read_bytes()
    (tmp_path / "r.json").write_bytes(marked)
    assert read_record(tmp_path / "r.json") == {"a": 1}


@pytest.mark.parametrize(
    "record",
    [
        {"level_tests": 3},
        {"level_tests": []},
        {"level_tests": ["a"], "steps": 1},
        {"level_tests": [{}], "steps": 1},
        {"level_tests": [{"sentence": "a"}], "steps": "b"},
    ],
)
def test_what_is_no_training_is_not_shown_as_one(capsys, tmp_path, record):
    write_record(tmp_path / "training.json", record)
    code, said = call(capsys, "show", tmp_path / "training.json")
    assert code == 3
    assert "training.json is no record of a training" in said


def test_absurd_depth_in_toml_is_refused(capsys, tmp_path):
    path = tmp_path / "c.toml"
    path.write_text("seed = " + "[" * 50_000, encoding="utf-8")
    assert call(capsys, "config", "step", "--config", path)[0] == 2


def test_few_bytes_that_stand_for_many_rows_are_refused(capsys, tmp_path, monkeypatch):
    path = tmp_path / "bomb.parquet"
    columns = {"variant": 0.0, "network": 0, "trial": 0, "success": 0, "x": 1.0}
    rows = {name: pl.repeat(value, 2_000_000) for name, value in columns.items()}
    pl.select(**rows).write_parquet(path, compression="zstd")
    assert path.stat().st_size < 100_000
    pages = {"SC_PHYS_PAGES": 15_000, "SC_PAGE_SIZE": 4096}  # 61 MB; the table needs 80 MB
    monkeypatch.setattr("surmount.trials.source.os.sysconf", pages.__getitem__)
    code, err = call(capsys, "analyze", path, "--out", tmp_path / "out")
    assert code == 3
    assert "2,000,000 rows of 5 columns" in err


def test_a_header_that_promises_too_much_is_refused(tmp_path):
    path = tmp_path / "network.safetensors"
    header = json.dumps({"w": {"dtype": "F32", "shape": [2**40], "data_offsets": [0, 2**42]}})
    path.write_bytes(struct.pack("<Q", len(header)) + header.encode() + b"0" * 64)
    with pytest.raises(InputError, match="not a network"):
        Snapshot.load(path)
    path.write_bytes(struct.pack("<Q", 2**62) + b"{}")
    with pytest.raises(InputError, match="not a network"):
        Snapshot.load(path)


@pytest.mark.parametrize(
    "change",
    [
        {"hidden_layers": [10**12, 10**12]},
        {"hidden_layers": "all"},
        {"activation": "__import__('os')"},
        {"normalise_observations": "no"},
    ],
)
def test_a_network_whose_record_lies_is_refused_before_it_is_built(finished, change):
    (path,) = finished.glob("stages/initiation/network-0/*/network.safetensors")
    network = Snapshot.load(path)
    env = find_family("narrow-channel").trial_env(EnvConfig(), 1)
    lying = replace(network, record={**network.record, **change})
    with pytest.raises(InputError, match="record describes"):
        Actor(lying, env.single_observation_space, env.single_action_space)
    env.close()


def test_paths_that_lead_out_are_not_followed(copied, tmp_path):
    """An index is only a help: what is wrong with it is put right from the folders themselves."""
    held = open_run(copied).stages
    shutil.copytree(held["trials/network-0"].folder, tmp_path / "planted")
    for folder in ("../planted", str(tmp_path / "planted"), "stages/../../planted", "x" * 5000):
        write_record(copied / "index.json", {"schema": 1, "stages": {"trials/network-0": folder}})
        assert open_run(copied).stages == held
    write_record(copied / "index.json", {"schema": 1, "stages": {"x" * 5000: "stages"}})
    assert open_run(copied).stages == held


@pytest.mark.parametrize("name", ["../escaped", "/escaped", "a/../../escaped", "a\\..\\b", ""])
def test_a_manifest_cannot_name_files_outside_its_folder(tmp_path, name):
    far, near = LocalStore(tmp_path / "far"), LocalStore(tmp_path / "near" / "deep")
    workspace = far.workspace("stage", KEY)
    (workspace / "file").write_text("x", encoding="utf-8")
    artefact = far.commit(workspace, "stage", KEY, inputs={})
    path = artefact.folder / "manifest.json"
    manifest = read_record(path)
    manifest["files"] = {name: manifest["files"]["file"]}
    write_record(path, manifest)
    with pytest.raises(IntegrityError):
        far.find("stage", KEY)
    with pytest.raises(IntegrityError):
        ObjectStore(f"file://{tmp_path}/far").pull("stage", KEY, near)
    assert not list((tmp_path / "near").rglob("*escaped*"))


def test_a_link_in_the_output_folder_is_refused_and_not_followed(capsys, copied, tmp_path):
    outside = tmp_path / "outside"
    outside.mkdir()
    for name in ("figures", "logs/elsewhere", "stages/planted"):
        link = copied / name
        link.parent.mkdir(exist_ok=True)
        link.symlink_to(outside)
        with pytest.raises(OutputError, match="is a link") as caught, sole_user(copied):
            pass
        assert str(link) in caught.value.message
        assert call(capsys, "report", copied)[0] == 4
        link.unlink()
    assert not list(outside.iterdir())


def test_a_link_planted_for_a_temporary_file_is_not_followed(tmp_path, monkeypatch):
    victim = tmp_path / "victim"
    victim.write_text("precious", encoding="utf-8")
    monkeypatch.setattr("secrets.token_hex", lambda _: "guessed")
    (tmp_path / ".record.json.guessed.tmp").symlink_to(victim)
    with pytest.raises(FileExistsError):
        write_atomically(tmp_path / "record.json", b"{}")
    assert victim.read_text(encoding="utf-8") == "precious"


def test_a_stage_that_is_a_link_is_refused(copied, tmp_path):
    (folder,) = copied.glob("stages/trials/network-0/*")
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    key = read_record(folder / "manifest.json")["key"]
    with pytest.raises(IntegrityError, match="is a link"):
        LocalStore(copied).find("trials/network-0", key)


HOSTILE = "<img src=x onerror=alert(1)></script><script>alert(2)</script>"


def test_markup_in_names_is_shown_and_not_taken_for_markup(capsys, tmp_path):
    trials = replace(two_behaviours(), feature_names=(HOSTILE, "=cmd|'/c calc'!A0"))
    write_trials(tmp_path / "trials.parquet", trials)
    out = tmp_path / "out"
    options = ["--set", "components=2", "--set", "bootstrap=0"]
    code, _ = call(capsys, "analyze", tmp_path / "trials.parquet", "--out", out, *options)
    assert code == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "<img src=x" not in page
    assert "<script>alert" not in page
    for path in (out / "figures").glob("*.csv"):
        for line in path.read_text(encoding="utf-8").splitlines():
            assert not any(cell.lstrip('"').startswith("=") for cell in line.split(","))
    assert call(capsys, "show", out, "--why")[0] == 0


def test_no_cell_of_a_csv_is_a_formula():
    text = csv_text({"=1+1": ["+1", "@SUM(A1)", "-x", "\tx", "fine"], "n": [-1.5, 2, None, 0, 1]})
    assert text.splitlines() == ["'=1+1,n", "'+1,-1.5", "'@SUM(A1),2", "'-x,", "'\tx,0", "fine,1"]


@pytest.mark.parametrize("name", ["a\x1b[2Jb", "a\nb", "a\u202eb", "x" * 201])
def test_names_that_act_on_a_terminal_are_refused(tmp_path, name):
    trials = two_behaviours()
    names = (name, *trials.feature_names[1:])
    write_trials(tmp_path / "t.parquet", replace(trials, feature_names=names))
    with pytest.raises(InputError, match="control characters"):
        read_trials(tmp_path / "t.parquet")
    record = {
        "kind": "surmount curriculum",
        "schema": 1,
        "parameters": [name],
        "success_threshold": 0.95,
        "groups": [],
        "levels": [],
    }
    write_record(tmp_path / "c.json", record)
    with pytest.raises(InputError, match="parameters"):
        Curriculum.load(tmp_path / "c.json")


def test_an_object_store_in_memory_keeps_and_gives_back_the_same_bytes(tmp_path):
    here = ArtefactStore(root=tmp_path / "here", url="memory://run")
    workspace = here.store.workspace("stage", KEY)
    (workspace / "file").write_bytes(b"data")
    made = here.commit(workspace, "stage", KEY, inputs={})
    there = ArtefactStore(root=tmp_path / "there", url="memory://run")
    found = there.find("stage", KEY)
    assert found is not None
    assert found.content_hash == made.content_hash
    assert content(tmp_path / "there") == content(tmp_path / "here")
    checkpoints = here.checkpoints("other", KEY)
    (checkpoints.folder / "state").write_bytes(b"half way")
    checkpoints.save()
    assert (there.checkpoints("other", KEY).folder / "state").read_bytes() == b"half way"


def test_a_file_changed_in_the_object_store_is_refused(tmp_path):
    here = ArtefactStore(root=tmp_path / "here", url=f"file://{tmp_path}/store")
    workspace = here.store.workspace("stage", KEY)
    (workspace / "file").write_bytes(b"data")
    here.commit(workspace, "stage", KEY, inputs={})
    (stored,) = (tmp_path / "store").rglob("file")
    stored.write_bytes(b"dat4")
    with pytest.raises(IntegrityError, match="object store was changed") as caught:
        ArtefactStore(root=tmp_path / "there", url=here.url).find("stage", KEY)
    assert "Delete" in caught.value.remedy
    assert not list((tmp_path / "there").rglob("manifest.json"))


@pytest.mark.parametrize("url", ["nonsense://x", "s3://"])
def test_an_object_store_that_cannot_be_used_is_told_in_a_sentence(tmp_path, url):
    with pytest.raises(SurmountError) as caught:
        ObjectStore(url).has("stage", KEY)
    assert caught.value.remedy


def test_a_run_and_its_report_open_no_connection(tmp_path):
    program = """
import socket, sys
def refuse(*_):
    raise AssertionError("a connection was opened")
socket.socket.connect = socket.socket.connect_ex = socket.create_connection = refuse
sys.path[:0] = sys.argv[2:]
from pathlib import Path
from small import run_first_stages, small_config
from surmount.report.pages import write_report
write_report(run_first_stages(Path(sys.argv[1]), small_config()))
"""
    here = Path(__file__).parent
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program, str(tmp_path / "run"), str(here / "support")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert np.any([path.suffix == ".html" for path in (tmp_path / "run").iterdir()])
