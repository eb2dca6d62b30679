"""Tables of tracks: files as they were exported, columns by their names, cells as numbers."""

import codecs
import csv
import gzip
import io
import os
import re
from collections.abc import Iterable
from pathlib import Path
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


def check_ending(path: Path) -> None:
    """Refuse a missing file, and a file with another ending."""
    if not path.exists():
        raise ParameterError(f"{path} cannot be read: No such file or directory")
    if not path.name.lower().endswith(SUFFIXES):
        raise ParameterError(
            f"{path} is not a table of tracks: its name ends in none of {', '.join(SUFFIXES)} "
            "(recordings end in .npz)"
        )


def read_table(path: Path, layout: TrackLayout) -> "pd.DataFrame":
    """Return the rows of a text or Parquet file; the index of a text's rows is their line."""
    pandas = require("pandas", "plot")
    try:
        data = _content(path)
        if not _is_parquet(path):
            return _read_text(_decoded(data), layout, layout.separator or _usual_separator(path))
        metadata = require("pyarrow.parquet", "plot").ParquetFile(io.BytesIO(data)).metadata
        cells = metadata.num_rows * metadata.num_columns
        if 8 * cells > most_content(len(data)):
            raise ParameterError(f"it holds {cells} cells, too many for its {len(data)} bytes")
        return plain_table(pandas.read_parquet(io.BytesIO(data)))
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"it cannot be read as a table: {error}") from error


def _is_parquet(path: Path) -> bool:
    return path.name.lower().endswith(_PARQUET)


def _usual_separator(path: Path) -> str:
    """Return the separator that follows from a text file's ending."""
    return "\t" if path.name.lower().endswith((".tsv", ".tsv.gz")) else ","


def _content(path: Path) -> bytes:
    """Return the decompressed bytes of a file; refuse more than its size makes plausible."""
    with open_plain(path) as file:
        most = most_content(os.fstat(file.fileno()).st_size)
        stream = gzip.GzipFile(fileobj=file) if path.suffix.lower() == ".gz" else file
        data: bytes = stream.read(most + 1)
    if len(data) > most:
        raise ParameterError(f"it holds more than the {most} bytes that are accepted")
    return data


def _decoded(data: bytes) -> str:
    """Return bytes as text: UTF-16 if they start with its mark, else UTF-8, else Windows-1252."""
    is_utf16 = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = data.decode("utf-16" if is_utf16 else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def spelling_of(path: Path) -> dict[str, Any]:
    """Return those of separator, decimal and skip in which a text file differs from the default."""
    if _is_parquet(path):
        return {}
    lines = _decoded(_content(path)).splitlines()[:100] or [""]
    separator = _separator_of(lines)
    rows = [line.split(None if separator == " " else separator) for line in lines]
    widths = [*map(len, rows)]
    # A multi-line header has its first line among the first four. Any other header is one line,
    # the first one with the most cells.
    headers = [_header(rows[line : line + 10]) for line in range(min(4, len(rows)))]
    multi_line = [line for line, (_, height) in enumerate(headers) if height > 1]
    skip = multi_line[0] if multi_line else widths.index(max(widths))
    form: dict[str, Any] = {"skip": skip} if skip else {}
    if separator != _usual_separator(path):
        form["separator"] = separator
    if separator != "," and any(
        _has_decimal(cell.strip(), ",") for row in rows[1:] for cell in row
    ):
        form["decimal"] = ","
    return form


def _separator_of(lines: list[str]) -> str:
    """Return the separator that occurs most often in one line."""
    counts = {mark: max(line.count(mark) for line in lines) for mark in ";\t|,"}
    if max(counts.values()) < 2:  # Blanks are tried last, since names may hold them, too.
        counts[" "] = max(len(line.split()) - 1 for line in lines)
    return max(counts, key=lambda mark: counts[mark])


def _read_text(text: str, layout: TrackLayout, separator: str) -> "pd.DataFrame":
    """Return the rows of a text, without empty ones and without units under the header."""
    pandas = require("pandas", "plot")
    names, first_line = _names_in(text, layout, separator)
    # Numbers that are names of boats stay texts: 007 is not 7.
    id_key = _key(layout.id or "")
    table: pd.DataFrame = pandas.read_csv(
        io.StringIO(text),
        sep=r"\s+" if separator == " " else separator,
        decimal=layout.decimal,
        skiprows=first_line - 1,
        header=None,
        names=range(len(names)),
        index_col=False,
        dtype={index: str for index, name in enumerate(names) if _key(name) == id_key},
        low_memory=False,
        keep_default_na=False,
        na_values=[""],
        skipinitialspace=True,
        skip_blank_lines=False,
    )
    lines = pandas.RangeIndex(first_line, first_line + len(table), name="line")
    table = table.set_axis(names, axis=1).set_axis(lines).dropna(how="all")
    # Some programs write units, or longer names, into the lines under the header.
    head = table.head(0 if layout.header else 4)
    return table.drop(index=[line for line, row in head.iterrows() if not any(map(is_value, row))])


def _names_in(text: str, layout: TrackLayout, separator: str) -> tuple[list[str], int]:
    """Return a name for each column of a text, and the number of the first line of values."""
    lines = text.split("\n", layout.skip + 10)[layout.skip : layout.skip + 10] or [""]
    cells = csv.reader(lines, delimiter=separator, skipinitialspace=True)
    rows = [line.split() for line in lines] if separator == " " else [*cells]
    rows = [[cell.strip() for cell in row] for row in rows]
    if not layout.header and not any(rows[0]):
        raise ParameterError("there is no header in its first line")
    names, height = ([*layout.header], 0) if layout.header else _header(rows)
    first_line = layout.skip + height + 1
    for line, row in enumerate(rows[height:], first_line):
        if any(row[len(names) :]):
            raise ParameterError(
                f"the header names {len(names)} columns, and line {line} holds {len(row)} values: "
                f"every column needs a name{_header_hint(names)}"
            )
    unnamed = range(len(names), max(map(len, rows)))
    return names + [f"unnamed {index}" for index in unnamed], first_line


def _header(rows: list[list[str]]) -> tuple[list[str], int]:
    """Return the names of columns, and the number of lines in the header.

    The first one or two columns hold times. In a multi-line header they say what each line names.
    """
    starts = [next(filter(None, row[:2]), "").lower() for row in rows]
    n_time_columns = 1 if any(rows[0][:1]) else 2
    for levels in (program.levels for program in FORMATS if program.levels):
        if starts[0] == levels[0] and levels[-1] in starts:
            last = starts.index(levels[-1])
            level_rows = [rows[line] for line in range(1, last + 1) if starts[line] in levels]
            columns = zip(*(row[n_time_columns:] for row in level_rows), strict=False)
            return ["frame", *rows[last][1:n_time_columns], *map(_joined, columns)], last + 1
    # A separator at the end of the line leaves an empty name.
    return [name or f"unnamed {index}" for index, name in enumerate(rows[0])], 1


def _joined(levels: Iterable[object]) -> str:
    """Return "individual.part_coord" for a column's names, one per level of its header."""
    *individual, part, coord = map(str, levels)
    return f"{'.'.join([*individual, part])}_{coord}"


def is_value(cell: object) -> bool:
    """Return whether a cell begins like a number: with a digit after any signs and points."""
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
    if columns.nlevels > 1:
        if "coords" not in columns.names:
            raise ParameterError(
                f"the columns have {columns.nlevels} levels, such as {columns[0]!r}: give each "
                "column one name"
            )
        named = columns.droplevel("scorer") if "scorer" in columns.names else columns
        table = table.set_axis([_joined(levels) for levels in named], axis=1)
        index = index.rename(index.name or "frame")
    for level, name in enumerate(index.names):
        values = index.get_level_values(level)
        if name in table and not np.array_equal(values, table[name].to_numpy()):
            raise ParameterError(
                f"the index and a column are both called {name!r}, and differ: rename one"
            )
        table = table if name is None else table.assign(**{str(name): values})
    return table.reset_index(drop=True).rename_axis(index="row")


def long_table(
    rows: "pd.DataFrame", layout: TrackLayout
) -> "tuple[pd.DataFrame, pd.Series[str] | None]":
    """Return the columns that a layout names, and the names of boats.

    Times are as in the table, all other columns are numbers. A column whose name holds {id} stands
    for the columns of all boats, one after the other. A row without a boat has the name None. If no
    row has a name, all rows belong to one boat, and None is returned in place of the names.
    """
    pandas, indices, boats = require("pandas", "plot"), indices_of(rows), boats_of(rows, layout)

    def column_of(name: str) -> "pd.Series[Any]":
        indices_of_boats = [index_of(name.replace("{id}", boat), rows, indices) for boat in boats]
        column: pd.Series[Any] = pandas.concat([rows.iloc[:, index] for index in indices_of_boats])
        return column.rename(name)

    ids = column_of(layout.id) if layout.id and not layout.is_wide else None
    columns = {name: numbers(column_of(name), layout) for name in sum(layout.columns.values(), ())}
    times = column_of(layout.frame)
    table: pd.DataFrame = pandas.DataFrame({layout.frame: times, **columns}, times.index)
    if ids is None and not layout.is_wide:
        return table, None
    names = _texts(pandas.Series(np.repeat(boats, len(rows)), times.index) if ids is None else ids)
    if names.str.lower().isin(NO_NUMBER).all():
        return table, None
    names = names.str.replace(r"^(-?\d+)\.0+$", r"\1", regex=True)
    nobody = {name.strip().casefold() for name in layout.unassigned} | {""}
    return table, names.mask(names.str.casefold().isin(nobody), None)


def _texts(column: "pd.Series[Any]") -> "pd.Series[str]":
    """Return the cells of a column as texts without blanks around them, "" for missing cells."""
    return column.astype(object).where(column.notna(), "").astype(str).str.strip()


def boats_of(rows: "pd.DataFrame", layout: TrackLayout) -> list[str]:
    """Return the boats' names, which columns have in place of {id}; ["0"] without {id}."""
    if not layout.is_wide:
        return ["0"]
    names, indices = [*map(str, rows)], indices_of(rows)
    fields = sum(layout.columns.values(), ())
    pattern = re.compile(re.escape(_bare(fields[0])).replace(r"\{id\}", "(.+)"), re.IGNORECASE)
    boats = [match[1] for name in names if (match := pattern.fullmatch(_bare(name)))]
    boats = [
        boat
        for boat in boats
        if all(_key(field.replace("{id}", boat)) in indices for field in fields)
    ]
    if not boats:
        patterns = " and ".join(map(repr, fields))
        raise ParameterError(f"no columns look like {patterns}; there are {listed(names)}")
    return boats


def indices_of(rows: "pd.DataFrame") -> dict[str, list[int]]:
    """Return the indices of columns by the key of their names."""
    indices = dict[str, list[int]]()
    for index, name in enumerate(rows):
        indices.setdefault(_key(name), []).append(index)
    return indices


def index_of(name: str, rows: "pd.DataFrame", indices: dict[str, list[int]]) -> int:
    """Return the index of a column, whose name may differ in case or blanks."""
    similar = indices.get(_key(name), [])
    matches = [index for index in similar if rows.columns[index] == name] or similar
    if len(matches) > 1:
        raise ParameterError(f"there are several columns {name!r}: give each its own name")
    if not matches:
        names = [*map(str, rows)]
        hint = f"there are {listed(names)}{_header_hint(names)}"
        raise ParameterError(f"column {name!r} is missing; {hint}")
    return matches[0]


def _bare(name: object) -> str:
    """Return a column's name without comment marks or blanks around it."""
    return str(name).strip().lstrip("#%").strip()


def _key(name: object) -> str:
    """Return a column's name, bare and in lower case."""
    return _bare(name).casefold()


def listed(names: list[str]) -> str:
    """Return names separated by commas, the first 40 and the number of further names."""
    more = f" and {len(names) - 40} more" if len(names) > 40 else ""
    return f"{', '.join(names[:40])}{more}"


def _header_hint(names: list[str]) -> str:
    """Return a hint if a header was read as one name, or if it consists of numbers."""
    if sum(map(is_value, names)) > len(names) / 2:
        return ": `header` names the columns of a file whose first line does not"
    if len(names) == 1 and names[0][:1] in ("#", "%", "/"):
        return ": `skip` leaves out lines before the header, such as remarks"
    separator = _separator_of(names)
    if len(names) > 1 or separator not in names[0]:
        return ""
    return f": the header looks like one with separator = {separator!r}"


def numbers(column: "pd.Series[Any]", layout: TrackLayout) -> Floats:
    """Return a column as numbers, NaN for missing and infinite ones; refuse other texts."""
    to_numeric, parsed = require("pandas", "plot").to_numeric, column
    if column.dtype.kind not in "iuf":
        texts = _texts(column)
        parsed = to_numeric(texts.str.replace(layout.decimal, "."), errors="coerce")
        missing_texts = NO_NUMBER | {word.strip().lower() for word in layout.missing}
        other_texts = texts[parsed.isna() & ~texts.str.lower().isin(missing_texts)]
        if len(other_texts):
            line, text = other_texts.index[0], other_texts.iloc[0]
            decimal = "," if layout.decimal == "." else "."
            hint = f"; is decimal = {decimal!r}?" if _has_decimal(text, decimal) else ""
            raise ParameterError(
                f"column {column.name!r} holds other things than numbers: {short_repr(text)} "
                f"in {column.index.name} {line}{hint}"
            )
    values: Floats = parsed.to_numpy(dtype=np.float64, na_value=np.nan).copy()
    missing_numbers = to_numeric(list(layout.missing), errors="coerce")
    values[np.isinf(values) | np.isin(values, missing_numbers)] = np.nan
    return values


def _has_decimal(cell: str, mark: str) -> bool:
    """Return whether a cell consists of digits, the decimal mark and more digits."""
    whole, _, fraction = cell.lstrip("+-").partition(mark)
    return whole.isdigit() and fraction.isdigit()
