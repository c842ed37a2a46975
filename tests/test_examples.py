"""The examples run as they stand, at a tiny scale."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from plain_run import run as run_stages
from small import SMALL, Watcher

from surmount.analysis.result import Analysis
from surmount.core.configuration import override
from surmount.envs.check import check_contract
from surmount.experiment.presets import preset
from surmount.experiment.running import begin
from surmount.report.pages import write_report
from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.workflow.executors import make_executor

sys.path.insert(0, str(Path(__file__).parent.parent / "examples"))


def test_stable_baselines_trains_on_the_single_environment(capsys):
    import train_sb3  # noqa: PLC0415

    results = train_sb3.main(steps=64, heights_mm=(130.0,))
    assert set(results) == {130.0}
    for height_mm, info in results.items():
        assert info["variant"].tolist() == [height_mm]
        assert 0.0 < info["completion_time_s"] <= 20.0
        assert info["is_success"] == (info["completion_time_s"] < 20.0)
    assert capsys.readouterr().out.count("mm: ") == 1


def test_skrl_trains_on_the_batched_environment():
    import torch  # noqa: PLC0415

    import train_skrl  # noqa: PLC0415

    fresh, trained = (train_skrl.main(steps=steps, num_envs=4, rollouts=16) for steps in (0, 160))
    weights = [agent.models["policy"].net[0].weight.detach().numpy() for agent in (fresh, trained)]
    assert np.isfinite(weights[1]).all()
    assert not np.array_equal(*weights)  # 2 updates of 64 steps
    assert torch.isfinite(trained.models["value"].net[-1].bias).all()


def test_a_pushed_distribution_holds_across_the_automatic_resets_of_gymnasiums_vector_envs():
    import gymnasium_vector  # noqa: PLC0415

    results = gymnasium_vector.main(steps=105)
    assert set(results) == {"sync", "async", "batched"}
    for seen, ended in results.values():
        assert ended >= 2  # an episode of 100 steps in each of two environments
        assert len(seen) >= 4
        assert 180.0 <= min(seen) <= max(seen) <= 220.0
    # Gymnasium resets singles in a step of their own; until then the three are alike.
    first = [min(seen) for seen, _ in results.values()]
    assert first[0] == first[1]


@pytest.mark.parametrize("name", ["lunar_lander", "uphill_cheetah"])
def test_environments_of_others_keep_the_contract(name):
    module = importlib.import_module(name)
    findings = check_contract(module.make_env)
    assert [finding for finding in findings if not finding.holds] == []
    assert len(findings) == 15 + len(module.make_env().task_parameters)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["lunar_lander", "uphill_cheetah"])
def test_the_whole_protocol_runs_on_environments_of_others(name, tmp_path):
    config = override(
        preset(f"{name}:make_env", "smoke"),
        {key: value for key, value in SMALL.items() if not key.startswith("env.")}
        | {"networks": 1},
    )
    begin(tmp_path, config)
    watcher = Watcher()
    outcome = run_stages(tmp_path, config, make_executor(0, watcher.listen), watcher)
    assert not outcome.interrupted
    analysis = Analysis.load(outcome.artefacts["analysis"].path("analysis.json"))
    space = importlib.import_module(name).make_env().space
    assert analysis.parameters == space.parameters
    np.testing.assert_allclose(analysis.variants, space.variants)
    page = write_report(tmp_path).read_text(encoding="utf-8")
    assert all(parameter.partition("_")[0] in page for parameter in space.parameters)


def lander_curriculum() -> Curriculum:
    groups = tuple(
        Group(
            name=name,
            variants=np.array([[gravity, 0.0], [gravity, 15.0]]),
            success_rate=rate,
            boxes=(
                Box(
                    lower=np.array([gravity - 1, 0.0]),
                    upper=np.array([gravity + 1, 15.0]),
                    weight=1.0,
                ),
            ),
        )
        for name, gravity, rate in (("easy", 5.0, 0.6), ("difficult", 9.0, 0.1))
    )
    levels = (
        Level(dominant="easy", weights=(1.0, 0.0)),
        Level(dominant="difficult", weights=(0.25, 0.75)),
    )
    return Curriculum(
        parameters=("gravity_mps2", "wind_power"),
        groups=groups,
        levels=levels,
        success_threshold=0.95,
    )


def test_a_curriculum_runs_in_a_plain_script_with_two_parameters(tmp_path, capsys):
    import own_environment_sb3  # noqa: PLC0415

    lander_curriculum().save(tmp_path / "curriculum.json")
    callback = own_environment_sb3.main(
        tmp_path / "curriculum.json",
        steps=1024,  # 3 roll-outs of 64 and ten extensions of one end the first level
        num_envs=2,
        log=str(tmp_path / "log"),
        rollout=32,
    )
    first = [test.decision for test in callback.tests if test.level == 0]
    assert first[0] == "extend"
    assert first[-1].startswith("advance")
    assert callback.teacher.status().level in (2, None)
    assert "rF =" in capsys.readouterr().out
    assert (tmp_path / "log" / "teacher.json").is_file()


@pytest.mark.parametrize(
    "name", ["train_sb3", "train_skrl", "gymnasium_vector", "own_environment_sb3",
             "lunar_lander", "uphill_cheetah"]
)  # fmt: skip
def test_examples_are_named_in_the_readme(name):
    readme = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
    assert f"examples/{name}.py" in readme
