"""The contract of the table of trials: what is read, what is refused, and how it is said."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic_trials import SyntheticFamily

from surmount.core.errors import InputError, SurmountError
from surmount.trials.table import (
    read_trials,
    trials_from_table,
    trials_to_table,
    write_trials,
)
from surmount.trials.trials import Trials

FAMILY = SyntheticFamily(sizes=(2, 2), behaviours=(0, 1), trials=4, steps=12)


def table(**changes):
    """A sound table of two variants with two trials of three rows, with changed columns."""
    columns = {
        "variant": np.repeat([10.0, 20.0], 6),
        "network": np.zeros(12, dtype=int),
        "trial": np.tile(np.repeat([0, 1], 3), 2),
        "success": np.repeat([1, 0, 1, 1], 3),
        "time_s": np.tile([0.0, 0.1, 0.2], 4),
        "x_mm": np.arange(12.0),
    }
    columns.update(changes)
    return {name: column for name, column in columns.items() if column is not None}


def same(a: Trials, b: Trials) -> None:
    assert (a.parameters, a.feature_names) == (b.parameters, b.feature_names)
    for name in ("variant", "network", "repetition", "success", "starts", "features"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_writing_and_reading_gives_the_same_trials_bit_for_bit(tmp_path: Path, suffix: str):
    trials = FAMILY.generate()
    write_trials(tmp_path / f"trials{suffix}", trials)
    same(read_trials(tmp_path / f"trials{suffix}"), trials)


@pytest.mark.parametrize("frame", [pd.DataFrame, pl.DataFrame, pl.LazyFrame, dict])
def test_data_frames_and_dictionaries_are_read_alike(frame):
    trials = FAMILY.generate()
    same(trials_from_table(frame(trials_to_table(trials))), trials)


def test_several_parameters_become_the_axes_of_the_variants():
    columns = table(variant=None)
    columns["variant.height_mm"] = np.repeat([10.0, 20.0], 6)
    columns["variant.friction"] = np.repeat([0.5, 0.5], 6)
    trials = trials_from_table(columns)
    assert trials.parameters == ("height_mm", "friction")
    assert trials.variants()[0].tolist() == [[10.0, 0.5], [20.0, 0.5]]


def test_rows_of_different_trials_may_be_interleaved():
    columns = table()
    order = np.argsort(columns["time_s"], kind="stable")
    mixed = trials_from_table({name: column[order] for name, column in columns.items()})
    same(mixed, trials_from_table(columns))


def test_named_networks_are_numbered_in_alphabetical_order():
    names = np.repeat(["b", "a"], 6)
    assert trials_from_table(table(network=names)).network.tolist() == [1, 1, 0, 0]


def test_all_problems_are_named_at_once_with_rows_and_remedies():
    x = np.arange(12.0)
    x[[3, 7]] = np.nan, np.inf
    success = np.repeat([1, 0, 1, 1], 3)
    success[1] = 5
    with pytest.raises(InputError) as caught:
        trials_from_table(table(x_mm=x, success=success, network=None))
    text = str(caught.value)
    assert "4 problems" in text
    assert "column `network` is missing" in text
    assert "row 4: `x_mm` is missing or NaN" in text
    assert "row 8: `x_mm` is infinite" in text
    assert "Clip it" in text
    assert "row 2: `success` is neither 0 nor 1" in text


def test_without_networks_problems_of_the_variants_are_named_as_well():
    variant = np.repeat([10.0, 10.000000001], 6)
    with pytest.raises(InputError) as caught:
        trials_from_table(table(variant=variant, network=None), minimum_samples=7)
    text = str(caught.value)
    for problem in ("column `network` is missing", "by rounding only", "has 6 rows"):
        assert problem in text


def test_problems_of_values_do_not_hide_problems_of_trials_and_variants():
    x = np.arange(12.0)
    x[3] = np.nan
    success = np.repeat([1, 0, 1, 1], 3)
    success[2] = 0
    time = np.tile([0.0, 0.1, 0.2], 4)
    time[7] = 0.0
    with pytest.raises(InputError) as caught:
        trials_from_table(
            table(x_mm=x, success=success, time_s=time), minimum_variants=3, minimum_samples=7
        )
    text = str(caught.value)
    for problem in (
        "row 4: `x_mm` is missing",
        "row 3: `success` falls",
        "row 8: the same `time_s`",
        "only 2 variants",
        "variant 10 has 6 rows, fewer than 7",
    ):
        assert problem in text


X = np.arange(12.0)


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ({"x_mm": np.ma.masked_array(X, X == 3)}, "row 4: `x_mm` is missing"),
        ({"network": np.ma.masked_array(["a"] * 12, X == 3)}, "row 4: `network` is missing"),
        ({"network": np.array(["a", None, float("nan"), pd.NA] * 3, object)}, "rows 2, 3, 4, 6, 7"),
        ({"x_mm": [[1.0], [2.0, 3.0]] * 6}, "`x_mm` holds lists of 1 to 2 entries"),
        ({"x_mm": np.zeros((12, 2, 2))}, "`x_mm` has not one value per row"),
        ({"x_mm": 3.0}, "`x_mm` has not one value per row"),
        ({"x_mm": X[:7]}, r"columns differ in length \(.*time_s 12, x_mm 7\)"),
        ({"x_mm": np.array([10**400] * 12, object)}, "`x_mm` is infinite"),
        ({"trial": np.arange(12) / 2}, "`trial` is neither a whole number, nor a name"),
        ({"variant": 2**53 + 2 * np.arange(12)}, r"`variant` is 2\^53 or larger"),
        ({"x_mm": X + 1j}, "`x_mm` is not a number"),
        ({"time_s": np.tile([0.0, 0.2, 0.1], 4)}, "rows 3, 6, 9, 12: `time_s` runs backwards"),
        ({"variant": np.repeat([0.3, 0.1 + 0.2], 6)}, "differ by rounding only"),
    ],
)
def test_columns_that_hold_no_sound_numbers_are_named(column, words):
    with pytest.raises(InputError, match=words):
        trials_from_table(table(**column))


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        (pd.DataFrame(table()).assign(y=1)[["variant", "y", "y"]], "several columns .* `y`"),
        (pl.DataFrame({"a": [1, 2]}).to_struct("a").to_frame(), "`a` is not a number"),
        (np.zeros(3, dtype=[("variant", float)]), "ndarray, not a table"),
        ([1, 2, 3], "list, not a table"),
        (None, "NoneType, not a table"),
        ({}, "no rows"),
    ],
)
def test_what_is_no_table_is_refused_in_a_sentence(frame, words):
    with pytest.raises(InputError, match=words) as caught:
        trials_from_table(frame)
    assert caught.value.remedy


def test_success_that_changes_within_a_trial_is_refused():
    success = np.repeat([1, 0, 1, 1], 3)
    success[2] = 0
    with pytest.raises(InputError, match=r"row 3: `success` falls"):
        trials_from_table(table(success=success))


def test_rows_logged_twice_are_refused_by_their_time():
    with pytest.raises(InputError, match=r"row 2: the same `time_s`"):
        trials_from_table(
            table(time_s=np.tile([0.0, 0.0, 0.2], 4))
            | {"trial": np.arange(12) // 3, "success": np.ones(12)}
            | {"time_s": np.r_[0.0, 0.0, 0.2, np.tile([0.0, 0.1, 0.2], 3)]}
        )


def test_too_few_variants_and_samples_are_refused_on_request():
    one = {name: column[:6] for name, column in table().items()}
    with pytest.raises(InputError) as caught:
        trials_from_table(one, minimum_variants=2, minimum_samples=7)
    assert "only one variant (10)" in str(caught.value)
    assert "variant 10 has 6 rows, fewer than 7" in str(caught.value)


def test_a_row_of_another_length_is_named(tmp_path: Path):
    (tmp_path / "t.csv").write_text("variant,network,trial,success,x\n1,0,0,1,2\n1,0,0,1\n")
    with pytest.raises(InputError, match="row 2: `x` is missing"):
        read_trials(tmp_path / "t.csv")
    (tmp_path / "t.csv").write_text("variant,network,trial,success,x\n1,0,0,1,2\n1,0,0,1,2,3\n")
    with pytest.raises(InputError, match="row 2 has 6 entries under 5"):
        read_trials(tmp_path / "t.csv")


@pytest.mark.parametrize("name", ["missing.csv", "missing.parquet", "trials.xlsx"])
def test_unusable_files_are_refused_in_one_sentence(tmp_path: Path, name: str):
    with pytest.raises(InputError) as caught:
        read_trials(tmp_path / name)
    assert name in caught.value.message
    assert caught.value.remedy


PROGRAM = """
import resource, sys
from surmount.trials.table import read_trials
read_trials(sys.argv[1])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
trials = read_trials(sys.argv[2])
print(trials.n_trials, 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before))
"""


@pytest.mark.parametrize(
    ("suffix", "most"),
    [
        # 8 bytes a feature remain, and as much is there until a column is in its place.
        (".parquet", 2.5),
        # Text is read in pieces, as many as there are threads.
        (".csv", 3.5),
    ],
)
def test_a_large_table_is_read_in_little_more_than_its_features(tmp_path: Path, suffix, most):
    n_rows, n_features = 1_000_000, 6
    rows = np.arange(n_rows)
    frame = pl.DataFrame(
        {
            "variant": (rows // 50_000).astype(float),
            "network": rows // 25_000 % 2,
            "trial": rows // 1_000 % 25,
            "success": np.ones(n_rows, dtype=int),
            "time_s": 0.02 * (rows % 1_000),
            **{f"x{i}": np.sqrt(rows + i) for i in range(n_features - 1)},
        }
    )
    for name, part in (("small", frame.head(30_000)), ("large", frame)):
        path = tmp_path / f"{name}{suffix}"
        part.write_parquet(path) if suffix == ".parquet" else part.write_csv(path)
    done = subprocess.run(  # noqa: S603
        [
            sys.executable,
            "-c",
            PROGRAM,
            *(str(tmp_path / f"{n}{suffix}") for n in ("small", "large")),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    n_trials, added = map(int, done.stdout.split())
    assert n_trials == 1_000
    assert added <= most * 8 * n_features * n_rows


def test_names_of_networks_read_alike_in_every_piece_of_a_csv(tmp_path: Path):
    n_rows = 50_000  # more than one piece; only the last row has a name that is no number
    rows = [f"{i // 25_000},{i % 2 + 1},{i // 2},1,{i}.5" for i in range(n_rows)]
    rows[-1] = f"1,b,{n_rows},1,0.5"
    (tmp_path / "t.csv").write_text("variant,network,trial,success,x\n" + "\n".join(rows) + "\n")
    assert np.unique(read_trials(tmp_path / "t.csv").network).tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("variant,größe\n1,0\n".encode("latin-1"), "is not UTF-8"),
        (b'variant,x\n1,"0\n', "a quote is opened and not closed"),
        (b'variant,x\n1,a"0\n', "a quote is opened and not closed"),
    ],
)
def test_csv_of_another_make_is_refused_by_what_is_unusual(tmp_path: Path, content, words):
    (tmp_path / "t.csv").write_bytes(content)
    with pytest.raises(InputError, match=words) as caught:
        read_trials(tmp_path / "t.csv")
    assert caught.value.remedy


@pytest.mark.parametrize(
    "column",
    [
        pl.Series([["a"]] * 12),
        pl.Series([{"a": 1, "b": 2}] * 12),
        pl.Series([b"12"] * 12),
        pl.Series([None] * 12),
        pl.Series(["2020-01-01"] * 12).str.to_date(),
        pl.Series([1.0, None] * 6),
        pl.Series(["ten"] * 12).cast(pl.Categorical),
    ],
)
def test_parquet_columns_of_other_types_are_named(tmp_path: Path, column: pl.Series):
    pl.DataFrame(table()).with_columns(odd=column).write_parquet(tmp_path / "t.parquet")
    with pytest.raises(InputError, match=r"`odd` (is not a number|is missing|holds lists of text)"):
        read_trials(tmp_path / "t.parquet")


@pytest.mark.parametrize("kind", [pl.Decimal(10, 3), pl.Float32, pl.Int8, pl.UInt64, pl.String])
def test_parquet_columns_of_any_kind_of_number_are_read(tmp_path: Path, kind):
    frame = pl.DataFrame(table()).with_columns(pl.col("x_mm").cast(kind))
    frame.write_parquet(tmp_path / "t.parquet")
    np.testing.assert_array_equal(read_trials(tmp_path / "t.parquet").column("x_mm"), X)


def test_text_that_is_no_parquet_is_refused(tmp_path: Path):
    (tmp_path / "t.parquet").write_text("no parquet at all")
    with pytest.raises(InputError, match="cannot be read as a table"):
        read_trials(tmp_path / "t.parquet")


@settings(max_examples=60)
@given(st.binary(max_size=300) | st.text(max_size=300).map(str.encode))
def test_any_bytes_are_refused_or_read_never_a_traceback(content: bytes):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "t.csv"
        path.write_bytes(content)
        with pytest.raises(SurmountError):
            read_trials(path)


def sound_or_refused(path: Path) -> None:
    trials = None
    with contextlib.suppress(SurmountError):
        trials = read_trials(path)
    if trials is not None:
        assert np.isfinite(trials.features).all()
        assert np.isfinite(trials.variant).all()


@settings(max_examples=80)
@given(st.data())
def test_a_damaged_file_is_refused_or_still_sound(data):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / data.draw(st.sampled_from(["t.csv", "t.parquet"]))
        write_trials(path, trials_from_table(table()))
        content = bytearray(path.read_bytes())
        place = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.integers(0, 8))
        content[place : place + length] = data.draw(st.binary(max_size=8))
        path.write_bytes(bytes(content))
        sound_or_refused(path)


@settings(max_examples=60)
@given(
    name=st.text(max_size=8),
    entries=st.lists(st.sampled_from(["1", "-0.5", "1e3", "", "nan", "x", "١", "1_0", '"', "é"])),
)
def test_any_names_and_texts_in_a_csv_are_sound_or_refused(name, entries):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "t.csv"
        lines = [f"1,0,{row},1,{entry}" for row, entry in enumerate(entries)]
        text = "\n".join([f"variant,network,trial,success,{name}", *lines])
        path.write_text(text, encoding="utf-8", errors="surrogatepass")
        sound_or_refused(path)


cells = st.one_of(
    st.none(), st.floats(), st.integers(-(2**70), 2**70), st.text(max_size=4), st.booleans()
)


@settings(max_examples=150)
@given(
    st.dictionaries(
        st.sampled_from(
            ["variant", "variant.a", "variant.", "network", "trial", "success", "time_s", "x", ""]
        ),
        st.lists(cells, min_size=3, max_size=3),
        max_size=8,
    )
)
def test_any_columns_give_sound_trials_or_a_sentence(columns):
    trials = None
    with contextlib.suppress(InputError):
        trials = trials_from_table({k: np.asarray(v, dtype=object) for k, v in columns.items()})
    if trials is not None:
        assert np.isfinite(trials.features).all()
        assert np.isfinite(trials.variant).all()
        assert trials.n_samples == 3
