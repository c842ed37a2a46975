"""`export` writes networks for others, and refuses what is not one."""

from __future__ import annotations

import numpy as np
import pytest
from onnx.reference import ReferenceEvaluator
from small import run_first_stages, small_config

from surmount.cli.main import run
from surmount.learn.snapshot import Snapshot


@pytest.fixture(scope="module")
def network(tmp_path_factory):
    root = run_first_stages(tmp_path_factory.mktemp("run"), small_config(networks=1))
    return next(root.glob("stages/initiation/**/network.safetensors"))


def export(capsys, *arguments):
    code = run(["export", *map(str, arguments)])
    captured = capsys.readouterr()
    return code, captured.out + captured.err


def test_a_trained_network_becomes_onnx(capsys, network, tmp_path):
    code, said = export(capsys, network, "--to", "onnx", "--out", tmp_path / "new")
    path = tmp_path / "new" / "policy.onnx"
    assert (code, said) == (0, f"Written to {path}: {path.stat().st_size:,} bytes\n")
    mean, std = ReferenceEvaluator(str(path)).run(
        None, {"observation": np.zeros((2, 6), dtype=np.float32)}
    )
    assert mean.shape == (2, 3)
    np.testing.assert_allclose(
        std * small_config().learner.action_divisor,
        np.exp(Snapshot.load(network).tensors["policy/log_std"]),
        rtol=1e-6,
    )


def test_a_network_to_act_with_keeps_its_policy_and_nothing_of_learning(capsys, network, tmp_path):
    assert export(capsys, network, "--to", "acting", "--out", tmp_path)[0] == 0
    kept, whole = Snapshot.load(tmp_path / "acting.safetensors"), Snapshot.load(network)
    assert kept.record == whole.record
    assert not [name for name in kept.tensors if name.startswith("optimiser/") or "value" in name]
    for name, array in kept.tensors.items():
        np.testing.assert_array_equal(array, whole.tensors[name])


def test_what_does_not_fit_is_refused(capsys, network, tmp_path):
    code, said = export(capsys, network, "--to", "csv", "--out", tmp_path)
    assert code == 2
    assert "is a network, and `csv` takes curricula" in said
    (tmp_path / "curriculum.json").write_text("{}", encoding="utf-8")
    code, said = export(capsys, tmp_path / "curriculum.json", "--to", "onnx", "--out", tmp_path)
    assert code == 2
    assert "is no network, and `onnx` takes networks" in said
    code, said = export(capsys, tmp_path, "--to", "onnx", "--out", tmp_path)
    assert code == 3
    assert "delete" not in said
