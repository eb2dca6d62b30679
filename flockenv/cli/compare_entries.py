"""`flockenv compare --suite v3`: entries on the levels of the suite."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
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
    """Score entries, and write a row for each of their levels and one for every flock."""
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
    found = _written(entries, levels, flocks, table, printing.shows_nothing)
    _show(found, out, printing)
    for words in found.broken:
        echo(f"Not scored: {words}", errors)
    if found.broken:
        raise typer.Exit(1)


def _written(
    entries: Sequence[SuiteEntry], levels: Sequence[str], flocks: int, table: Path, quiet: bool
) -> Scored:
    """Score entries and write their rows; warn of overlaps in them, also after Ctrl-C."""
    policies = [len(entry.trainings.get(level, ())) for entry in entries for level in levels]
    led = [LEVELS[level].flock_hours(flocks) for _ in entries for level in levels]
    hours = sum(np.multiply(policies, led)) + 2 * sum(led[: len(levels)])
    kept = f"{table} holds the rows of entries that were finished."
    orders = table.with_name("orders.csv")
    notes: list[str] = []
    try:
        with progress("scoring", 3600 * hours, quiet, kept=kept) as advance:
            for found in scored(entries, levels, flocks, advance):
                if len(found.rows):
                    write_csv(table, found.rows, float_format="%.6g")
                    write_csv(orders, found.orders, float_format="%.6g")
                    notes = overlap_notes(found.orders)
    finally:
        for line in notes:
            warn(f"{line}; {orders} says which")
    return found


def _show(found: Scored, out: Path, printing: Printing) -> None:
    """Print the rows and the path of their table."""
    if printing.as_json:
        print_json({"entries": json.loads(found.rows.to_json(orient="records"))})
        return
    for row in found.rows.to_dict("records"):
        ends_at = f"{row['score']:.3f} [{row['score_low']:.3f}, {row['score_high']:.3f}]"
        echo(f"{row['level']}, {row['budget']} flock-hours, {row['entry']}: {ends_at}")
    if len(found.rows):
        echo(f"Written to {out}")


def _levels(tasks: Sequence[str]) -> list[str]:
    """Return the levels with these names, or all levels if there are no names."""
    refuse_unknown(tasks, LEVELS, f"level of suite {SUITE}")
    return [level for level in LEVELS if not tasks or level in tasks]


def _check_names(entries: list[SuiteEntry]) -> None:
    """Refuse two entries with the same name and budget: their rows would look the same."""
    names = [f"{entry.name}, {entry.budget} flock-hours" for entry in entries]
    for name in names:
        if names.count(name) > 1:
            raise ParameterError(f"two entries are called {name}: give one another name")
