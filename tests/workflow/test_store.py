"""The store publishes whole stages, finds them by key, and notices every change to a file."""

from __future__ import annotations

import os
import pickle

import pytest

from surmount.core.errors import IntegrityError, OutputError, SurmountError
from surmount.core.records import read_record, write_record
from surmount.workflow.store import LocalStore, output_errors, sole_user


@pytest.fixture
def store(tmp_path):
    return LocalStore(tmp_path)


def publish(store, content=b"data", key="k" * 64):
    workspace = store.workspace("stage/one", key)
    (workspace / "file.bin").write_bytes(content)
    return store.commit(workspace, "stage/one", key, inputs={})


def test_a_published_stage_is_found_by_its_key(store):
    published = publish(store)
    found = store.find("stage/one", "k" * 64)
    assert found == published
    assert found.path("file.bin").read_bytes() == b"data"
    assert store.find("stage/one", "j" * 64) is None


def test_an_unfinished_stage_is_not_found(store):
    workspace = store.workspace("stage/one", "k" * 64)
    (workspace / "file.bin").write_bytes(b"half")
    assert store.find("stage/one", "k" * 64) is None


def test_equal_content_has_equal_hash_wherever_it_was_made(store, tmp_path):
    other = LocalStore(tmp_path / "elsewhere")
    assert publish(store).content_hash == publish(other).content_hash
    assert publish(other, b"dato", "l" * 64).content_hash != publish(store).content_hash


@pytest.mark.parametrize("damage", ["edit", "truncate", "remove", "link"])
def test_a_changed_file_is_named_with_the_remedy(store, tmp_path, damage):
    artefact = publish(store)
    path = artefact.folder / "file.bin"
    if damage == "edit":
        path.write_bytes(b"dat4")
    elif damage == "truncate":
        path.write_bytes(b"dat")
    else:
        path.unlink()
        if damage == "link":
            (tmp_path / "twin").write_bytes(b"data")
            path.symlink_to(tmp_path / "twin")
    with pytest.raises(IntegrityError) as caught:
        artefact.path("file.bin")
    assert str(path) in caught.value.message
    assert str(artefact.folder) in caught.value.remedy


def test_a_manifest_of_another_stage_is_refused(store):
    artefact = publish(store)
    manifest = read_record(artefact.folder / "manifest.json")
    write_record(artefact.folder / "manifest.json", manifest | {"stage": "other"})
    with pytest.raises(IntegrityError, match=r"manifest\.json"):
        store.find("stage/one", "k" * 64)


def test_a_folder_has_one_user_at_a_time(tmp_path):
    with (
        sole_user(tmp_path),
        pytest.raises(OutputError, match="Another process"),
        sole_user(tmp_path),
    ):
        pass
    with sole_user(tmp_path):  # and is free again afterwards
        pass


@pytest.mark.parametrize("number", [28, 30, 13, 2])  # ENOSPC, EROFS, EACCES, ENOENT
def test_refusals_to_write_become_a_sentence(tmp_path, number):
    with pytest.raises(OutputError) as caught, output_errors(tmp_path):
        raise OSError(number, os.strerror(number), str(tmp_path / "file"))
    assert str(tmp_path) in caught.value.message
    assert caught.value.remedy


@pytest.mark.parametrize("kind", [PermissionError, RuntimeError])
def test_so_do_those_that_a_library_has_put_in_words(tmp_path, kind):
    with pytest.raises(OutputError, match="may not be written"), output_errors(tmp_path):
        raise kind("Permission denied (os error 13): file")


def test_records_are_never_half_written(tmp_path):
    path = tmp_path / "record.json"
    write_record(path, {"a": 1})
    with pytest.raises(ValueError, match="JSON"):
        write_record(path, {"a": float("nan")})
    assert read_record(path) == {"a": 1}
    assert [file.name for file in tmp_path.iterdir()] == ["record.json"]


def test_errors_cross_process_borders_whole():
    error = pickle.loads(pickle.dumps(OutputError("What.", remedy="Do.")))  # noqa: S301
    assert isinstance(error, SurmountError)
    assert (error.message, error.remedy, error.exit_code) == ("What.", "Do.", 4)
