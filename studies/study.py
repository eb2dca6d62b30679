"""Studies: designs as tables of runs, results that resume, pictures, scripts.

A design is a list of rows; a row says all that a run depends on, its seed included. The result is
``results/<name>.csv`` in the study's folder, compressed if it is long, with one line per run: the
row, what was measured, and the results version of the code that made it. A run that has a line is
not made again, so that work resumes where it ended; a file never holds runs of two versions.
`flockenv.runs.store.RunStore` keeps whole recordings, which for these studies would be gigabytes.
Every claim of the paper that a study judges is a line of its ``claims.csv``, with the number of its
runs.
"""

import argparse
import csv
import gzip
import io
import math
import os
import signal
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from rich.progress import track

import flockenv
from docs.scripts.plots import page_style, write_png
from flockenv.rendering.palette import OKABE_ITO
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.runs.store import RESULTS_VERSION

HERE = Path(__file__).parent
MOSTLY = 0.7
"""Share of a run's frames from which on it counts as mostly jammed or mostly rotating."""
FIRST_SEED = POLICY_SEEDS["paper"].first
"""Seeds of these studies are from here on; nothing else uses them."""
SEEDS = 24  # Runs at each point of a design, unless it says otherwise.

VERSION = "results_version"
"""The last column of every file of results: `RESULTS_VERSION` of the code that made a run."""
MADE = "made.toml"
"""Names, in a folder of results, the version of tables without that column."""
MOST_PLAIN = 1000
"""Rows from which on a table is compressed."""

Row = dict[str, Any]


class StudyError(Exception):
    """A result that cannot be used or written, or a run that cannot be made."""


@dataclass(frozen=True)
class Options:
    """How a script was called.

    Attributes
    ----------
    trial
        Two seeds and half a minute per run: everything runs, nothing means anything.
    workers
        How many runs at a time.
    out
        Folder with a folder of each study.
    runs
        Whether missing runs are made; otherwise those that are there are judged and drawn.
    study
        Name of the study's own folder.
    """

    trial: bool = False
    workers: int = 1
    out: Path = HERE
    runs: bool = True
    study: str = ""

    @property
    def folder(self) -> Path:
        """Where the results, claims and pictures of the study are."""
        return self.out / self.study


# --- runs ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Study:
    """Runs that belong together.

    Attributes
    ----------
    name
        Folder and file of its results, such as ``section4/states``.
    design
        The rows, the most decisive first, all with the same columns. ``seed`` counts from 0, and
        ``minutes`` is the length of a run.
    measure
        What is measured of the run of a row: a function of the row alone.
    in_trial
        Which rows a trial has, of those with two seeds.
    adaptive
        Whether rows follow from earlier results, so that the file may hold runs of other rows.
    numbered
        A column that numbers such rows: the file may hold other numbers, but not other rows of
        these.
    """

    name: str
    design: Callable[[], Sequence[Row]]
    measure: Callable[[Row], Row]
    in_trial: Callable[[Row], bool] = lambda row: True
    adaptive: bool = False
    numbered: str = ""

    def results(self, options: Options, optional: bool = False) -> pd.DataFrame:
        """Return one line per run of the design that has been made, in the design's order.

        None may have been made if `optional`.

        Raises
        ------
        StudyError
            For a file of another design, or of another results version with runs missing, for one
            without any run that is not to be made, for a run that cannot be made and a file that
            cannot be written. What was finished before is in
            the file.
        """
        rows = list(self.design())
        if options.trial:
            most = min(row["seed"] for row in rows) + 1
            rows = [
                row | {"minutes": 0.5} for row in rows if row["seed"] <= most and self.in_trial(row)
            ]
        columns = list(rows[0])
        folder, _, name = self.name.partition("/")
        store = Store(existing(options.out / folder / "results" / f"{name}.csv"), columns)
        keys = {store.key(row): row for row in rows}
        others = store.lines.keys() - keys.keys()
        if self.numbered:
            place = columns.index(self.numbered)
            numbers = {key[place] for key in keys}
            others = {each for each in others if each[place] in numbers}
        if others and (self.numbered or not self.adaptive):
            raise StudyError(
                f"{store.path} is a store of another design: {len(others)} of its runs are not in "
                f"this one, such as {', '.join(min(others))}; was it changed after its runs?"
            )
        if options.runs:
            missing = {key: row for key, row in keys.items() if key not in store.lines}
            store.fill(missing, self.measure, options.workers)
        elif not store.lines and not optional:
            raise StudyError(f"{store.path} is missing or empty; without --no-runs it is made")
        return store.table(keys)


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


def flock(row: Mapping[str, Any], **changes: Any) -> flockenv.FlockParameters:
    """Return the parameters that a row names: its preset, and every column that is a field."""
    fields = set(flockenv.FlockParameters.preset("simulation").to_dict())
    named = {name: value for name, value in row.items() if name in fields}
    preset = row.get("preset", "simulation")
    return flockenv.FlockParameters.preset(preset).replace(**named | changes)


def simulated(row: Mapping[str, Any], **options: Any) -> flockenv.Recording:
    """Return the run of a row."""
    return flockenv.simulate(
        flock(row), seed_of(row), 60.0 * row["minutes"], dtype=np.float32, **options
    )


def seed_of(row: Mapping[str, Any]) -> int:
    """Return the simulator's seed of a row, counted from its ``first_seed`` if it has one."""
    return int(row.get("first_seed", FIRST_SEED)) + int(row["seed"])


# --- what is measured of a run --------------------------------------------------------------------

PHI_EDGES = np.linspace(-math.pi, math.pi, 37)
PSI_EDGES = np.linspace(0.0, 1.0, 26)


def order_row(run: flockenv.Recording, after: float = 0.1) -> Row:
    """Return means over the analysis window after the first tenth of a run.

    A frame has a direction where Ψ_o ≥ 0.5: it is jammed where φ_o is within π/4 of the outward
    radial, and rotates where it is within π/4 of a tangent. Histograms of φ_o and Ψ_o are in
    thousandths of the frames.
    """
    order = run.analyzed(after).order
    m, outward, psi_o, phi_o = order.rotation(), order.outward(), order.psi_o, order.phi_o
    directed = psi_o >= 0.5
    off = abs(phi_o)
    rotates = directed & (abs(off - math.pi / 2) < math.pi / 4)
    return {
        "frames": len(psi_o),
        "psi_o": psi_o.mean(),
        "psi_o_sd": psi_o.std(),
        "m": m.mean(),
        "abs_m": abs(m).mean(),
        "outward": outward.mean(),
        "psi_v": order.psi_v.mean(),
        "c_v": order.c_v.mean(),
        "c_v_sd": order.c_v.std(),
        "jammed": (directed & (off <= math.pi / 4)).mean(),
        "cw": (rotates & (phi_o > 0)).mean(),
        "ccw": (rotates & (phi_o < 0)).mean(),
        "near_zero": (off < math.pi / 12).mean(),
        "phi_histogram": _histogram(phi_o, PHI_EDGES),
        "psi_histogram": _histogram(psi_o, PSI_EDGES),
    }


def _histogram(values: NDArray[np.float64], edges: NDArray[np.float64]) -> str:
    counts = np.histogram(values, edges)[0]
    return " ".join(str(round(1000 * share)) for share in counts / max(len(values), 1))


def histograms(column: pd.Series) -> NDArray[np.float64]:
    """Return the mean of stored histograms, in shares of the frames."""
    return np.array([text.split() for text in column], float).mean(axis=0) / 1000


# --- pictures -------------------------------------------------------------------------------------

COLORS = (*OKABE_ITO.values(),)

PAPERS_LINE: dict[str, Any] = {
    "color": "0.1",
    "linestyle": "--",
    "path_effects": [withStroke(linewidth=3.0, foreground="w")],
}
"""How a picture marks what the paper says, visible on every ground."""

DENSITIES = "YlGnBu"
"""The map of densities: nothing is the color of the ground, so that `docs.scripts.dark` and the
site's style sheet, which turn lightness around, make a map of it that begins at dark ground."""


@contextmanager
def picture(
    options: Options, name: str, width_cm: float = 17.0, height_cm: float = 7.0
) -> Iterator[Figure]:
    """Yield an empty figure, and write it to ``pictures/<name>.png``."""
    with mpl.rc_context(page_style(9.0)):
        figure = Figure(figsize=(width_cm / 2.54, height_cm / 2.54), layout="constrained")
        yield figure
        write_png(figure, file := io.BytesIO(), 130)
    write(path := options.folder / "pictures" / f"{name}.png", file.getvalue())
    print(f"Drawn: {path}")


def curve(
    axes: Any, x: Iterable[float], intervals: Iterable[tuple[float, float, float]], **style: Any
) -> None:
    """Draw means with their intervals."""
    value, low, high = np.array(list(intervals)).T
    bars = np.nan_to_num(np.maximum([value - low, high - value], 0.0))
    axes.errorbar(list(x), value, bars, elinewidth=0.7, **{"marker": "o", **style})


def density_map(
    axes: Any, x: Sequence[float], edges: NDArray[np.float64], shares: Sequence[Any], most: float
) -> Any:
    """Draw histograms side by side, as densities over a uniform one."""
    centers = np.asarray(x, float)
    step = np.diff(centers).min() / 2
    sides = np.array([*(centers - step), centers[-1] + step])
    density = (len(edges) - 1) * np.array(shares).T
    axes.grid(visible=False)
    return axes.pcolormesh(
        sides, edges, density, cmap=DENSITIES, vmin=0.0, vmax=most, rasterized=True
    )


# --- scripts --------------------------------------------------------------------------------------


def main(script: Callable[[Options], None], arguments: Sequence[str] | None = None) -> None:
    """Run a script with the options of its command line."""
    parser = argparse.ArgumentParser(description=sys.modules[script.__module__].__doc__)
    parser.add_argument("--trial", action="store_true", help="two short runs per point, elsewhere")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, help="folder with a folder of each study")
    parser.add_argument("--no-runs", action="store_true", help="judge and draw what is there")
    given = parser.parse_args(arguments)
    if given.workers < 1:
        parser.error("--workers is at least 1")
    out = given.out or (HERE.parent / "results" / "studies-trial" if given.trial else HERE)
    study = Path(str(sys.modules[script.__module__].__file__)).parent.name
    options = Options(given.trial, given.workers, out, not given.no_runs, study)
    run(lambda: script(options))


def run(command: Callable[[], None], resumes: bool = True) -> None:
    """Run a command, and say in a line why it ended early; SIGTERM interrupts as Ctrl-C does."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        command()
    except KeyboardInterrupt:
        rest = "makes the runs that are missing" if resumes else "starts from the beginning"
        sys.exit(f"Interrupted: the same command {rest}")
    except (StudyError, flockenv.FlockError) as error:
        sys.exit(f"Error: {error}")
    finally:
        signal.signal(signal.SIGTERM, before)
