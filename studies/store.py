"""Results on disk: stores of runs that resume, and tables that name the version of their runs.

`flockenv.runs.store.RunStore` keeps whole recordings, which for these studies would be gigabytes.
"""

import csv
import gzip
import io
import os
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import pandas as pd
from rich.progress import track

import flockenv
from flockenv.runs.store import RESULTS_VERSION

VERSION = "results_version"
"""The last column of every file of results: `RESULTS_VERSION` of the code that made a run."""
MADE = "made.toml"
"""Names, in a folder of results, the version of tables without that column."""
MOST_PLAIN = 1000
"""Rows from which on a table is compressed."""

Row = dict[str, Any]


class StudyError(Exception):
    """A result that cannot be used or written, or a run that cannot be made."""


class Store:
    """A file of results, by the text of the rows."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self.path, self.columns = path, list(columns)
        self.lines: dict[tuple[str, ...], dict[str, str]] = {}
        self.measured: list[str] = []
        self.version = str(RESULTS_VERSION)
        if not path.exists():
            return
        try:
            with _opened(path) as file:
                reader = csv.DictReader(file, strict=True)
                names = list(reader.fieldnames or [])
                lines = list(reader)
        except (OSError, EOFError, UnicodeDecodeError, csv.Error) as error:
            raise StudyError(f"{path} cannot be read: {error}") from error
        if names[: len(columns)] != self.columns or any(None in line.values() for line in lines):
            raise StudyError(
                f"{path} is a store of another design: its columns begin with "
                f"{', '.join(names[: len(columns)])}, this design's are {', '.join(columns)}; "
                "move it away to make its runs again"
            )
        if names[-1] != VERSION or len(versions := {line[VERSION] for line in lines}) > 1:
            raise StudyError(f"{path} does not say which results version made its runs")
        self.version = versions.pop() if versions else self.version
        self.measured = names[len(columns) : -1]
        self.lines = {tuple(line[name] for name in self.columns): line for line in lines}

    def key(self, row: Row) -> tuple[str, ...]:
        return tuple(str(row[name]) for name in self.columns)

    def fill(
        self, missing: Mapping[tuple[str, ...], Row], measure: Callable[[Row], Row], workers: int
    ) -> None:
        """Make runs, writing the file every half minute and at the end, however it comes."""
        if missing and self.version != str(RESULTS_VERSION):
            raise StudyError(
                f"{self.path} holds runs of results version {self.version}, and {len(missing)} "
                f"are missing that this code would make as version {RESULTS_VERSION}; --no-runs "
                "judges those that are there, and without the file all are made again"
            )
        order = [*self.lines, *missing]
        pool = ThreadPoolExecutor(workers)
        name = self.path.name.partition(".")[0]
        futures = {pool.submit(measure, row): key for key, row in missing.items()}
        written = time.monotonic()
        try:
            for future in track(as_completed(futures), name, len(futures), disable=not futures):
                if isinstance(error := future.exception(), flockenv.FlockError):
                    row = missing[futures[future]]
                    raise StudyError(f"the run {row} cannot be made: {error}") from error
                self._keep(futures[future], future.result())
                if time.monotonic() - written > 30.0:
                    self._write()
                    written = time.monotonic()
        finally:
            pool.shutdown(cancel_futures=True)
            for future, key in futures.items():
                if not future.cancelled() and future.exception() is None:
                    self._keep(key, future.result())
            if missing:
                self.lines = {key: self.lines[key] for key in order if key in self.lines}
                self._write()

    def _keep(self, key: tuple[str, ...], measured: Row) -> None:
        self.measured = self.measured or list(measured)
        line = dict(zip(self.columns, key, strict=True)) | {VERSION: self.version}
        self.lines[key] = line | {name: _text(value) for name, value in measured.items()}

    def _write(self) -> None:
        file = io.StringIO()
        names = [*self.columns, *self.measured, VERSION]
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(self.lines.values())
        self.path = write_rows(self.path, file.getvalue(), len(self.lines))

    def table(self, keys: Iterable[tuple[str, ...]]) -> pd.DataFrame:
        found = [self.lines[key] for key in keys if key in self.lines]
        table = pd.DataFrame(found, columns=[*self.columns, *self.measured, VERSION], dtype=object)
        for name in table:
            with suppress(ValueError):
                table[name] = [float(text) for text in table[name]]
        return table


def existing(path: Path) -> Path:
    """Return the file of a table: the plain or the compressed one, whichever there is."""
    packed = path.with_name(f"{path.name.removesuffix('.gz')}.gz")
    return packed if packed.exists() else path


def _opened(path: Path) -> TextIO:
    if path.suffix == ".gz":
        return gzip.open(path, "rt", newline="", encoding="utf-8")
    return path.open(newline="", encoding="utf-8")


def write_rows(path: Path, text: str, rows: int) -> Path:
    """Write a table whole or not at all, compressed if it is long, and return its file."""
    plain = path.with_name(path.name.removesuffix(".gz"))
    packed = plain.with_name(f"{plain.name}.gz")
    if rows > MOST_PLAIN:
        # Without the time, so that the same rows are the same bytes.
        write(packed, gzip.compress(text.encode(), mtime=0))
        plain.unlink(missing_ok=True)
        return packed
    write(plain, text.encode())
    packed.unlink(missing_ok=True)
    return plain


def write_table(
    path: Path, table: pd.DataFrame, form: str = "%.5g", version: int = RESULTS_VERSION
) -> None:
    """Write a table of results, with the results version of its runs as its last column.

    Raises
    ------
    StudyError
        If a table of another version is there.
    """
    check_version(path, version)
    versioned = table.assign(**{VERSION: version})
    text = versioned.to_csv(index=False, float_format=form, lineterminator="\n")
    write_rows(path, text, len(table))


def resumed(path: Path, **how: Any) -> pd.DataFrame:
    """Return the rows that an interrupted command wrote, without their version; none at first.

    Raises
    ------
    StudyError
        For a file that cannot be read, and for rows of another results version than this code's.
    """
    check_version(path)
    path = existing(path)
    table = _read(path, **how) if path.exists() else pd.DataFrame()
    return table.drop(columns=VERSION, errors="ignore")


def check_version(path: Path, version: int = RESULTS_VERSION) -> None:
    """Refuse to replace a table of another results version; scripts ask before they run.

    Raises
    ------
    StudyError
        If the table that is there cannot be read, or names another version, or none.
    """
    path = existing(path)
    if path.exists() and len(_read(path)) and (found := version_of(path)) != version:
        raise StudyError(
            f"{path} has rows of results version {found}, and this command makes rows of version "
            f"{version}; move it away, or write elsewhere"
        )


def _read(path: Path, **how: Any) -> pd.DataFrame:
    try:
        return pd.read_csv(path, **how)
    except (OSError, EOFError, ValueError) as error:
        raise StudyError(f"{path} cannot be read: {error}") from error


def version_of(path: Path) -> int:
    """Return the results version that made a table, by its column or by `MADE` beside it.

    Raises
    ------
    StudyError
        If neither names one version.
    """
    names = pd.read_csv(path, nrows=0).columns
    if VERSION in names:
        found = set(pd.read_csv(path, usecols=[VERSION])[VERSION])
    else:
        made = path.with_name(MADE)
        versions = tomllib.loads(made.read_text("utf-8"))[VERSION] if made.exists() else {}
        found = {versions[path.name]} if path.name in versions else set()
    if len(found) != 1:
        raise StudyError(f"{path} does not say which results version made it")
    return int(found.pop())


def _text(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float | np.floating) else str(value)


def write(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    Raises
    ------
    StudyError
        If it cannot be written, for example to a full disk; the file is then as it was.
    """
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            temporary = Path(file.name)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        raise StudyError(
            f"{path} cannot be written: {error.strerror or error}; it is as it was before"
        ) from error
