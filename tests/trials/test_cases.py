"""Small inputs that went wrong somewhere, each with its right value and where it is from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pytest

from surmount.cli.main import run
from surmount.core.errors import InputError
from surmount.trials.columns import Columns
from surmount.trials.table import read_trials, trials_from_table, write_trials

CASES = Path(__file__).parent / "cases"
LOG = Columns(variant={"w": "width"}, trial="ep", features={"fx": "fx"})
OPTIONS = ["--trial", "ep", "--variant", "w=width", "--feature", "fx=fx"]


def converted(name: str, out: Path, *more: str) -> int:
    return run(["convert", str(CASES / name), "--out", str(out), *OPTIONS, *more])


@pytest.mark.parametrize(
    ("name", "trials", "successes"),
    [("ns_ids.csv", 5, 1), ("yes_no.csv", 3, 1), ("onezero_blank.csv", 2, 1)],
)
def test_trials_and_successes_are_counted_right_by_the_command_and_the_library(
    capsys, tmp_path, name, trials, successes
):
    found = read_trials(CASES / name, columns=LOG)
    assert (found.n_trials, int(found.success.sum())) == (trials, successes)
    assert converted(name, tmp_path / "t.csv") == 0
    assert f"{trials} trials on 2 variants, {successes} succeeded" in capsys.readouterr().out
    again = read_trials(tmp_path / "t.csv")
    assert (again.n_trials, int(again.success.sum())) == (trials, successes)


def test_a_code_of_minus_one_is_refused_and_read_once_it_is_said_what_it_means(capsys, tmp_path):
    assert converted("minus_one.csv", tmp_path / "t.csv") == 3
    said = capsys.readouterr().err
    assert "rows 2, 6: `success` is neither 0 nor 1 but a code (-1)" in said
    assert "--success-above" in said
    assert converted("minus_one.csv", tmp_path / "t.csv", "--success-above", "0") == 0
    assert "3 trials on 2 variants, 1 succeeded" in capsys.readouterr().out


@pytest.mark.parametrize("kind", [".csv", ".parquet", "frame"])
def test_identities_in_nanoseconds_stay_apart(tmp_path, kind):  # ros_comm 1053
    frame = pl.read_csv(CASES / "ns_ids.csv")
    if kind == "frame":
        trials = trials_from_table(frame, columns=LOG)
    else:
        path = tmp_path / f"t{kind}"
        frame.write_csv(path) if kind == ".csv" else frame.write_parquet(path)
        trials = read_trials(path, columns=LOG)
    assert trials.repetition.tolist() == frame["ep"].to_list()


def test_numbers_and_names_in_one_column_are_names(tmp_path):
    rows = [f"{i // 10},{1 + i // 10 % 2},{i % 7},1" for i in range(20_020)]
    rows += [f"calib{i // 10},{1 + i // 10 % 2},{i % 7},1" for i in range(20)]
    (tmp_path / "t.csv").write_text("ep,width,fx,success\n" + "\n".join(rows), encoding="utf-8")
    assert read_trials(tmp_path / "t.csv", columns=LOG).n_trials == 2004


def test_numbers_with_zeros_before_them_stay_names_in_every_row(tmp_path):
    rows = [f"{1 + i // 15 % 2},0,{i // 15:06d},1,{i % 7}" for i in range(20_015)]
    rows += [f"1,0,calib,1,{i % 7}" for i in range(15)]
    header = "variant,network,trial,success,fx\n"
    (tmp_path / "t.csv").write_text(header + "\n".join(rows), encoding="utf-8")
    assert read_trials(tmp_path / "t.csv").n_trials == 1336


@pytest.mark.parametrize(
    "names", [["01", "1"], ["1_0", "10"], ["1234e5", "123400000"], ["1.1", "1.10"]]
)
def test_names_that_look_like_numbers_are_not_mixed_up(tmp_path, names):
    columns = {
        "variant": [1, 1, 2, 2],
        "network": names * 2,
        "trial": [0, 1, 0, 1],
        "success": [1] * 4,
        "fx": [1.0, 2.0, 3.0, 4.0],
    }
    pl.DataFrame(columns).write_csv(tmp_path / "t.csv")
    for trials in (trials_from_table(columns), read_trials(tmp_path / "t.csv")):
        assert trials.network_names == tuple(sorted(names))
        assert [trials.network_name(one) for one in trials.network] == names * 2
        write_trials(tmp_path / "again.parquet", trials)
        assert read_trials(tmp_path / "again.parquet").network_names == tuple(sorted(names))


@pytest.mark.parametrize("kind", [None, object])
def test_byte_strings_of_hdf5_and_numpy_are_text(kind):
    table = {name: np.resize(values, 6) for name, values in INDEXED.items()}
    names = np.array([b"run_a", "lauf_ä".encode()] * 3, dtype=kind)
    trials = trials_from_table(table | {"network": names})
    assert trials.network_names == ("lauf_ä", "run_a")


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
@pytest.mark.parametrize("how", ["numpy", "pandas", "polars"])
def test_times_are_seconds_in_every_resolution(unit, how):
    if unit == "s" and how != "numpy":
        pytest.skip("there is none")
    steps = {"s": [0, 3, 0, 3]}.get(unit, [0.0, 0.1, 0.0, 0.1])
    span = np.asarray(steps) * {"s": 1, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit]
    span = span.astype(f"timedelta64[{unit}]")
    frame = {
        "variant": [1, 1, 2, 2],
        "network": [0] * 4,
        "trial": [0] * 4,
        "success": [1] * 4,
        "time_s": span,
        "stamp": np.datetime64("2024-05-27T10:00:00", unit) + span,
    }
    made = {"numpy": dict, "pandas": pd.DataFrame, "polars": pl.DataFrame}[how]
    if how == "polars" and unit == "s":
        frame["time_s"] = frame["time_s"].astype("timedelta64[ms]")
    trials = trials_from_table(made(frame))
    np.testing.assert_allclose(trials.column("time_s"), steps, rtol=0, atol=1e-12)
    np.testing.assert_allclose(trials.column("stamp"), steps, rtol=0, atol=1e-12)
    assert any("date-times" in note for note in trials.notes)


def test_an_index_of_pandas_is_no_feature(tmp_path):  # pandas 51664
    trials = read_trials(CASES / "pandas_index.parquet")
    assert trials.feature_names == ("ax", "ay", "az", "gx", "gy", "gz")
    assert any("`__index_level_0__` numbers rows" in note for note in trials.notes)
    frame = pd.DataFrame({"variant": [1, 2], "network": 0, "trial": 0, "success": 1, "x": [1.0, 2]})
    frame.to_csv(tmp_path / "t.csv")  # the index is a first column without a name
    trials = read_trials(tmp_path / "t.csv")
    assert trials.feature_names == ("x",)
    assert "without a name numbers rows" in trials.notes[0]
    pd.read_csv(tmp_path / "t.csv").to_csv(tmp_path / "again.csv", index=False)
    trials = read_trials(tmp_path / "again.csv")
    assert trials.feature_names == ("x",)
    assert "`Unnamed: 0` numbers rows" in trials.notes[0]


INDEXED = {
    "variant": [1, 1, 1, 2, 2, 2],
    "network": 0,
    "trial": 0,
    "success": 1,
    "x": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
}


@pytest.mark.parametrize("name", ["", "Unnamed: 0", "Unnamed: 0.1", "__index_level_0__"])
@pytest.mark.parametrize(
    ("numbers", "rows"),
    [
        ([0, 1, 2, 3, 4, 5], True),
        ([0, 1, 2, 0, 1, 2], True),
        ([0, 1, 3, 4, 6, 9], True),
        ([4, 1, 0, 5, 2, 3], True),
        ([0, 1, 2, 301, 302, 303], True),
        ([0.0, 0.02, 0.04, 0.06, 0.08, 0.1], False),
        ([0, 20, 40, 0, 20, 40], False),
        ([0, 0, 0, 1, 1, 1], False),
        (["a", "a", "a", "b", "b", "b"], False),
    ],
)
def test_only_an_index_that_numbers_rows_is_left_out(tmp_path, name, numbers, rows):
    pd.DataFrame({name: numbers, **INDEXED}).to_csv(tmp_path / "t.csv", index=False)
    if rows:
        trials = read_trials(tmp_path / "t.csv")
        assert trials.feature_names == ("x",)
        assert "numbers rows" in trials.notes[0]
    else:
        first = ", ".join(map(str, numbers[:3]))
        with pytest.raises(InputError, match=f"numbers no rows; it holds {first} …") as caught:
            read_trials(tmp_path / "t.csv")
        assert "Name it" in caught.value.remedy
        if name and not isinstance(numbers[0], str):
            named = Columns(features={"y": name})
            assert read_trials(tmp_path / "t.csv", columns=named).column("y").tolist() == numbers


def test_an_index_of_pandas_that_says_something_is_read():
    frame = pd.DataFrame(INDEXED).assign(time_s=[0.0, 0.1, 0.2] * 2)
    trials = trials_from_table(frame.set_index("time_s"))
    assert trials.column("time_s").tolist() == frame["time_s"].tolist()
    assert trials.notes == ("The index `time_s` was read as a column.",)
    trials = trials_from_table(frame.set_index(["variant", "network", "trial"]))
    assert trials.variant[:, 0].tolist() == [1, 2]
    assert trials.feature_names == ("x", "time_s")
    assert trials_from_table(frame.set_index("time_s", drop=False)).notes == ()
    assert trials_from_table(frame[::2]).notes == ()  # numbers of rows, some left out
    with pytest.raises(InputError, match=r"numbers no rows; it holds 0\.0, 0\.1, 0\.2 …"):
        trials_from_table(frame.drop(columns="time_s").set_index(pd.Index(frame["time_s"].array)))


def test_variants_of_32_and_of_64_bits_are_not_taken_for_others(tmp_path):
    for network, kind in enumerate((pl.Float32, pl.Float64)):
        frame = pl.DataFrame({"variant": [0.6, 0.7, 0.8], "x": [1.0, 2.0, 3.0]})
        told = {"network": pl.lit(network), "trial": pl.lit(0), "success": pl.lit(1)}
        frame = frame.with_columns(pl.col("variant").cast(kind), **told)
        frame.write_parquet(tmp_path / f"{network}.parquet")
        assert read_trials(tmp_path / f"{network}.parquet").n_trials == 3
    with pytest.raises(InputError, match=r"0\.6 and 0\.6000000238418579 differ by rounding only"):
        read_trials(tmp_path)


@pytest.mark.parametrize(
    ("variants", "one"),
    [
        ([-5.55e-17, 0.0, 0.5], True),
        ([-1.0, 5e-10, 0.0, 1.0], True),
        ([0.1 + 0.2, 0.3, 1.0], True),
        ([1e-12, 2e-12, 1e3], False),  # of many magnitudes, as on a logarithmic axis
        ([10_000_000.0, 10_000_001.0], False),
        ([1_716_800_000, 1_716_800_001], False),
        ([0.0, 0.001, 1.0], False),
    ],
)
def test_only_numbers_that_are_rounded_differ_by_rounding(variants, one):
    rows = range(len(variants))
    table = {"variant": variants, "network": 0, "trial": 0, "success": 1, "x": [*map(float, rows)]}
    frame = pd.DataFrame(table)
    if one:
        with pytest.raises(InputError, match="differ by rounding only"):
            trials_from_table(frame)
    else:
        assert trials_from_table(frame).variant[:, 0].tolist() == variants


@pytest.mark.parametrize("name", ["trailing_blank.csv", "excel_sep_line.csv", "small.csv.gz"])
def test_what_spreadsheets_and_compression_add_is_read(name):
    trials = read_trials(CASES / name)
    assert trials.variant[:, 0].tolist() == [1.0, 2.0]
    assert trials.column("fx").tolist() == [0.5, 0.6]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("quoted_decimal_comma.csv", "rows 1, 2: `fx` has decimal commas"),
        ("na.csv", "row 1: `fx` is missing"),
    ],
)
def test_what_is_not_read_is_called_by_its_name(name, words):
    with pytest.raises(InputError, match=words):
        read_trials(CASES / name)
