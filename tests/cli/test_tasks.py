"""`tasks` lists what is registered, with ranges, units and what is harder."""

from __future__ import annotations

import numpy as np

from surmount.cli.main import run
from surmount.cli.tasks import WIDTH
from surmount.core.configuration import dotted_keys
from surmount.core.errors import InputError
from surmount.envs.registry import find_family
from surmount.rstar.course.config import EnvConfig


def tasks(capsys, *arguments) -> str:
    assert run(["tasks", *arguments]) == 0
    return capsys.readouterr().out


def test_the_obstacles_of_the_paper_are_listed_with_range_unit_and_direction(capsys):
    said = tasks(capsys)
    assert "rstar/step: RSTAR and the step\n  height_mm: 21 to 50 mm; larger is harder\n" in said
    assert "  width_mm: 180 to 320 mm; smaller is harder\n  15 variants\n" in said
    assert "  height_mm: 55 to 140 mm; smaller is harder\n  18 variants\n" in said


def test_one_task_is_shown_with_all_variants_and_keys(capsys):
    said = tasks(capsys, "step")
    assert all(f"\n  env.{key} = " in said for key in dotted_keys(EnvConfig))
    listed = said.partition("variants\n  21, ")[2].partition("\n\n")[0]
    assert [float(one) for one in listed.split(",")] == [*np.arange(22.0, 51.0)]
    assert max(map(len, said.splitlines())) <= WIDTH


def test_an_environment_of_ones_own_is_shown_too(capsys):
    said = tasks(capsys, "own_point:make_env")
    assert "  distance_m: 0.5 to 2 m; " in said
    assert "  wind: 0 to 2; " in said
    assert "env.logarithmic = []" in said


def test_a_task_that_cannot_be_made_does_not_hide_the_others(capsys, monkeypatch):
    class Broken(type(find_family("step"))):
        def space(self, settings):
            raise InputError("It is broken.", remedy="Mend it.")

    families = {"a/broken": Broken(find_family("step").obstacle), "b/step": find_family("step")}
    monkeypatch.setattr("surmount.cli.tasks.registered_families", lambda: families)
    said = tasks(capsys)
    assert "It is broken. Mend it." in said
    assert "30 variants" in said


def test_of_a_mistyped_task_the_nearest_is_named(capsys):
    assert run(["tasks", "stepp"]) == 2
    assert "Did you mean `step`?" in capsys.readouterr().err
