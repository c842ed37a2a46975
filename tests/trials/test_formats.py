"""Every format in which trials come, each with a sample, and what of it is refused."""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import re
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import polars as pl
import pytest

from surmount import Columns, read_trials, trials_from_arrays, trials_from_table
from surmount.cli.main import run
from surmount.core.errors import ConfigError, InputError
from surmount.trials.table import write_trials

ROWS = [(1, "a", 0, 1, 0.5), (1, "b", 0, 0, 1.5), (2, "a", 0, 1, 0.6), (2, "b", 0, 0, 1.6)]
NAMES = ["variant", "network", "trial", "success", "fx"]


def text(separator=",", decimal=".", end="\n") -> str:
    rows = [separator.join(str(one).replace(".", decimal) for one in row) for row in ROWS]
    return end.join([separator.join(NAMES), *rows]) + end


def frame() -> pl.DataFrame:
    return pl.DataFrame(ROWS, schema=NAMES, orient="row")


def sound(trials) -> None:
    assert trials.variant[:, 0].tolist() == [1, 1, 2, 2]
    assert [trials.network_name(one) for one in trials.network] == ["a", "b", "a", "b"]
    assert trials.success.tolist() == [True, False, True, False]
    assert trials.column("fx").tolist() == [0.5, 1.5, 0.6, 1.6]


@pytest.mark.parametrize(
    "content",
    [
        text().encode(),
        text(";").encode(),
        text(";", ",").encode(),
        text("\t", ",").encode(),
        text("|").encode(),
        text(end="\r\n").encode(),
        b"\xef\xbb\xbf" + text().encode(),
        text(";").encode("utf-16"),
        b"sep=;\r\n" + text(";", ",", "\r\n").encode(),
        text().encode() + b"\n,,,,\n  \n"[:-3],
        text().replace("fx\n", "fx,,\n").replace(".5\n", ".5,,\n").encode(),
        text().replace("\n2,a", "\n\n2, a ").encode(),
    ],
    ids=["comma", "semicolon", "decimal comma", "tab", "bar", "crlf", "mark", "utf-16", "sep",
         "blank rows", "blank columns", "spaces"],
)  # fmt: skip
def test_csv_of_every_make_is_the_same_table(tmp_path, content):
    (tmp_path / "t.csv").write_bytes(content)
    sound(read_trials(tmp_path / "t.csv"))


@pytest.mark.parametrize(
    "before", ["\n", "\r\n \r\n", ",,,,\n", "\nsep=,\n\n"], ids=["one", "two", "commas", "sep"]
)
def test_blank_lines_before_the_header_are_skipped(tmp_path, before):
    (tmp_path / "t.csv").write_text(before + text(), newline="")
    sound(read_trials(tmp_path / "t.csv"))
    (tmp_path / "t.csv").write_text(before + text().replace("0.6", "?"), newline="")
    with pytest.raises(InputError, match="row 3: `fx` is not a number"):
        read_trials(tmp_path / "t.csv")
    (tmp_path / "t.csv").write_text(before + text().replace("0.6", "0.6,7"), newline="")
    with pytest.raises(InputError, match="row 3 has 6 entries under 5 column names"):
        read_trials(tmp_path / "t.csv")


def test_lines_that_end_by_carriage_returns_alone_are_told(tmp_path):
    (tmp_path / "t.csv").write_text(text(end="\r"), newline="")
    with pytest.raises(InputError, match=r"ends its lines by CR") as caught:
        read_trials(tmp_path / "t.csv")
    assert "LF" in caught.value.remedy


@pytest.mark.parametrize("short", [[1], [2], [1, 2, 3]])
def test_rows_shorter_than_the_header_lack_their_last_entries(tmp_path, short):
    lines = ["variant,network,trial,fx,success", "1,a,0,0.5,1", "1,b,0,1.5,0", "2,a,0,0.6,1",
             "2,a,0,0.7,1", "2,b,0,1.6,0"]  # fmt: skip
    for row in short:
        lines[row] = lines[row].rpartition(",")[0]
    (tmp_path / "t.csv").write_text("\n".join(lines), encoding="utf-8")
    lacking = [row for row in short if row < 3]
    words = rf"rows? {', '.join(map(str, lacking))}: no row of the trial .* has a `success`"
    with pytest.raises(InputError, match=words):
        read_trials(tmp_path / "t.csv")
    lines[1:3] = ["1,a,0,0.5", "1,a,0,0.6,1", "1,b,0,1.5,0"]
    (tmp_path / "t.csv").write_text("\n".join(lines), encoding="utf-8")
    trials = read_trials(tmp_path / "t.csv")
    assert trials.success.tolist() == [True, False, True, False]
    assert trials.column("fx").tolist() == [0.5, 0.6, 1.5, 0.6, 0.7, 1.6]


@pytest.mark.parametrize("values", [("987", "1,012"), ("9,810", "-1,012")])
def test_commas_that_may_separate_thousands_are_refused(tmp_path, values):
    path, names = tmp_path / "t.tsv", "variant\tnetwork\ttrial\tsuccess\tx\n"
    rows = [f"{20 + i}\t0\t0\t1\t{value}\n" for i, value in enumerate(values)]
    path.write_text(names + "".join(rows), encoding="utf-8")
    with pytest.raises(InputError, match="`x` has commas that may separate decimals or thousands"):
        read_trials(path)
    path.write_text(names + "".join(rows).replace("20\t", "20,5\t"), encoding="utf-8")
    expected = [float(value.replace(",", ".")) for value in values]
    assert read_trials(path).column("x").tolist() == expected  # commas are decimals there


def test_decimal_commas_may_have_exponents(tmp_path):
    rows = "1,5E-05;n;0;1;-2,25e3\n2E-5;n;0;1;,5E+0\n"
    (tmp_path / "t.csv").write_text("variant;network;trial;success;x\n" + rows)
    trials = read_trials(tmp_path / "t.csv")
    assert trials.variant[:, 0].tolist() == [1.5e-5, 2e-5]
    assert trials.column("x").tolist() == [-2250.0, 0.5]


@pytest.mark.parametrize("name", ["t.csv.gz", "T.CSV.GZ"])
def test_compressed_csv_is_read(tmp_path, name):
    (tmp_path / name).write_bytes(gzip.compress(text().encode()))
    sound(read_trials(tmp_path / name))
    frame().write_csv(tmp_path / "t.csv.zst", compression="zstd")
    sound(read_trials(tmp_path / "t.csv.zst"))


def test_damaged_compressed_csv_is_told(tmp_path):
    rng = np.random.default_rng(0)
    rows = "".join(f"{i},n,0,1,{rng.random()}\n" for i in range(10_000))
    content = bytearray(gzip.compress((text().partition("\n")[0] + "\n" + rows).encode()))
    content[100:102] = b"\xff\x5a"
    (tmp_path / "t.csv.gz").write_bytes(content)
    with pytest.raises(InputError, match="cannot be read"):
        read_trials(tmp_path / "t.csv.gz")


def test_parquet_arrow_and_feather_are_read(tmp_path):
    frame().write_parquet(tmp_path / "t.parquet")
    frame().write_ipc(tmp_path / "t.arrow")
    frame().write_ipc(tmp_path / "t.feather", compression="lz4")
    for name in ("t.parquet", "t.arrow", "t.feather"):
        sound(read_trials(tmp_path / name))


@pytest.mark.parametrize("name", ["run[12]", "exp[lr=0.1]", "run*", "run?"])
@pytest.mark.parametrize("ending", ["csv", "csv.zst", "parquet", "arrow"])
def test_a_path_is_a_path_and_no_pattern(tmp_path, name, ending):
    folder = tmp_path / "a[b]"
    folder.mkdir()
    write = {
        "csv": pl.DataFrame.write_csv,
        "csv.zst": partial(pl.DataFrame.write_csv, compression="zstd"),
        "parquet": pl.DataFrame.write_parquet,
        "arrow": pl.DataFrame.write_ipc,
    }[ending]
    for other in ("run1", "run2"):
        with (folder / f"{other}.{ending}").open("wb") as file:
            write(frame().with_columns(fx=pl.lit(9.0)), file)
    with (folder / f"{name}.{ending}").open("wb") as file:
        write(frame(), file)
    sound(read_trials(folder / f"{name}.{ending}"))


class OnlyArrow:
    """A frame of some library that Arrow's stream is all that is known of."""

    def __arrow_c_stream__(self, requested_schema=None):
        return frame().__arrow_c_stream__(requested_schema)


def test_frames_of_every_library_are_read():
    columns = frame().to_dict(as_series=False)
    nullable = pd.DataFrame(columns).convert_dtypes()
    categorical = pd.DataFrame(columns).astype({"network": "category"})
    for table in (
        frame(),
        frame().lazy(),
        columns,
        pd.DataFrame(columns),
        nullable,
        categorical,
        OnlyArrow(),
    ):
        sound(trials_from_table(table))


def test_arrays_by_trial_are_read():
    arrays = [np.array([[fx]]) for *_, fx in ROWS]
    told = {"feature_names": ["fx"], "success": [1, 0, 1, 0], "network": ["a", "b"] * 2}
    sound(trials_from_arrays(arrays, variant=[1, 1, 2, 2], **told))
    trials = trials_from_arrays(arrays, variant={"w": [1, 1, 2, 2], "h": [0, 0, 0, 1]}, **told)
    assert trials.parameters == ("w", "h")
    with pytest.raises(InputError, match="`variant` has 3 entries for 4 trials"):
        trials_from_arrays(arrays, variant=[1, 1, 2], **told)
    with pytest.raises(InputError, match=r"trial 0 have shape \(1,\)"):
        trials_from_arrays([one[0] for one in arrays], variant=[1, 1, 2, 2], **told)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"variant": [(1, 2), (1, 3), (2, 2), (2, 3)]}, "`variant` has not one value per trial"),
        ({"variant": [(1, 2), 1, 2, 2]}, "`variant` has not one value per trial"),
        ({"variant": {"w": 3}}, r"`variant\.w` has not one value per trial"),
        ({"success": True}, "`success` has not one value per trial"),
        ({"network": "a"}, "`network` has not one value per trial"),
        ({"features": [[["far"]]] * 4}, "features of trial 0 are no array of numbers"),
        ({"features": [[[1.0]], [[1.0], [2.0, 3.0]]]}, "features of trial 1 are no array"),
        ({"features": [None] * 4}, r"features of trial 0 have shape \(\)"),
    ],
)
def test_arrays_that_are_not_one_per_trial_are_told(told, words):
    sound = {"features": [np.zeros((3, 1))] * 4, "variant": [1, 1, 2, 2], "success": [1, 0, 1, 0]}
    with pytest.raises(InputError, match=words) as caught:
        trials_from_arrays(**(sound | told), feature_names=["fx"])
    assert ("dictionary" in caught.value.remedy) == ("`variant`" in words)


@pytest.mark.parametrize(
    ("name", "why"),
    [("fx", "of two"), ("success", "of no"), ("trial", "of no"), ("network", "of no")],
)
def test_no_array_of_features_takes_the_name_of_another_column(name, why):
    told = {"success": [1, 0], "variant": [1, 2], "feature_names": ["fx", name]}
    with pytest.raises(InputError, match=f"`{name}` is the name {why} feature"):
        trials_from_arrays([np.zeros((3, 2))] * 2, **told)


def lerobot(**changes) -> dict:
    """Rebuilt from the columns of LeRobot's data sets, version 2.1; three episodes, two tasks."""
    columns = {
        "observation.state": [[0.1 * i, 1.0] for i in range(6)],
        "action": [[float(i)] for i in range(6)],
        "timestamp": np.float32([0, 0.1, 0, 0.1, 0, 0.1]),
        "frame_index": [0, 1] * 3,
        "episode_index": [0, 0, 1, 1, 2, 2],
        "index": range(6),
        "task_index": [0, 0, 1, 1, 1, 1],
        "next.done": [False, True, False, True, False, False],
    }
    return {name: value for name, value in (columns | changes).items() if value is not None}


def test_a_lerobot_data_set_maps_by_itself(tmp_path):
    pl.DataFrame(lerobot()).write_parquet(tmp_path / "file-000.parquet")
    trials = read_trials(tmp_path / "file-000.parquet")
    assert trials.parameters == ("task_index",)
    assert trials.feature_names == ("time_s", "observation.state.0", "observation.state.1",
                                    "action.0")  # fmt: skip
    assert trials.repetition.tolist() == [0, 1, 2]
    assert trials.success.tolist() == [True, True, False]
    np.testing.assert_allclose(trials.column("observation.state.0"), 0.1 * np.arange(6))
    assert any("`next.done` was taken for the outcome" in note for note in trials.notes)
    assert any("counters and marks" in note for note in trials.notes)


def test_an_end_that_every_episode_has_is_no_outcome():
    with pytest.raises(InputError, match=r"`next\.done` is true at the end of every trial"):
        trials_from_table(lerobot(**{"next.done": [False, True] * 3}))
    done = {"next.done": [False, True] * 3}
    told = trials_from_table(lerobot(**done, **{"next.success": [0, 0, 0, 1, 0, 0]}))
    assert told.success.tolist() == [False, True, False]


def test_one_entry_of_a_list_may_be_named():
    columns = Columns(variant={"task": "task_index"}, features={"x_m": "observation.state.0"})
    trials = trials_from_table(lerobot(), columns=columns)
    assert trials.feature_names == ("x_m",)
    wrong = Columns(variant={"task": "task_index"}, features={"x_m": "observation.state.2"})
    with pytest.raises(InputError, match=r"`observation\.state` has 2 entries, not 2"):
        trials_from_table(lerobot(), columns=wrong)


def test_lists_of_unequal_length_are_told():
    with pytest.raises(InputError, match="`action` holds lists of 1 to 2 entries"):
        trials_from_table(lerobot(action=[[1.0]] * 5 + [[1.0, 2.0]]))


def minari(folder: Path) -> Path:
    """Rebuilt by the format that Minari's page describes: two episodes of a goal environment."""
    (folder / "data").mkdir(parents=True)
    (folder / "data" / "metadata.json").write_text(json.dumps({"data_format": "hdf5"}))
    with h5py.File(folder / "data" / "main_data.hdf5", "w") as file:
        for number, reached in ((0, 1), (10, 0), (2, 1)):
            group = file.create_group(f"episode_{number}")
            group.attrs["id"], group.attrs["total_steps"] = number, 3
            group.attrs["width_m"] = 0.5 + 0.1 * (number > 0)
            observations = group.create_group("observations")
            observations["observation"] = np.arange(8.0).reshape(4, 2) + number
            observations["desired_goal"] = np.zeros((4, 1))
            group["actions"] = np.ones((3, 2))
            group["rewards"] = np.array([0.0, 0.0, float(reached)])
            group["terminations"] = np.array([False, False, bool(reached)])
            group["truncations"] = np.array([False, False, not reached])
            infos = group.create_group("infos")
            infos["success"] = np.array([0, 0, 0, reached])
    return folder


def test_a_minari_data_set_is_read(tmp_path):
    told = {"variant": {"width_m": "episode.width_m"}, "success": "infos.success"}
    columns = Columns(**told, features={"x": "observations.observation.0", "a": "actions.1"})
    trials = read_trials(minari(tmp_path / "door-v0"), columns=columns)
    assert trials.repetition.tolist() == [0, 2, 10]
    assert trials.success.tolist() == [True, True, False]
    assert trials.variant[:, 0].tolist() == [0.5, 0.6, 0.6]
    assert trials.column("x").tolist() == [2, 4, 6, 4, 6, 8, 12, 14, 16]  # those steps led to
    rewarded = Columns(variant=told["variant"], success="rewards", success_above=0.5,
                       features={"a": "actions.0"})  # fmt: skip
    assert read_trials(tmp_path / "door-v0", columns=rewarded).success.tolist() == [1, 1, 0]


def test_a_seed_or_its_absence_is_nothing_of_a_minari_episode(tmp_path):
    folder = minari(tmp_path / "door-v0")
    with h5py.File(folder / "data" / "main_data.hdf5", "a") as file:
        for name, seed in (("episode_0", "None"), ("episode_2", 7), ("episode_10", 8)):
            file[name].attrs["seed"] = seed
    columns = Columns(variant={"w": "episode.width_m"}, success="infos.success")
    trials = read_trials(folder, columns=columns)
    assert trials.n_trials == 3
    assert not any("seed" in name for name in trials.feature_names)


def test_what_minari_keeps_of_an_episode_is_read_in_every_shape_and_as_text(tmp_path):
    folder = minari(tmp_path / "door-v0")
    with h5py.File(folder / "data" / "main_data.hdf5", "a") as file:
        for place, name in enumerate(("episode_0", "episode_2", "episode_10")):
            file[name].attrs["friction"] = np.array([[0.1 * place]])
            file[name].attrs["size"] = np.array([place, 5.0])
            kinds = [b"flat", b"flat", b"steep"][place : place + 1] * 3
            file[name]["infos"]["terrain"] = np.array(kinds)
            file[name]["infos"]["end"] = np.array([b"", b"", b"door"], dtype=object)
    told = {"friction": "episode.friction", "size": "episode.size.0", "terrain": "infos.terrain"}
    columns = Columns(variant=told, success="infos.success")
    trials = read_trials(folder, columns=columns)
    np.testing.assert_allclose(trials.variant, [[0, 0, 0], [0.1, 1, 0], [0.2, 2, 1]])
    assert trials.axes[2].names == ("flat", "steep")
    assert "episode.size.1" in trials.feature_names
    assert "`infos.end`: text, left out." in trials.notes


def test_a_damaged_minari_data_set_is_refused(tmp_path):
    folder = minari(tmp_path / "door-v0")
    (folder / "data" / "main_data.hdf5").write_bytes(b"no HDF5")
    with pytest.raises(InputError, match="cannot be read as a Minari data set"):
        read_trials(folder)


def folder_of_trials(folder: Path) -> Path:
    folder.mkdir()
    for width, network, trial, success in ((0.5, "a", 0, 1), (0.5, "b", 0, 0), (0.9, "a", 1, 1)):
        name = f"width{width}_net-{network}_{trial}.csv"
        (folder / name).write_text(f"time_s,x\n0.0,1\n0.1,{width}\n")
        with (folder / "beside.csv").open("a") as file:
            file.write("" if file.tell() else "file,success\n")
            file.write(f"{name},{success}\n")
    return folder


def test_a_folder_with_one_file_per_trial_is_read(tmp_path):
    folder = folder_of_trials(tmp_path / "logs")
    pattern = "width{variant.width_m}_net-{network}_{trial}"
    columns = Columns(names=pattern, beside=str(folder / "beside.csv"))
    trials = read_trials(folder, columns=columns)
    assert trials.parameters == ("width_m",)
    assert trials.variant[:, 0].tolist() == [0.5, 0.5, 0.9]
    assert [trials.network_name(one) for one in trials.network] == ["a", "b", "a"]
    assert trials.success.tolist() == [True, False, True]
    assert trials.feature_names == ("time_s", "x")


def test_a_table_in_the_folder_says_it_all_by_itself(capsys, tmp_path):
    folder = folder_of_trials(tmp_path / "logs")
    (folder / "beside.csv").unlink()
    told = ("1,n,yes", "1,n,no", "2,n,yes")
    files = sorted(folder.iterdir())
    rows = [f"{file.stem},{one}" for file, one in zip(files, told, strict=True)]
    (folder / "trials.csv").write_text("file,variant,network,success\n" + "\n".join(rows))
    assert run(["convert", str(folder), "--out", str(tmp_path / "t.parquet")]) == 0
    assert "3 trials on 2 variants, 2 succeeded, 6 rows" in capsys.readouterr().out
    (folder / "another.csv").write_text("time_s,x\n0.0,1\n")
    with pytest.raises(InputError, match=r"trials.csv says nothing of `another`"):
        read_trials(folder)


def test_what_a_notebook_keeps_in_hidden_folders_is_no_trial(tmp_path):
    folder = tmp_path / "logs"
    (folder / ".ipynb_checkpoints").mkdir(parents=True)
    (folder / "a.csv").write_text(text())
    (folder / ".ipynb_checkpoints" / "a-checkpoint.csv").write_text(text())
    sound(read_trials(folder))
    (tmp_path / ".hidden").mkdir()
    sound(read_trials(folder.rename(tmp_path / ".hidden" / "logs")))  # that is asked for


@pytest.mark.parametrize("other", ["a.csv.gz", "a.parquet", "a.txt"])
def test_two_files_of_one_name_are_not_glued_into_one_trial(tmp_path, other):
    (tmp_path / "a.csv").write_text(text())
    (tmp_path / other).write_bytes(gzip.compress(text().encode()))
    with pytest.raises(InputError, match=rf"a\.csv and {other} have the same name `a`"):
        read_trials(tmp_path)


def test_files_of_one_folder_keep_the_axes_that_they_agree_on(tmp_path):
    one = trials_from_table(frame()).declared({"variant": "integer"})
    for name in ("a", "b"):
        write_trials(tmp_path / f"{name}.parquet", one)
    assert read_trials(tmp_path).axes == one.axes
    write_trials(tmp_path / "b.parquet", one.declared({"variant": "logarithmic"}))
    with pytest.raises(InputError, match="`variant` is integer here and logarithmic there"):
        read_trials(tmp_path)
    frame().write_parquet(tmp_path / "b.parquet")
    with pytest.raises(InputError, match="`variant` is continuous here and integer there"):
        read_trials(tmp_path)


def test_categories_of_a_folder_are_those_of_all_its_files(tmp_path):
    for name, kinds in (("a", ["up", "down"]), ("b", ["flat", "up"])):
        variant = pl.Series([kinds[0], kinds[0], kinds[1], kinds[1]])
        write_trials(
            tmp_path / f"{name}.parquet", trials_from_table(frame().with_columns(variant=variant))
        )
    trials = read_trials(tmp_path)
    names = [trials.axes[0].value(one) for one in trials.variant[:, 0]]
    assert names == ["up", "up", "down", "down", "flat", "flat", "up", "up"]
    (tmp_path / "b.parquet").unlink()
    frame().with_columns(variant=pl.lit("steep")).write_csv(tmp_path / "b.csv")
    assert read_trials(tmp_path).axes[0].names == ("down", "steep", "up")


def test_a_trial_whose_file_is_not_there_is_told(tmp_path):
    folder = folder_of_trials(tmp_path / "logs")
    with (folder / "beside.csv").open("a") as file:
        file.write("width0.9_net-b_7.csv,1\n")
    columns = Columns(names="width{variant}_net-{network}_{trial}",
                      beside=str(folder / "beside.csv"))  # fmt: skip
    trials = read_trials(folder, columns=columns)
    assert trials.n_trials == 3
    assert "beside.csv names `width0.9_net-b_7`, which" in trials.notes[0]


@pytest.mark.parametrize("comma", [",", ";"])
def test_a_table_beside_may_have_decimal_commas_whatever_the_files_have(tmp_path, comma):
    for name in ("a", "b"):
        decimal = "0,5" if comma == ";" else "0.5"
        (tmp_path / f"{name}.csv").write_text(f"time_s{comma}x\n0{comma}{decimal}\n")
    beside = "file;variant;network;success\na.csv;0,6;n;1\nb;7,5E-1;n;0\n"
    (tmp_path / "trials.csv").write_text(beside)
    trials = read_trials(tmp_path)
    assert trials.variant[:, 0].tolist() == [0.6, 0.75]
    assert trials.column("x").tolist() == [0.5, 0.5]


def test_a_row_of_a_folder_is_called_by_its_file(tmp_path):
    folder = folder_of_trials(tmp_path / "logs")
    (folder / "width0.9_net-a_1.csv").write_text("time_s,x\n0.0,1\n\n0.1,?\n")
    columns = Columns(names="width{variant}_net-{network}_{trial}",
                      beside=str(folder / "beside.csv"))  # fmt: skip
    with pytest.raises(InputError, match=r"row 3 of width0\.9_net-a_1: `x` is not a number"):
        read_trials(folder, columns=columns)
    with pytest.raises(InputError, match=r"the name of the file `width0\.5_net-a_0` is not as"):
        read_trials(folder, columns=Columns(names="w{variant}_net", beside=columns.beside))
    (folder / "width0.9_net-a_1.csv").write_text("time_s,y\n0.0,1\n")
    with pytest.raises(InputError, match=r"do not have the same columns \(x, y\)"):
        read_trials(folder, columns=columns)


def test_files_are_described_for_folders_only(tmp_path):
    (tmp_path / "t.csv").write_text(text())
    with pytest.raises(ConfigError, match="is not a folder"):
        read_trials(tmp_path / "t.csv", columns=Columns(names="{variant}"))


def uci(folder: Path) -> Path:
    """A stand-in with the structure of UCI's Robot Execution Failures: forces of a gripper.

    Several files (one per kind of movement), trials with identities in nanoseconds that come again
    in each file, an outcome in words on each row, another as ±1 on the last; all values made up.
    """
    folder.mkdir()
    rng = np.random.default_rng(0)
    words = ["normal", "collision", "normal", "obstruction", "fr_collision"]
    for kind, n_trials in (("lp1", 5), ("lp2", 3), ("lp3", 4)):
        lines = ["trial,outcome,code,Fx,Fy,Tz"]
        for trial in range(n_trials):
            word = words[trial]
            for step in range(15):
                code = "" if step < 14 else (1 if word == "normal" else -1)
                values = ",".join(str(value) for value in rng.integers(-90, 90, 3))
                lines.append(f"{1716800000123456000 + 20 * trial},{word},{code},{values}")
        (folder / f"{kind}.csv").write_text("\n".join(lines) + "\n")
    return folder


@pytest.mark.parametrize("by", ["words", "codes"])
@pytest.mark.parametrize("path", ["library", "command", "parquet"])
def test_the_stand_in_of_uci_gives_its_counts_by_every_path(capsys, tmp_path, by, path):
    folder = uci(tmp_path / "uci")
    features = {name: name for name in ("Fx", "Fy", "Tz")}
    outcome = {"success": "outcome", "success_words": ("normal",)}
    options = ["--success", "outcome", "--success-word", "normal"]
    if by == "codes":
        outcome = {"success": "code", "success_above": 0.0}
        options = ["--success", "code", "--success-above", "0"]
    columns = Columns(names="{variant.movement}", features=features, **outcome)
    if path == "library":
        trials = read_trials(folder, columns=columns)
    else:
        out = tmp_path / ("t.parquet" if path == "parquet" else "t.csv")
        options += [word for name in features for word in ("--feature", f"{name}={name}")]
        command = ["convert", str(folder), "--out", str(out), "--names", "{variant.movement}"]
        assert run([*command, *options]) == 0
        assert "12 trials on 3 variants, 6 succeeded, 180 rows" in capsys.readouterr().out
        trials = read_trials(out)
    _, which = trials.variants()
    assert trials.axes[0].names == ("lp1", "lp2", "lp3")
    assert np.bincount(which).tolist() == [5, 3, 4]
    assert np.bincount(which, weights=trials.success).tolist() == [2, 2, 2]
    if path != "parquet":  # which says it itself
        assert any("read as a category" in note for note in trials.notes)


def test_outcomes_in_other_words_are_refused_with_what_to_do(tmp_path):
    columns = Columns(names="{variant.movement}", success="outcome", features={"Fx": "Fx"})
    with pytest.raises(InputError, match=r"a word \(normal, collision, obstruction\)") as caught:
        read_trials(uci(tmp_path / "uci"), columns=columns)
    assert "--success-word" in str(caught.value)


OUTCOMES = "variant{0}network{0}trial{0}end{0}x\n1{0}0{0}0{0}{1}{0}1\n2{0}0{0}0{0}{2}{0}2\n"


def ended(folder: Path, separator: str, one: str, another: str, **told):
    path = folder / "t.csv"
    path.write_text(OUTCOMES.format(separator, one, another), encoding="utf-8")
    return read_trials(path, columns=Columns(success="end", **told))


def test_rewards_with_decimal_commas_are_above_a_number_or_not(tmp_path):
    assert ended(tmp_path, ";", "0", "0,9", success_above=0.5).success.tolist() == [False, True]
    assert ended(tmp_path, ";", "0,51", "-9,5", success_above=0.5).success.tolist() == [True, False]
    with pytest.raises(InputError, match=r"row 2: `end` is not a number \(timeout\)") as caught:
        ended(tmp_path, ";", "0,9", "timeout", success_above=0.5)
    assert "--success" in caught.value.remedy
    with pytest.raises(InputError, match=r"row 1: `end` is not a number \(0,9\)"):
        ended(tmp_path, ",", '"0,9"', "1", success_above=0.5)


@pytest.mark.parametrize("above", [np.nan, np.inf])
def test_no_outcome_is_above_what_is_no_number(above):
    with pytest.raises(ConfigError, match=f"`success_above` is {above}"):
        Columns(success_above=above)


def test_words_of_success_that_no_trial_has_are_told_with_those_there_are(tmp_path):
    with pytest.raises(InputError, match="no `end` is reachd: there are fell, reached") as caught:
        ended(tmp_path, ",", "reached", "fell", success_words=("reachd",))
    assert "--success-word" in caught.value.remedy
    trials = ended(tmp_path, ",", "Reached ", "fell", success_words=("reached", "partly"))
    assert trials.success.tolist() == [True, False]
    assert trials.notes == ("No `end` is partly: there are Reached, fell.",)


@pytest.mark.parametrize("word", ["2", "2.0"])
def test_codes_of_success_are_compared_as_numbers(tmp_path, word):
    code = {"success": pl.Series([1.0, 2.0, 3.0, None]), "trial": pl.Series([0, 0, 1, 1])}
    columns = Columns(success_words=(word,))
    table = frame().with_columns(variant=1, network=0, **code)
    assert trials_from_table(table, columns=columns).success.tolist() == [True, False]
    for one in ("2", "2.0", "2.00"):
        trials = ended(tmp_path, ",", one, "1", success_words=(word,))
        assert trials.success.tolist() == [True, False]


@pytest.mark.parametrize(
    "values", [[[1, 2]] * 4, np.arange(4).astype("m8[s]"), [{"a": 1}] * 4, [object()] * 4]
)
@pytest.mark.parametrize(
    "told", [{}, {"success_above": 0.5}, {"success_words": ("a",)}], ids=["plain", "above", "words"]
)
def test_outcomes_that_are_neither_numbers_nor_words_are_told_by_their_rows(values, told):
    table = frame().to_dict(as_series=False) | {"success": values}
    with pytest.raises(InputError, match="`success` is") as caught:
        trials_from_table(table, columns=Columns(**told))
    assert "damaged" not in str(caught.value)


@pytest.mark.parametrize(
    ("values", "kind"), [([0.2, 0.9, 0.4, 1.0], "a reward or a share"), ([3, 1, 2, 0], "a code")]
)
def test_rewards_and_shares_are_no_outcomes_until_it_is_said_above_what(values, kind):
    table = frame().with_columns(success=pl.Series(values))
    with pytest.raises(InputError, match=f"neither 0 nor 1 but {kind}"):
        trials_from_table(table)
    trials = trials_from_table(table, columns=Columns(success_above=0.5))
    assert trials.success.tolist() == [value > 0.5 for value in values]


def test_a_text_variant_is_a_category_and_a_mixed_one_is_refused():
    table = frame().with_columns(variant=pl.Series(["flat", "stairs", "flat", "stairs"]))
    trials = trials_from_table(table)
    assert trials.axes[0].names == ("flat", "stairs")
    assert trials.variant[:, 0].tolist() == [0, 1]
    mixed = frame().with_columns(variant=pl.Series(["0.5", "0.6", "0.7x", "0.8"]))
    with pytest.raises(InputError, match="row 3: `variant` is not a number"):
        trials_from_table(mixed)


def test_decimal_commas_beside_points_are_refused(tmp_path):
    (tmp_path / "t.csv").write_text("variant;network;trial;success;fx;fy\n"
                                    "1;0;0;1;0,5;1.234\n2;0;0;1;0,6;1.235\n")  # fmt: skip
    with pytest.raises(InputError, match="`fx` has decimal commas and `fy` points"):
        read_trials(tmp_path / "t.csv")


def test_what_the_page_on_formats_shows_runs():
    page = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    exec(compile(block, "formats.md", "exec"), {})  # noqa: S102
    options = {flag for line in page.splitlines() for flag in re.findall(r"--[a-z][a-z-]+", line)}
    with contextlib.redirect_stdout(io.StringIO()) as said, pytest.raises(SystemExit):
        run(["analyze", "--help"])
    assert options <= set(re.findall(r"--[a-z][a-z-]+", said.getvalue()))
