"""CSV as people and spreadsheets write it: what separates it is found, every column is text.

Nothing is guessed about a column here: its type is decided later, once, from all of its entries.
"""

from __future__ import annotations

import csv
import gzip
import inspect
import io
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import polars as pl

from surmount.core.errors import InputError
from surmount.trials.source import POLARS_ERRORS, Source

_SEPARATORS = (",", ";", "\t", "|")
_BLANK = f'{"".join(_SEPARATORS)} \r\n"'
_SHORT_ROWS: dict[str, Any] = (
    {"missing_columns": "insert"}
    if "missing_columns" in inspect.signature(pl.scan_csv).parameters
    else {}
)
"""Lets the first row be as short as others may be; Polars before 1.39 needs not be told."""
_HEAD_CHARACTERS = 1 << 18
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_UNNAMED = "surmount.unnamed."
_FILLED = "surmount.filled"
CSV_ENDINGS = (".csv", ".tsv", ".txt")


def open_csv(path: Path) -> Source:
    """Open a CSV file, compressed or not, without reading more than its head.

    The separator is the one of comma, semicolon, tab and bar that divides the header most, or the
    one that a first line ``sep=;`` names. Blank rows are skipped, columns without a name and
    without entries left out.

    Raises
    ------
    InputError
        If it is missing, not text in UTF-8 (or UTF-16 with its mark), or its rows are not of the
        header's length.
    """
    content: Path | bytes = path
    try:
        with path.open("rb") as file:
            mark = file.read(2)
        if mark in _UTF_16:
            content = path.read_bytes().decode("utf-16").encode()
        head = _head(content)
    except UnicodeDecodeError as error:
        raise _not_utf8(path, error) from error
    except (OSError, EOFError, zlib.error, ValueError, *POLARS_ERRORS) as error:
        raise InputError(
            f"{path} cannot be read ({_first_line(error)}).",
            remedy="Give the path of a readable table.",
        ) from error
    if "\r" in head and "\n" not in head:
        raise InputError(
            f"{path} ends its lines by CR (carriage return) alone.",
            remedy="Save it with line ends of LF or CRLF.",
        )
    separator, header, skipped = _header(head)
    if not header:
        return Source(name=str(path), frame=pl.LazyFrame())
    names = [name or f"{_UNNAMED}{index}" for index, name in enumerate(header)]
    again = sorted(name for name, times in Counter(names).items() if times > 1)
    if again:
        raise InputError(
            f"{path}: several columns have the name `{again[0]}`.",
            remedy="Name each column once.",
        )
    whole = pl.scan_csv(
        io.BytesIO(content) if isinstance(content, bytes) else content,
        has_header=False,
        skip_lines=skipped,
        separator=separator,
        schema=dict.fromkeys(names, pl.String),
        glob=False,
        **_SHORT_ROWS,
    )
    # As a column: as a predicate it takes time quadratic in the number of columns.
    marked = whole.with_columns(pl.any_horizontal(pl.all().is_not_null()).alias(_FILLED))

    def place(row: int) -> str:
        """Return a row's number among those of the file, blank ones counted."""
        return str(
            int(source.collect(marked.select(pl.col(_FILLED).arg_true().gather(row))).item()) + 1
        )

    source = Source(
        name=str(path),
        frame=marked.filter(_FILLED).drop(_FILLED),
        place=place,
        decimal_commas=separator != ",",
        explain=partial(_explain, path, content, separator, len(names), skipped),
    )
    return _without_unnamed(source, names)


def _head(content: Path | bytes) -> str:
    """Return the first characters of a file, whole lines where there are several."""
    if _is_zstd(content):
        lines = pl.read_csv(
            content,
            has_header=False,
            separator="\x1f",
            quote_char=None,
            n_rows=20,
            infer_schema=False,
            truncate_ragged_lines=True,
            glob=False,
        )
        return "\n".join(str(line or "") for line in lines.to_series()) + "\n"
    with _opened(content) as text:
        return text.read(_HEAD_CHARACTERS)


def _is_zstd(content: Path | bytes) -> bool:
    """Whether content is compressed so that Python before 3.14 has no reader of its own."""
    return isinstance(content, Path) and content.suffix.lower() in (".zst", ".zstd")


def _opened(content: Path | bytes) -> io.TextIOWrapper:
    binary: Any = io.BytesIO(content) if isinstance(content, bytes) else None
    if isinstance(content, Path):
        opened = gzip.open if content.suffix.lower() == ".gz" else io.open
        binary = opened(content, "rb")
    return io.TextIOWrapper(binary, encoding="utf-8-sig", newline="")


def _header(head: str) -> tuple[str, list[str], int]:
    """Return the separator, the names of the columns and the lines before the first row."""
    lines, skipped = _without_blank_lines(head, 0)
    separators = _SEPARATORS
    first, _, rest = lines.partition("\n")
    if first.strip().strip('"').lower().startswith("sep="):
        named = first.strip("\r\n").strip('"')[len("sep=") :]
        lines, skipped = _without_blank_lines(rest, skipped + 1)
        separators = (named[:1] or "\t",)
    found: list[tuple[str, list[str], int]] = []
    for separator in separators:
        reader = csv.reader(io.StringIO(lines, newline=""), delimiter=separator)
        try:
            header = [name.strip() for name in next(reader, [])]
        except (csv.Error, StopIteration):
            continue
        found.append((separator, header, skipped + reader.line_num))
    if not found:
        return ",", [], 0
    return max(found, key=lambda one: len(one[1]))  # of several as good, the first


def _without_blank_lines(lines: str, skipped: int) -> tuple[str, int]:
    """Return lines without the first ones that are blank, and how many were skipped in all."""
    while lines and not lines.partition("\n")[0].strip(_BLANK):
        lines, skipped = lines.partition("\n")[2], skipped + 1
    return lines, skipped


def _explain(
    path: Path, content: Path | bytes, separator: str, n_columns: int, skipped: int
) -> None:
    """Raise what is wrong with a file; of quotes only if there are some in entries."""
    quoted = False
    try:
        for row, entries in enumerate(_rows(content, separator, skipped), start=1):
            if len(entries) > n_columns:
                raise InputError(
                    f"{path}: row {row} has {len(entries)} entries under {n_columns} column names.",
                    remedy="Give each row one entry per column, and quote entries that hold the "
                    "separator.",
                )
            quoted = quoted or any('"' in entry for entry in entries)
    except UnicodeDecodeError as error:
        raise _not_utf8(path, error) from error
    except (OSError, EOFError, zlib.error):
        return
    except csv.Error:
        quoted = True
    if quoted:
        raise InputError(
            f"{path} cannot be read as CSV: a quote is opened and not closed, or stands in the "
            "middle of an entry.",
            remedy="Quote whole entries, and double the quotes inside.",
        )


def _rows(content: Path | bytes, separator: str, skipped: int) -> Iterator[list[str]]:
    if _is_zstd(content):
        return
    with _opened(content) as text:
        for _ in range(skipped):
            text.readline()
        yield from csv.reader(text, delimiter=separator, strict=True)


def _without_unnamed(source: Source, names: list[str]) -> Source:
    """Leave out columns that have neither a name nor entries: blank tails of lines."""
    unnamed = [name for name in names if name.startswith(_UNNAMED)]
    if not unnamed:
        return source
    filled = source.collect(source.frame.select(pl.col(unnamed).is_not_null().any()))
    kept = [name for name in unnamed if filled[name].item()]
    frame = source.frame.drop([name for name in unnamed if name not in kept])
    blanks = {name: " " * place for place, name in enumerate(kept, start=1)}
    return replace(source, frame=frame.rename(blanks))


def _not_utf8(path: Path, error: UnicodeDecodeError) -> InputError:
    return InputError(
        f"{path} is not UTF-8 text ({error.reason} at byte {error.start}).",
        remedy="Save it as CSV in UTF-8.",
    )


def _first_line(error: BaseException) -> str:
    return str(error).splitlines()[0][:200] if str(error) else type(error).__name__
