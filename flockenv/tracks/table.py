"""Tables of tracks: files as they were exported, columns by their names, cells as numbers."""

import codecs
import csv
import io
import itertools
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv._io.plain_file import is_special
from flockenv.errors import ParameterError, shown
from flockenv.tracks.layout import TrackLayout

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

SUFFIXES = (".csv", ".parquet", ".pq")
"""Endings of files that `read_tracks` takes."""

_NONE = {"", "nan", "na", "n/a", "#n/a", "<na>", "none", "null", "-", "--", "-nan"}
"""What stands for no number, in small letters."""


def read_table(path: Path, layout: TrackLayout) -> "pd.DataFrame":
    """Return the rows of a CSV or Parquet file; a ParameterError names one that is none.

    Rows of a CSV file are numbered by their line.
    """
    pandas = require("pandas", "plot")
    if path.suffix.lower() not in SUFFIXES:
        raise ParameterError(f"{path}: it ends in none of {', '.join(SUFFIXES)}")
    try:
        if is_special(path):
            raise ParameterError("a device, a pipe or a socket")
        if path.suffix.lower() in (".parquet", ".pq"):
            table: pd.DataFrame = pandas.read_parquet(path)
            return plain_table(table)
        return _read_csv(pandas, text_of(path), layout)
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"{path} cannot be read as a table: {error}") from error


def text_of(path: Path) -> str:
    """Return a file as text: UTF-8 or UTF-16 by its mark, and what Windows wrote otherwise."""
    data = path.read_bytes()
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        text = data.decode("utf-16")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("cp1252", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def cells_of(text: str, layout: TrackLayout, count: int) -> list[list[str]]:
    """Return the cells of the first lines after those that are skipped."""
    lines = itertools.islice(io.StringIO(text), layout.skip, layout.skip + count)
    if layout.separator == " ":
        return [line.split() for line in lines]
    rows = csv.reader(lines, delimiter=layout.separator, skipinitialspace=True)
    return [[cell.strip() for cell in row] for row in rows]


def _read_csv(pandas: Any, text: str, layout: TrackLayout) -> "pd.DataFrame":
    rows = cells_of(text, layout, 8)
    names, height = _header(rows)
    extra = [place for place, row in enumerate(rows[height:]) if any(row[len(names) :])]
    if extra:
        line = layout.skip + height + extra[0] + 1
        raise ParameterError(
            f"the header names {len(names)} columns, and line {line} holds "
            f"{len(rows[height + extra[0]])} values: every column needs a name{_other_mark(names)}"
        )
    width = max(map(len, rows))
    names += [f"unnamed {place}" for place in range(len(names), width)]
    texts = {name for name in names if layout.id and _key(name) == _key(layout.id)}
    none = [*_NONE, *(word.upper() for word in _NONE), "NaN", "None", *layout.missing]
    unique = [
        f"{name} {place}" if name in names[:place] else name for place, name in enumerate(names)
    ]
    table: pd.DataFrame = pandas.read_csv(
        io.StringIO(text),
        sep=r"\s+" if layout.separator == " " else layout.separator,
        decimal=layout.decimal,
        skiprows=layout.skip + height,
        header=None,
        names=unique,
        index_col=False,
        dtype=dict.fromkeys(texts, str),
        keep_default_na=False,
        na_values={name: none for name in unique if name not in texts},
        skipinitialspace=True,
        skip_blank_lines=False,
        low_memory=False,
    )
    table.attrs["twice"] = {name for name in names if names.count(name) > 1}
    table.index = pandas.RangeIndex(layout.skip + height + 1, layout.skip + height + 1 + len(table))
    table.index.name = "line"
    blank = (table.isna() | (table == "")).all(axis=1)
    # Some write units, or longer names, into the lines under the header.
    under = [number for number, row in table.head(4).iterrows() if not any(map(_is_value, row))]
    return table[~blank & ~table.index.isin(under)]


def _header(rows: list[list[str]]) -> tuple[list[str], int]:
    """Return the names of columns, and how many lines they take: DeepLabCut's take some."""
    if not rows or not any(rows[0]):
        raise ParameterError("there is no header in its first line")
    first = [row[0].lower() if row else "" for row in rows[:4]]
    if first[0] != "scorer" or "coords" not in first:
        # Separators at the ends of lines name nothing.
        names = [name or f"unnamed {place}" for place, name in enumerate(rows[0])]
        return names, 1
    height = first.index("coords") + 1
    return ["frame", *map(_joined, list(zip(*rows[1:height], strict=True))[1:])], height


def _joined(levels: Any) -> str:
    """Return the name of a column that DeepLabCut names in levels: individual, body part, coord."""
    *individual, part, coord = map(str, levels)
    return f"{'.'.join([*individual, part])}_{coord}"


def _is_value(cell: Any) -> bool:
    return bool(re.match(r"[-+.]?\d", str(cell)))


def plain_table(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return a table whose columns have one name each, those of the index among them."""
    if not hasattr(table, "columns") or not hasattr(table, "index"):
        raise TypeError(f"tracks must be a file or a DataFrame of pandas, not {shown(table)}")
    columns: Any = table.columns
    index: Any = table.index
    if columns.nlevels > 1 and "coords" in columns.names:
        kept = columns.droplevel("scorer") if "scorer" in columns.names else columns
        table = table.set_axis([_joined(each) for each in kept], axis=1)
        index = index.rename(index.name or "frame")
    elif columns.nlevels > 1:
        raise ParameterError(
            f"the columns have {columns.nlevels} levels, such as {columns[0]!r}: give each column "
            "one name"
        )
    for level, name in enumerate(index.names):
        if name is None or name == "line":
            continue
        values = index.get_level_values(level)
        if name in table and not np.array_equal(values, table[name].to_numpy()):
            raise ParameterError(
                f"the index and a column are both called {name!r}, and differ: rename one"
            )
        table = table if name in table else table.assign(**{str(name): values})
    names = list(table.columns)
    table = table.reset_index(drop=True).rename_axis(index="row")
    table.attrs["twice"] = {name for name in names if names.count(name) > 1}
    return table


def _key(name: object) -> str:
    return str(name).strip().lstrip("#%").strip().casefold()


def column(table: "pd.DataFrame", name: str) -> "pd.Series[Any]":
    """Return the column of a name, or of one that differs in case or blanks only."""
    there: list[Any] = list(table)
    found = [each for each in there if each == name]
    found = found or [each for each in there if _key(each) == _key(name)]
    if len(set(found)) == 1 and found[0] not in table.attrs.get("twice", ()):
        series: pd.Series[Any] = table[found[0]]
        return series
    if found:
        raise ParameterError(f"there are several columns {name!r}: give each its own name")
    names = [*map(str, there)]
    raise ParameterError(
        f"column {name!r} is missing; there are {', '.join(names)}{_other_mark(names)}"
    )


def _other_mark(names: list[str]) -> str:
    """Return what separates names that were read as one."""
    if names[0][:1] in ("#", "%", "/") and len(names) == 1:
        return ": `skip` leaves out lines before the header, such as remarks"
    marks = [mark for mark in (";", "\t", "|", " ", ",") if len(names) == 1 and mark in names[0]]
    return f": the header looks like one with separator = {marks[0]!r}" if marks else ""


def numbers(table: "pd.DataFrame", name: str, layout: TrackLayout) -> Floats:
    """Return a column as numbers, NaN where none stands; infinite ones are none."""
    pandas, found = require("pandas", "plot"), column(table, name)
    types = pandas.api.types
    if types.is_bool_dtype(found) or types.is_complex_dtype(found):
        raise ParameterError(f"column {name!r} holds other things than numbers")
    if not types.is_numeric_dtype(found):
        found = _parsed(pandas, found, name, layout)
    values = found.to_numpy(dtype=np.float64, na_value=np.nan).copy()
    none = pandas.to_numeric(list(layout.missing), errors="coerce")
    values[np.isinf(values) | np.isin(values, none)] = np.nan
    return values


def _parsed(pandas: Any, found: Any, name: str, layout: TrackLayout) -> Any:
    texts = found.astype(object).where(found.notna(), "").astype(str).str.strip()
    none = texts.str.lower().isin(_NONE | {each.strip().lower() for each in layout.missing})
    plain = texts.str.replace(layout.decimal, ".").mask(none)
    values = pandas.to_numeric(plain, errors="coerce")
    strange = values.isna() & ~none
    if strange.any():
        line = strange.idxmax()
        value = texts[line] if texts.index.is_unique else texts[strange].iloc[0]
        decimal = "," if layout.decimal == "." else "."
        is_other = re.fullmatch(rf"[-+]?\d+{re.escape(decimal)}\d+", value)
        hint = f"; is decimal = {decimal!r}?" if is_other else ""
        raise ParameterError(
            f"column {name!r} holds other things than numbers: {shown(value)} in "
            f"{found.index.name} {line}{hint}"
        )
    return values
