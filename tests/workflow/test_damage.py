"""What is damaged in a run's folder is named, with what to delete, before anything is trained."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from small import run_first_stages, small_config
from toy_runs import Observer, graph, run

from surmount.cli.main import run as surmount
from surmount.core.configuration import to_record
from surmount.core.errors import IntegrityError, OutputError
from surmount.core.records import SEAL, read_record, write_record
from surmount.experiment.running import begin, load_config, refuse_other
from surmount.workflow.in_process import InProcessExecutor
from surmount.workflow.object_store import ObjectStore
from surmount.workflow.opening import opened
from surmount.workflow.run_folder import open_run
from surmount.workflow.runner import GraphRunner
from surmount.workflow.store import LocalStore, sole_user

KEY = "c" * 64


def change_a_digit(path: Path, of: str) -> None:
    """Change the first digit after a text by one."""
    text = path.read_text(encoding="utf-8")
    start = text.index(of) + len(of)
    place = next(index for index in range(start, len(text)) if text[index].isdecimal())
    other = str((int(text[place]) + 1) % 10)
    path.write_text(text[:place] + other + text[place + 1 :], encoding="utf-8")


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:40])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def remove(path: Path) -> None:
    path.unlink()


def a_digit_of(what: str) -> Callable[[Path], None]:
    return lambda path: change_a_digit(path, what)


def break_seal(path: Path) -> None:
    path.write_text(path.read_text().replace(SEAL, f"{SEAL[:-1]}7"))


@pytest.mark.parametrize(
    "damage", [a_digit_of('"n.json"'), a_digit_of('"key"'), break_seal, truncate, empty, remove]
)
def test_a_damaged_manifest_is_named_and_nothing_is_run(tmp_path, damage):
    outcome, _ = run(tmp_path, graph())
    folder = outcome.artefacts["part/1"].folder
    damage(folder / "manifest.json")
    observer = Observer()
    runner = GraphRunner(tmp_path, graph(), InProcessExecutor(observer.listen), observer)
    with pytest.raises(IntegrityError, match=r"part/1.*manifest\.json") as caught:
        runner.run()
    assert caught.value.remedy.startswith(f"Delete {folder} and run again")
    assert observer.started == []
    with pytest.raises(IntegrityError, match=r"manifest\.json"):
        opened(folder / "n.json")
    shutil.rmtree(folder)  # as the remedy says
    again, observer = run(tmp_path, graph())
    assert observer.started == ["part/1"]
    assert again.artefacts == outcome.artefacts


def test_a_manifest_of_before_there_were_hashes_is_read(tmp_path):
    outcome, _ = run(tmp_path, graph())
    for path in tmp_path.rglob("manifest.json"):
        record = read_record(path)
        del record[SEAL]
        write_record(path, record)
    again, observer = run(tmp_path, graph())
    assert observer.started == []
    assert again.artefacts == outcome.artefacts
    change_a_digit(path, '"n.json"')  # its file does not fit it then
    with pytest.raises(IntegrityError, match=r"n\.json was changed"):
        run(tmp_path, graph())


def test_what_is_kept_is_verified_before_anything_is_started(tmp_path):
    outcome, _ = run(tmp_path, graph())
    shutil.rmtree(outcome.artefacts["part/0"].folder)
    path = outcome.artefacts["part/2"].folder / "n.json"
    path.write_text(path.read_text().replace("2", "3"), encoding="utf-8")
    observer = Observer()
    runner = GraphRunner(tmp_path, graph(), InProcessExecutor(observer.listen), observer)
    with pytest.raises(IntegrityError, match=r"part/2.*n\.json"):
        runner.run()
    assert observer.started == []


def test_what_was_finished_and_no_longer_fits_is_told_before_anything_is_started(tmp_path):
    run(tmp_path, graph(n=1))

    class Order(Observer):
        def stage_outdated(self, stage, folders):
            super().stage_outdated(stage, folders)
            assert self.started == [] or stage == "total"
            assert all(folder.is_dir() for folder in folders)

    observer = Order()
    GraphRunner(tmp_path, graph(n=5), InProcessExecutor(observer.listen), observer).run()
    assert observer.outdated == ["part/1", "part/2", "total"]


def test_workspaces_and_half_written_files_of_the_killed_are_cleared(tmp_path):
    run(tmp_path, graph())
    store = LocalStore(tmp_path)
    left = [store.workspace("part/1", KEY), store.workspace("elsewhere/deep", KEY)]
    (left[0] / "half").write_text("written", encoding="utf-8")
    half = tmp_path / "checkpoints" / "part" / ".training.safetensors.0123abcd.tmp"
    half.parent.mkdir(parents=True, exist_ok=True)
    half.write_bytes(b"half")
    mine = tmp_path / "notes.tmp"
    mine.write_text("mine", encoding="utf-8")
    made = {path: path.read_bytes() for path in tmp_path.glob("stages/**/*.json")}
    with sole_user(tmp_path):
        assert not any(path.exists() for path in (*left, half))
    assert mine.exists()
    assert {path: path.read_bytes() for path in tmp_path.glob("stages/**/*.json")} == made


def test_a_workspace_that_was_cleared_and_made_again_is_not_published(tmp_path):
    store = LocalStore(tmp_path)
    workspace = store.workspace("one", KEY)
    (workspace / "first").write_text("x", encoding="utf-8")
    shutil.rmtree(workspace)
    write_record(workspace / "second", {})  # makes the folder again
    with pytest.raises(FileNotFoundError):
        store.commit(workspace, "one", KEY, inputs={})
    assert store.find("one", KEY) is None


@pytest.mark.parametrize("part", ["", "stages/part/0"])
@pytest.mark.parametrize("again", [False, True], ids=["gone", "made again"])
def test_a_folder_that_is_removed_meanwhile_is_noticed_at_the_next_publication(
    tmp_path, part, again
):
    root = tmp_path / "run"

    class Removing(Observer):
        def stage_finished(self, artefact, seconds):
            super().stage_finished(artefact, seconds)
            if len(self.finished) == 1:
                shutil.rmtree(root / part)
                if again:
                    (root / part).mkdir(parents=True)

    observer = Removing()
    executor = InProcessExecutor(observer.listen)
    with pytest.raises(OutputError, match="was removed or replaced") as caught:
        GraphRunner(root, graph(), executor, observer).run()
    assert str(root / part) in caught.value.message
    assert len(observer.started) == 2


# A run of the laboratory, through the command line ---------------------------------------------


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    config = small_config(networks=1)
    root = run_first_stages(tmp_path_factory.mktemp("run"), config, stages=3)
    assert set(open_run(root).stages) == {"initiation/network-0", "trials/network-0", "analysis"}
    return root


@pytest.fixture
def copied(finished, tmp_path):
    return Path(shutil.copytree(finished, tmp_path / "run"))


def told(capsys, *arguments) -> tuple[int, str]:
    code = surmount([str(argument) for argument in arguments])
    printed = capsys.readouterr()
    assert "Traceback" not in printed.err
    return code, printed.err


DAMAGED = {
    "curriculum": ("analysis/*/curriculum.json", a_digit_of('"weight')),
    "analysis": ("analysis/*/analysis.json", a_digit_of('"bic"')),
    "network": (
        "initiation/network-0/*/network.safetensors",
        lambda path: path.write_bytes(path.read_bytes()[:-1] + b"\x07"),
    ),
}


@pytest.mark.parametrize("by", ["file", "folder"])
@pytest.mark.parametrize(
    ("what", "options"),
    [
        ("curriculum", ["show"]),
        ("analysis", ["show", "--why"]),
        ("curriculum", ["export", "--to", "csv"]),
        ("network", ["export", "--to", "acting"]),
        ("network", ["evaluate", "--repetitions", "1"]),
        ("analysis", ["report"]),
        ("network", ["reproduce", "--resume", "--processes", "0"]),
    ],
)
def test_every_verb_refuses_what_does_not_fit_its_hash(capsys, copied, tmp_path, what, options, by):
    pattern, damage = DAMAGED[what]
    (path,) = (copied / "stages").glob(pattern)
    damage(path)
    verb, *rest = options
    if verb == "export":
        rest += ["--out", str(tmp_path / "out")]
    if verb == "reproduce":
        given = [verb, "--out", copied, *rest]
    elif verb == "report" or (verb == "show" and by == "folder"):
        given = [verb, copied, *rest]
    else:
        given = [verb, path, *rest]
    code, err = told(capsys, *given)
    assert code == 5, err
    assert path.name in err.replace("\n", " ")
    assert "Delete" in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("damage", [a_digit_of('"initial_steps"'), truncate, empty, break_seal])
def test_a_damaged_record_of_a_run_is_named_and_the_way_out_works(capsys, copied, damage):
    damage(copied / "run.json")
    for given in (["reproduce", "--resume", "--out", copied], ["report", copied], ["show", copied]):
        code, err = told(capsys, *given)
        assert code == 5
        assert f"Delete {copied / 'run.json'}" in err
    with pytest.raises(IntegrityError):
        refuse_other(copied, small_config(networks=1))
    (copied / "run.json").unlink()  # as the remedy says
    begin(copied, small_config(networks=1))
    assert load_config(copied) == small_config(networks=1)
    assert len(open_run(copied).stages) == 3


def test_a_record_of_before_there_were_hashes_is_read(copied):
    write_record(
        copied / "run.json",
        {"schema": 1, "config": to_record(load_config(copied)), "versions": {}, "machine": {}},
    )
    assert load_config(copied) == small_config(networks=1)


def test_a_torn_manifest_in_an_object_store_is_sent_again(tmp_path):
    store, url = LocalStore(tmp_path / "here"), f"file://{tmp_path}/store"
    workspace = store.workspace("stage", KEY)
    (workspace / "file").write_bytes(b"data")
    made = store.commit(workspace, "stage", KEY, inputs={})
    remote = ObjectStore(url)
    remote.push(made)
    (path,) = (tmp_path / "store").rglob("manifest.json")
    whole = path.read_bytes()
    path.write_bytes(whole[:50])
    assert not remote.has("stage", KEY)
    assert remote.pull("stage", KEY, LocalStore(tmp_path / "there")) is None
    remote.push(made)
    assert path.read_bytes() == whole
    change_a_digit(path, '"key"')
    with pytest.raises(IntegrityError, match="in the object store"):
        remote.pull("stage", KEY, LocalStore(tmp_path / "there"))


def test_a_store_that_keeps_a_part_of_a_file_is_noticed_when_it_is_sent(tmp_path, monkeypatch):
    store = LocalStore(tmp_path / "here")
    workspace = store.workspace("stage", KEY)
    (workspace / "file").write_bytes(b"data")
    made = store.commit(workspace, "stage", KEY, inputs={})
    remote = ObjectStore(f"file://{tmp_path}/store")

    def torn(source, target):
        Path(target).write_bytes(Path(source).read_bytes()[:2])

    monkeypatch.setattr(remote._files, "put_file", torn)
    with pytest.raises(OutputError, match="2 of 4 bytes have arrived"):
        remote.push(made)
    assert not remote.has("stage", KEY)


@pytest.mark.parametrize("text", ['{"a": 1, "a": 2}', '{"b": {"a": 1, "a": 1}}', '{"a": 1e999}'])
def test_json_that_readers_take_differently_is_refused(capsys, tmp_path, text):
    path = tmp_path / "curriculum.json"
    path.write_text(text, encoding="utf-8")
    assert json.loads(text)  # Python's own reader takes it
    code, err = told(capsys, "show", path)
    assert code == 3
    assert "twice" in err or "beyond the range" in err
