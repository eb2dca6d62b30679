"""Studies: designs as tables of runs, and the scripts that make, judge and draw them.

A design is a list of rows; a row says all that a run depends on, its seed included. The result is
``results/<name>.csv`` in the study's folder, compressed if it is long, with one line per run: the
row, what was measured, and the results version of the code that made it. A run that has a line is
not made again, so that work resumes where it ended; a file never holds runs of two versions.
Every claim of the paper that a study judges is a line of its ``claims.csv``, with the number of its
runs.
"""

import argparse
import os
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.runs.seeds import POLICY_SEEDS
from studies.store import Row, Store, StudyError, existing

HERE = Path(__file__).parent
FIRST_SEED = POLICY_SEEDS["paper"].first
"""Seeds of these studies are from here on; nothing else uses them."""
SEEDS = 24  # Runs at each point of a design, unless it says otherwise.


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
