import json
from dataclasses import replace

import pytest

from surmount.cli.main import run
from surmount.core.errors import ConfigError, InputError
from surmount.rstar.manoeuvres.search import SearchConfig
from surmount.studies.capability import (
    CapabilityConfig,
    Column,
    columns,
    describe,
    explore,
    limit_mm,
    map_capability,
)

SEARCH = SearchConfig(population=8, elite=4, iterations=1, phases=1, horizon_s=4.0)
SMALL = CapabilityConfig(
    obstacle="narrow-channel",
    sizes_mm=(320.0, 300.0, 80.0, 70.0, 60.0),
    gears=("wheels",),
    frictions=(1.3,),
    search=SEARCH,
    repetitions=1,
)


@pytest.mark.slow
def test_a_column_ends_two_sizes_beyond_what_the_mechanism_can_do():
    # The narrowest robot is 114.7 mm wide: 80 mm cannot be passed, whatever the manoeuvre.
    column = explore(SMALL, columns(SMALL)[0])
    assert [cell["feasible"] for cell in column["cells"]] == [True, True, False, False]
    assert limit_mm(column) == 300.0
    # 72 by hand at each size, and eight more in each search that came to nothing.
    assert [cell["tried"] for cell in column["cells"]] == [72, 72, 80, 80]
    assert "feasible up to 300 mm (304 manoeuvres tried)" in describe(column)


def test_torque_factors_scale_every_servos_limit():
    column = Column(gear="both", friction=0.7, torque_factor=0.5)
    robot = column.robot(SMALL.env.robot)
    assert (robot.gear, robot.friction) == ("both", 0.7)
    assert robot.wheel_torque_nm == pytest.approx(0.25)
    assert robot.sprawl_torque_nm == pytest.approx(4.0)
    assert robot.fbem_torque_nm == pytest.approx(2.0)


def test_a_map_keeps_its_columns_takes_more_and_refuses_other_settings(tmp_path):
    path, said = tmp_path / "capability.json", []
    one = replace(SMALL, sizes_mm=(320.0,), frictions=(1.3, 1.0))
    map_capability(one, path, provenance={}, processes=1, say=said.append)
    assert len(said) == 2
    written = path.read_bytes()
    map_capability(one, path, provenance={}, processes=1, say=said.append)
    assert len(said) == 2  # nothing was left to do
    assert path.read_bytes() == written
    more = replace(one, frictions=(1.0, 0.7))
    map_capability(more, path, provenance={"machine": "B"}, processes=1, say=said.append)
    assert len(said) == 3
    found = json.loads(path.read_text())["columns"]
    assert [(column["friction"], column["provenance"]) for column in found] == [
        (0.7, {"machine": "B"}),
        (1.0, {}),
        (1.3, {}),
    ]
    with pytest.raises(InputError, match="not a capability map of this configuration"):
        map_capability(SMALL, path, provenance={}, processes=1, say=said.append)


def test_the_verb_writes_map_and_figure(tmp_path):
    options = ["--sizes", "320", "--gears", "wheels", "--frictions", "1.3", "--processes", "1"]
    small = ["search.population=8", "search.elite=4", "search.iterations=1", "repetitions=1"]
    sets = [part for item in small for part in ("--set", item)]
    out = tmp_path / "map"
    assert run(["capability", "narrow-channel", "--out", str(out), *options, *sets]) == 0
    record = json.loads((out / "capability.json").read_text())
    assert record["columns"][0]["cells"][0]["size_mm"] == 320.0
    assert (out / "capability.png").stat().st_size > 5_000
    header, row = (out / "capability.csv").read_text().splitlines()
    assert header == "gear,friction,torque_factor,size_mm,feasible,tried"
    assert row.startswith("wheels,1.3,1.0,320.0,")


@pytest.mark.parametrize(
    "wrong",
    [{"obstacle": "wall"}, {"gears": ("tracks",)}, {"frictions": ()}, {"repetitions": 0}],
)
def test_maps_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ConfigError):
        replace(SMALL, **wrong)
