"""Tables of tracks: files as they were exported, columns by their names, cells as numbers."""

import codecs
import csv
import gzip
import io
import itertools
import os
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.array_file import most_content
from flockenv._io.extras import require
from flockenv._io.plain_file import open_plain
from flockenv.errors import ParameterError, short_repr
from flockenv.tracks.formats import FORMATS, NO_NUMBER
from flockenv.tracks.layout import TrackLayout

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

_TEXTS, _PARQUET = (".csv", ".tsv", ".txt"), (".parquet", ".pq")
SUFFIXES = (*_TEXTS, *(f"{text}.gz" for text in _TEXTS), *_PARQUET)
"""Endings of files that `read_tracks` takes."""


def long_table(rows: "pd.DataFrame", layout: TrackLayout) -> "tuple[pd.DataFrame, list[str]]":
    """Return the columns that a layout names, and the boats whose rows follow one another.

    A column whose name holds {id} stands for the columns of all boats. In a table with one row per
    boat there is one, "0".
    """
    pandas, find, fields = require("pandas", "plot"), finder(rows), layout.fields
    boats = _boats([*map(str, rows)], fields) if layout.is_wide else ["0"]
    own = [layout.id] if layout.id and not layout.is_wide else []
    columns = {
        name: pandas.concat([rows.iloc[:, find(name.replace("{id}", boat))] for boat in boats])
        for name in (*own, *fields, layout.frame)
    }
    return pandas.DataFrame(columns), boats


def finder(rows: "pd.DataFrame") -> Callable[[str], int]:
    """Return a function that finds a column by its name, in any case and with any blanks."""
    names, places = [*map(str, rows)], dict[str, list[int]]()
    for index, name in enumerate(names):
        places.setdefault(_key(name), []).append(index)

    def find(name: str) -> int:
        like = places.get(_key(name), [])
        found = [index for index in like if names[index] == name] or like
        if len(found) > 1:
            raise ParameterError(f"there are several columns {name!r}: give each its own name")
        if not found:
            hint = f"there are {listed(names)}{_separator_hint(names)}"
            raise ParameterError(f"column {name!r} is missing; {hint}")
        return found[0]

    return find


def _boats(names: list[str], fields: list[str]) -> list[str]:
    """Return what stands in place of {id} in the columns of a table with one row per frame."""
    first = re.compile(re.escape(fields[0]).replace(r"\{id\}", "(.+)"), re.IGNORECASE)
    keys = {_key(name) for name in names}
    boats = [found[1] for name in names if (found := first.fullmatch(name.strip()))]
    boats = [b for b in boats if keys.issuperset(_key(f.replace("{id}", b)) for f in fields)]
    if not boats:
        looks = " and ".join(map(repr, fields))
        raise ParameterError(f"no columns look like {looks}; there are {listed(names)}")
    return boats


def numbers(column: "pd.Series[Any]", layout: TrackLayout) -> Floats:
    """Return a column as numbers, NaN for missing and infinite ones; refuse other texts."""
    to_numeric, found = require("pandas", "plot").to_numeric, column
    if column.dtype.kind not in "iuf":
        texts = column.astype(object).where(column.notna(), "").astype(str).str.strip()
        found = to_numeric(texts.str.replace(layout.decimal, "."), errors="coerce")
        none = NO_NUMBER | {word.strip().lower() for word in layout.missing}
        strange = texts[found.isna() & ~texts.str.lower().isin(none)]
        if len(strange):
            decimal = "," if layout.decimal == "." else "."
            hint = f"; is decimal = {decimal!r}?" if _has_decimal(strange.iloc[0], decimal) else ""
            raise ParameterError(
                f"column {column.name!r} holds other things than numbers: "
                f"{short_repr(strange.iloc[0])} in {texts.index.name} {strange.index[0]}{hint}"
            )
    values: Floats = found.to_numpy(dtype=np.float64, na_value=np.nan).copy()
    none = to_numeric(list(layout.missing), errors="coerce")
    values[np.isinf(values) | np.isin(values, none)] = np.nan
    return values


def points_of(
    table: "pd.DataFrame", layout: TrackLayout, x: Iterable[str], y: Iterable[str]
) -> tuple[NDArray[np.complex128], NDArray[np.bool_]]:
    """Return points x + iy, shape (points, rows), and whether any of them marks a lost boat."""
    pairs = [[numbers(table[name], layout) for name in pair] for pair in zip(x, y, strict=True)]
    points = np.array([across + 1j * up for across, up in pairs])
    is_mark = np.isin(points, [complex(*mark) for mark in layout.lost])
    return points, np.asarray(is_mark.any(axis=0))


def _has_decimal(cell: str, mark: str) -> bool:
    """Return whether a cell is a number with a decimal mark."""
    whole, _, part = cell.lstrip("+-").partition(mark)
    return whole.isdigit() and part.isdigit()


def ending(path: Path) -> str:
    """Return a file's ending in lower case, such as .csv or .csv.gz."""
    suffixes = [suffix.lower() for suffix in path.suffixes[-2:]]
    return "".join(suffixes if suffixes[-1:] == [".gz"] else suffixes[-1:])


def check_ending(path: Path) -> None:
    """Refuse a missing file, and a file with another ending."""
    if not path.exists():
        raise ParameterError(f"{path} cannot be read: No such file or directory")
    if ending(path) not in SUFFIXES:
        raise ParameterError(
            f"{path} is not a table of tracks: its name ends in none of {', '.join(SUFFIXES)} "
            "(recordings end in .npz)"
        )


def read_table(path: Path, layout: TrackLayout) -> "pd.DataFrame":
    """Return the rows of a text or Parquet file; those of a text are numbered by their line."""
    pandas = require("pandas", "plot")
    check_ending(path)
    try:
        if ending(path) in _PARQUET:
            return plain_table(_read_parquet(pandas, path))
        return _read_text(pandas, _text_of(path), layout, layout.separator or _usual(path))
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"it cannot be read as a table: {error}") from error


def _usual(path: Path) -> str:
    """Return the separator that follows from a text file's ending."""
    return "\t" if ending(path).startswith(".tsv") else ","


def _read_parquet(pandas: ModuleType, path: Path) -> "pd.DataFrame":
    with open_plain(path) as file:
        size = os.fstat(file.fileno()).st_size
        held = require("pyarrow.parquet", "plot").ParquetFile(file).metadata
        cells = held.num_rows * held.num_columns
        if 8 * cells > most_content(size):
            raise ParameterError(f"it holds {cells} cells, too many for its {size} bytes")
        rows: pd.DataFrame = pandas.read_parquet(file)
    return rows


def _text_of(path: Path) -> str:
    """Return a file as text: UTF-8, UTF-16 by its mark, and otherwise Windows's own encoding."""
    with open_plain(path) as file:
        most = most_content(os.fstat(file.fileno()).st_size)
        opened = gzip.GzipFile(fileobj=file) if path.suffix.lower() == ".gz" else file
        data: bytes = opened.read(most + 1)
    if len(data) > most:
        raise ParameterError(f"it holds more than the {most} bytes that are accepted")
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        text = data.decode("utf-16")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("cp1252", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def spelling_of(path: Path) -> dict[str, Any]:
    """Return the unusual ones among the separator, decimal and skip of a text file."""
    if ending(path) in _PARQUET:
        return {}
    lines = _text_of(path).splitlines()[:100] or [""]
    mark = _separator_of(lines)
    rows = [line.split(None if mark == " " else mark) for line in lines]
    widths = [*map(len, rows)]
    # The header is the first line with as many cells as the next ones, or the first of its levels.
    in_levels = (line for line in range(4) if _levels(rows[line : line + 10])[0])
    skip = next(in_levels, widths.index(max(widths)))
    form: dict[str, Any] = {"skip": skip} if skip else {}
    if mark != _usual(path):
        form["separator"] = mark
    if mark != "," and any(_has_decimal(cell.strip(), ",") for row in rows[1:] for cell in row):
        form["decimal"] = ","
    return form


def _separator_of(lines: list[str]) -> str:
    """Return the separator that is most frequent in the lines."""
    counts = {mark: max(line.count(mark) for line in lines) for mark in ";\t|,"}
    if max(counts.values()) < 2:  # Names may hold blanks, too.
        counts[" "] = max(len(line.split()) - 1 for line in lines)
    return max(counts, key=lambda mark: counts[mark])


def _read_text(
    pandas: ModuleType, text: str, layout: TrackLayout, separator: str
) -> "pd.DataFrame":
    rows = _cells_of(text, separator, layout.skip, 10)
    names, height = (list(layout.header), 0) if layout.header else _header(rows)
    first = layout.skip + height + 1
    for line, row in enumerate(rows[height:], first):
        if any(row[len(names) :]):
            raise ParameterError(
                f"the header names {len(names)} columns, and line {line} holds {len(row)} values: "
                f"every column needs a name{_separator_hint(names)}"
            )
    names += [f"unnamed {index}" for index in range(len(names), max(map(len, rows)))]
    table: pd.DataFrame = pandas.read_csv(
        io.StringIO(text),
        sep=r"\s+" if separator == " " else separator,
        skiprows=first - 1,
        header=None,
        names=range(len(names)),
        index_col=False,
        dtype=str,
        keep_default_na=False,
        na_values=[""],
        skipinitialspace=True,
        skip_blank_lines=False,
    )
    lines = pandas.RangeIndex(first, first + len(table), name="line")
    table = table.set_axis(names, axis=1).set_axis(lines).dropna(how="all")
    # Some programs write units, or longer names, into the lines under the header.
    head = table.head(0 if layout.header else 4)
    return table.drop(index=[line for line, row in head.iterrows() if not any(map(is_value, row))])


def _cells_of(text: str, separator: str, skip: int, count: int) -> list[list[str]]:
    """Return the cells of the first lines after the skipped ones."""
    lines = itertools.islice(io.StringIO(text), skip, skip + count)
    if separator == " ":
        return [line.split() for line in lines]
    rows = csv.reader(lines, delimiter=separator, skipinitialspace=True)
    return [[cell.strip() for cell in row] for row in rows]


def _header(rows: list[list[str]]) -> tuple[list[str], int]:
    """Return the names of columns, and the number of lines that they take."""
    if not rows or not any(rows[0]):
        raise ParameterError("there is no header in its first line")
    lines, own = _levels(rows)
    if not lines:
        # A separator at the end of the line leaves an empty name.
        return [name or f"unnamed {index}" for index, name in enumerate(rows[0])], 1
    levels = zip(*(rows[line][own:] for line in lines), strict=False)
    return ["frame", *rows[lines[-1]][1:own], *map(_joined, levels)], lines[-1] + 1


def _levels(rows: list[list[str]]) -> tuple[list[int], int]:
    """Return the lines with the levels of a header, and the number of columns before the boats.

    There are no lines if the header has no levels. The columns before the boats hold times; in a
    header they hold the names of its levels.
    """
    own = 1 if any(rows[:1] and rows[0][:1]) else 2
    starts = [next(filter(None, row[:own]), "").lower() for row in rows]
    for levels in (program.levels for program in FORMATS if program.levels):
        if starts[:1] == [levels[0]] and levels[-1] in starts:
            under = range(1, starts.index(levels[-1]) + 1)
            return [line for line in under if starts[line] in levels], own
    return [], own


def _joined(levels: Iterable[object]) -> str:
    """Return the name of a column that is named in levels: individual, body part, coord."""
    *individual, part, coord = map(str, levels)
    return f"{'.'.join([*individual, part])}_{coord}"


def is_value(cell: object) -> bool:
    """Return whether a cell begins like a number."""
    return str(cell).lstrip("-+.")[:1].isdigit()


def plain_table(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return a table with one name per column, in which the index is a column, too."""
    if not hasattr(table, "columns") or not hasattr(table, "index"):
        raise TypeError(
            f"tracks must be a file, a DataFrame of pandas or a Dataset of xarray, not "
            f"{short_repr(table)}"
        )
    columns: Any = table.columns
    index: Any = table.index
    if columns.nlevels > 1 and "coords" in columns.names:
        kept = columns.droplevel("scorer") if "scorer" in columns.names else columns
        table = table.set_axis([_joined(levels) for levels in kept], axis=1)
        index = index.rename(index.name or "frame")
    elif columns.nlevels > 1:
        raise ParameterError(
            f"the columns have {columns.nlevels} levels, such as {columns[0]!r}: give each column "
            "one name"
        )
    for level, name in enumerate(index.names):
        values = index.get_level_values(level)
        if name in table and not np.array_equal(values, table[name].to_numpy()):
            raise ParameterError(
                f"the index and a column are both called {name!r}, and differ: rename one"
            )
        table = table if name is None else table.assign(**{str(name): values})
    return table.reset_index(drop=True).rename_axis(index="row")


def _key(name: object) -> str:
    return str(name).strip().lstrip("#%").strip().casefold()


def listed(names: list[str]) -> str:
    """Return names separated by commas; of very many names only the first ones."""
    more = f" and {len(names) - 40} more" if len(names) > 40 else ""
    return f"{', '.join(names[:40])}{more}"


def _separator_hint(names: list[str]) -> str:
    """Return a hint for a header read as one name, or for numbers in its place."""
    if sum(map(is_value, names)) > len(names) / 2:
        return ": `header` names the columns of a file whose first line does not"
    if names[0][:1] in ("#", "%", "/") and len(names) == 1:
        return ": `skip` leaves out lines before the header, such as remarks"
    mark = _separator_of(names)
    if len(names) > 1 or mark not in names[0]:
        return ""
    return f": the header looks like one with separator = {mark!r}"
