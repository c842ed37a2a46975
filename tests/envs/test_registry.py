"""RSTAR's tasks and anybody's come in through one registry."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest
from own_point import make_env

from surmount.core.errors import ConfigError
from surmount.envs import registry
from surmount.envs.family import NoSettings
from surmount.envs.own_settings import OwnSettings
from surmount.envs.registry import find_family, registered_families
from surmount.experiment.presets import preset

FAMILIES = {"point": make_env, "step": make_env}
NOT_FAMILIES = {"point": 3}


@pytest.fixture
def installed(monkeypatch):
    """Let one more package register tasks."""
    found = registry.entry_points(group=registry.GROUP)

    def install(value: str) -> None:
        entry = EntryPoint(name="mine", value=value, group=registry.GROUP)
        monkeypatch.setattr(registry, "entry_points", lambda group: [*found, entry])
        registered_families.cache_clear()

    yield install
    monkeypatch.undo()
    registered_families.cache_clear()


def test_a_short_name_stands_for_the_only_task_that_ends_so():
    assert find_family("step") is find_family("rstar/step")
    assert preset("step", "smoke").task == "rstar/step"


def test_a_package_registers_functions_that_make_environments(installed):
    installed(f"{__name__}:FAMILIES")
    family = find_family("mine/point")
    assert family.space(NoSettings()).parameters
    assert len(family.fingerprint(NoSettings())) == 64
    with pytest.raises(ConfigError, match="`step` is the name of several tasks") as caught:
        find_family("step")
    assert "mine/step or rstar/step" in caught.value.remedy


def test_what_registers_no_families_is_told_with_the_package_to_uninstall(installed):
    installed(f"{__name__}:NOT_FAMILIES")
    with pytest.raises(ConfigError, match="int under `point`") as caught:
        find_family("rstar/step")
    assert "uninstall its package" in caught.value.remedy


def test_an_unknown_name_names_the_nearest_and_where_to_look():
    with pytest.raises(ConfigError, match="There is no task `stepp`") as caught:
        find_family("stepp")
    assert "`step`" in caught.value.remedy
    assert "surmount tasks" in caught.value.remedy


def test_settings_of_rstar_are_not_in_the_configuration_of_a_stranger(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "stranger.py").write_text("from own_point import make_env\n", encoding="utf-8")
    assert preset("stranger:make_env", "smoke").env == OwnSettings()
