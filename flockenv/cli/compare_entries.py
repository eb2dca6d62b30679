"""`flockenv compare --suite v3`: entries on the levels of the suite."""

import json
from collections.abc import Sequence
from pathlib import Path

import typer

from flockenv._io.atomic_write import write_csv
from flockenv.cli.console import echo, errors, print_json, warn
from flockenv.cli.options import Printing
from flockenv.cli.output import prepare
from flockenv.cli.progress import progress
from flockenv.comparison.levels import FLOCKS, LEVELS, SUITE
from flockenv.comparison.report import overlap_notes
from flockenv.comparison.suite_entry import Scored, SuiteEntry, scored
from flockenv.errors import ParameterError, refuse_unknown


def compare_entries(
    files: Sequence[str],
    tasks: Sequence[str],
    trial_flocks: int | None,
    out: Path,
    printing: Printing,
    *,
    trust: bool,
) -> None:
    """Score entries; write a table with a row per entry and level, and one with a row per flock."""
    levels, flocks = _levels(tasks), trial_flocks or FLOCKS
    if not files:
        raise ParameterError(f"--suite {SUITE} scores entries: name the file of one with --entry")
    if flocks > FLOCKS:
        raise ParameterError(f"--trial-flocks {flocks} is not accepted: at most {FLOCKS}")
    entries = [SuiteEntry.from_file(path, trust=trust) for path in files]
    _check_names(entries)
    levels = [level for level in levels if any(level in entry.trainings for entry in entries)]
    if not levels:
        raise ParameterError("no entry has a policy for a level that --task names")
    table = out / "entries.csv"
    prepare(table)
    if flocks < FLOCKS:
        echo(f"A trial: rows of the table are of {FLOCKS} flocks, not {flocks}", errors)
    results = _score_and_write(entries, levels, flocks, table, printing.hides_progress)
    _show(results, out, printing)
    for reason in results.broken:
        echo(f"Not scored: {reason}", errors)
    if results.broken:
        raise typer.Exit(1)


def _score_and_write(
    entries: Sequence[SuiteEntry], levels: Sequence[str], flocks: int, table: Path, quiet: bool
) -> Scored:
    """Score entries, and write all rows so far after each entry.

    Warns of overlaps in the written flocks, also after Ctrl-C.
    """
    orders = table.with_name("orders.csv")
    written: Scored | None = None
    hours = _flock_hours(entries, levels, flocks)
    try:
        with progress("scoring", 3600 * hours, quiet) as advance:
            for results in scored(entries, levels, flocks, advance):
                if len(results.rows):
                    write_csv(table, results.rows, float_format="%.6g")
                    write_csv(orders, results.orders, float_format="%.6g")
                    written = results
    except KeyboardInterrupt:
        if written is None:
            raise
        stored = f"{table} holds the rows of entries that were finished."
        raise KeyboardInterrupt(stored) from None
    finally:
        for line in overlap_notes(written.orders) if written is not None else ():
            warn(f"{line}; {orders} says which")
    return results


def _flock_hours(entries: Sequence[SuiteEntry], levels: Sequence[str], flocks: int) -> float:
    """Return the simulated hours of all policies of the entries and of both references."""
    hours = {level: LEVELS[level].flock_hours(flocks) for level in levels}
    of_entries = sum(
        len(entry.trainings.get(level, ())) * hours[level] for entry in entries for level in levels
    )
    return of_entries + 2 * sum(hours.values())


def _show(results: Scored, out: Path, printing: Printing) -> None:
    """Print the rows and the path of their table."""
    if printing.as_json:
        print_json({"entries": json.loads(results.rows.to_json(orient="records"))})
        return
    for row in results.rows.to_dict("records"):
        score = f"{row['score']:.3f} [{row['score_low']:.3f}, {row['score_high']:.3f}]"
        echo(f"{row['level']}, {row['budget']} flock-hours, {row['entry']}: {score}")
    if len(results.rows):
        echo(f"Written to {out}")


def _levels(tasks: Sequence[str]) -> list[str]:
    """Return the names of the levels that `--task` names, or of all levels without `--task`."""
    refuse_unknown(tasks, LEVELS, f"level of suite {SUITE}")
    return [level for level in LEVELS if not tasks or level in tasks]


def _check_names(entries: list[SuiteEntry]) -> None:
    """Refuse two entries with the same name and budget: their rows would look the same."""
    names = [f"{entry.name}, {entry.budget} flock-hours" for entry in entries]
    for name in names:
        if names.count(name) > 1:
            raise ParameterError(f"two entries are called {name}: give one another name")
