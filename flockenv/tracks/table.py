"""Tables of tracks: files as they were exported, columns by their names, cells as numbers."""

import codecs
import csv
import gzip
import io
import itertools
import os
import re
from collections.abc import Iterable
from functools import cached_property
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


class Table:
    """Rows of tracks, numbered by their line or row, as a layout reads them.

    Columns are found by their names in any case. A column whose name in the layout holds {id}
    stands for the columns of all boats, one after the other.
    """

    def __init__(self, rows: "pd.DataFrame", layout: TrackLayout) -> None:
        self.rows, self.layout = rows, layout
        self.names = [*map(str, rows)]
        self._by_key: dict[str, list[int]] = {}
        for index, name in enumerate(self.names):
            self._by_key.setdefault(_key(name), []).append(index)

    @cached_property
    def boats(self) -> list[str]:
        """The names that stand for {id}; "0" in a table that has one row per boat."""
        if not self.layout.is_wide:
            return ["0"]
        fields = [name for columns in self.layout.columns.values() for name in columns]
        first = re.compile(re.escape(fields[0]).replace(r"\{id\}", "(.+)"), re.IGNORECASE)
        names = [found[1] for name in self.names if (found := first.fullmatch(name.strip()))]
        wanted = {name: {_key(field.replace("{id}", name)) for field in fields} for name in names}
        names = [name for name in names if wanted[name] <= self._by_key.keys()]
        if not names:
            looks = " and ".join(map(repr, fields))
            raise ParameterError(f"no columns look like {looks}; there are {listed(self.names)}")
        return names

    @cached_property
    def is_named(self) -> bool:
        """Whether a column names the boats. If no row has a name, all rows belong to one boat."""
        if self.layout.id is None or self.layout.is_wide:
            return False
        ids = self.column(self.layout.id)
        return not (ids.isna() | ids.astype(str).str.strip().str.lower().isin(NO_NUMBER)).all()

    @property
    def index(self) -> "pd.Index[Any]":
        """The line or row of each of the boats' rows."""
        index = self.rows.index
        return index.append([index] * (len(self.boats) - 1)).rename(index.name)

    def index_of(self, name: str) -> int:
        """Return the index of a column, whose name may differ in case or blanks."""
        like = self._by_key.get(_key(name), [])
        found = [index for index in like if self.names[index] == name] or like
        if len(found) > 1:
            raise ParameterError(f"there are several columns {name!r}: give each its own name")
        if not found:
            hint = f"there are {listed(self.names)}{_separator_hint(self.names)}"
            raise ParameterError(f"column {name!r} is missing; {hint}")
        return found[0]

    def column(self, name: str) -> "pd.Series[Any]":
        """Return the column of a name, or the columns of all boats one after the other."""
        if "{id}" not in name:
            return self.rows.iloc[:, self.index_of(name)]
        boats = [self.index_of(name.replace("{id}", boat)) for boat in self.boats]
        cells = self.rows.iloc[:, boats].to_numpy().T.ravel()
        return require("pandas", "plot").Series(cells, self.index)  # type: ignore[no-any-return]

    def numbers(self, name: str) -> Floats:
        """Return a column as numbers, NaN for missing and infinite ones."""
        to_numeric, found = require("pandas", "plot").to_numeric, self.column(name)
        if found.dtype.kind not in "iuf":
            texts = found.astype(object).where(found.notna(), "").astype(str).str.strip()
            decimals = texts.str.replace(self.layout.decimal, ".")
            found = to_numeric(decimals, errors="coerce")
            self._check_words(name, texts[found.isna()])
        values = found.to_numpy(dtype=np.float64, na_value=np.nan).copy()
        none = to_numeric(list(self.layout.missing), errors="coerce")
        values[np.isinf(values) | np.isin(values, none)] = np.nan
        return values

    def points(self, x: Iterable[str], y: Iterable[str]) -> tuple[Floats, Floats, Any]:
        """Return the means of x and of y columns, and whether any of them marks a lost boat."""
        points = np.array([[self.numbers(name) for name in names] for names in (x, y)])
        is_lost = np.zeros(points.shape[-1], bool)
        for mark in self.layout.lost:
            is_lost |= ((points[0] == mark[0]) & (points[1] == mark[1])).any(axis=0)
        return *points.mean(axis=1), is_lost

    def _check_words(self, name: str, texts: "pd.Series[Any]") -> None:
        """Refuse texts that are not numbers and do not stand for a missing one."""
        none = NO_NUMBER | {word.strip().lower() for word in self.layout.missing}
        strange = texts[~texts.str.lower().isin(none)]
        if len(strange):
            decimal = "," if self.layout.decimal == "." else "."
            hint = f"; is decimal = {decimal!r}?" if _has_decimal(strange.iloc[0], decimal) else ""
            raise ParameterError(
                f"column {name!r} holds other things than numbers: {short_repr(strange.iloc[0])} "
                f"in {texts.index.name} {strange.index[0]}{hint}"
            )


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


def read_table(path: Path, layout: TrackLayout) -> Table:
    """Return the rows of a text or Parquet file; those of a text are numbered by their line."""
    pandas = require("pandas", "plot")
    check_ending(path)
    try:
        if not _is_text(path):
            return plain_table(_read_parquet(pandas, path), layout)
        separator = layout.separator or _usual_separator(path)
        return _read_text(pandas, _text_of(path), layout, separator)
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"it cannot be read as a table: {error}") from error


def _is_text(path: Path) -> bool:
    return ending(path) not in _PARQUET


def _usual_separator(path: Path) -> str:
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
    if not _is_text(path):
        return {}
    lines = _text_of(path).splitlines()[:100] or [""]
    mark = _separator_of(lines)
    rows = [line.split(None if mark == " " else mark) for line in lines]
    widths = [*map(len, rows)]
    # The header is the first line with as many cells as the next ones, or the first of its levels.
    in_levels = (line for line in range(4) if _levels(rows[line : line + 10])[0])
    skip = next(in_levels, widths.index(max(widths)))
    form: dict[str, Any] = {"skip": skip} if skip else {}
    if mark != _usual_separator(path):
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


def _read_text(pandas: ModuleType, text: str, layout: TrackLayout, separator: str) -> Table:
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
    is_id = [bool(layout.id) and _key(name) == _key(layout.id) for name in names]
    table: pd.DataFrame = pandas.read_csv(
        io.StringIO(text),
        sep=r"\s+" if separator == " " else separator,
        decimal=layout.decimal,
        skiprows=first - 1,
        header=None,
        names=range(len(names)),
        index_col=False,
        dtype=dict.fromkeys(np.flatnonzero(is_id), str),
        keep_default_na=False,
        na_values=[""],
        skipinitialspace=True,
        skip_blank_lines=False,
        low_memory=False,
    )
    lines = pandas.RangeIndex(first, first + len(table), name="line")
    table = table.set_axis(names, axis=1).set_axis(lines).dropna(how="all")
    if layout.header:
        return Table(table, layout)
    # Some programs write units, or longer names, into the lines under the header.
    under = [line for line, row in table.head(4).iterrows() if not any(map(is_value, row))]
    return Table(table.drop(index=under), layout)


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


def plain_table(table: "pd.DataFrame", layout: TrackLayout) -> Table:
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
    return Table(table.reset_index(drop=True).rename_axis(index="row"), layout)


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
