"""The page on one's own environment runs as it stands."""

from __future__ import annotations

import re
import sys
import tomllib
import types
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from surmount.cli.main import VERBS
from surmount.envs import registry
from surmount.envs.check import check_contract
from surmount.envs.making import time_limit
from surmount.experiment.presets import preset

DOCS = Path(__file__).parents[2] / "docs"
TEXT = (DOCS / "own-environment.md").read_text(encoding="utf-8")


@pytest.fixture
def page(monkeypatch) -> types.ModuleType:
    """The page's Python, as the module that its entry point names."""
    module = types.ModuleType("pendulum_tasks")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    for block in re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL):
        code = compile(block, "own-environment.md", "exec", dont_inherit=True)
        exec(code, module.__dict__)  # noqa: S102
    return module


def test_the_example_runs_and_keeps_the_contract(page):
    assert [found for found in check_contract(page.make_env) if not found.holds] == []


def test_its_package_registers_its_tasks(page, monkeypatch):
    blocks = re.findall(r"```toml\n(.*?)```", TEXT, flags=re.DOTALL)
    (block,) = [block for block in blocks if "entry-points" in block]
    ((group, registered),) = tomllib.loads(block)["project"]["entry-points"].items()
    entries = [EntryPoint(name, value, group) for name, value in registered.items()]
    monkeypatch.setattr(registry, "entry_points", lambda *, group: [
        entry for entry in entries if entry.group == group
    ])  # fmt: skip
    registry.registered_families.cache_clear()
    try:
        assert [*registry.registered_families()] == ["pendulum/gravity", "pendulum/weighted"]
        assert preset("gravity", "smoke").task == "pendulum/gravity"
        config = preset("weighted", "smoke")
        family = registry.find_family(config.task)
        assert config.env == page.PendulumConfig()
        assert family.name == config.task
        env = family.make(page.PendulumConfig(mass_kg=2.0))
        assert env.unwrapped.m == 2.0
        assert family.cap_s(config.env) == pytest.approx(time_limit(env) * env.step_s)
        many = family.training_env(config.env, 2)
        many.reset(seed=0)
        assert many.num_envs == 2
        many.close()
    finally:
        registry.registered_families.cache_clear()


def test_commands_exist():
    for name in ("own-environment.md", "exports.md"):
        text = (DOCS / name).read_text(encoding="utf-8")
        verbs = re.findall(r"^\$ surmount ([a-z]+)", text, flags=re.MULTILINE)
        assert verbs
        assert set(verbs) <= set(VERBS)
