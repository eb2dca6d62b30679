"""`reproduce`: runs what figures need, and writes figures, data, claims and the report."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from flockenv.errors import FlockError
from flockenv.reproduce.catalogue import ALL, BUDGETED, load, resolve
from flockenv.reproduce.claim import CheckedClaim
from flockenv.reproduce.files import (
    claims_table,
    csv_bytes,
    picture_bytes,
    write_file,
    write_outcome,
    write_table,
)
from flockenv.reproduce.report import html_report
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.style import mark_short
from flockenv.reproduce.summary import (
    CLAIMS,
    Finished,
    data_tables,
    markdown_summary,
    shown_pictures,
)
from flockenv.runs.executors import Engine, local
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RUNS_FOLDER, RunStore, run_missing

__all__ = ["Plan", "mark_where_short", "plan", "reproduce"]


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be reproduced, and the runs it takes, each once.

    Attributes
    ----------
    given : list of str
        The names as given, `ALL` among them or not.
    names : list of str
        What they stand for.
    settings : Settings
        What the user chose.
    specs : list of RunSpec
        All runs.
    """

    given: list[str]
    names: list[str]
    settings: Settings
    specs: list[RunSpec]

    @property
    def cost(self) -> float:
        """The work of all runs, in the unit of `RunSpec.cost`."""
        return sum(spec.cost for spec in self.specs)


def plan(given: Iterable[str], settings: Settings) -> Plan:
    """Return what names stand for and need; nothing is run or written.

    Raises
    ------
    ParameterError
        For an unknown name.
    MissingExtraError
        Without the extra ``plot``.
    """
    given = list(given)
    names = resolve(given)
    specs = [spec for name in names for spec in load(name).runs(settings)]
    return Plan(given, names, settings, list(dict.fromkeys(specs)))


def reproduce(
    plan: Plan,
    folder: Path,
    engine: Engine = local,
    progress: Callable[[RunSpec], None] = lambda spec: None,
    notify: Callable[[str], None] | None = None,
    summary: Path | None = None,
    workers: int | None = None,
) -> dict[str, list[CheckedClaim]]:
    """Make the missing runs, then write ``<folder>/<name>/`` for each name.

    With `ALL` among the names also ``report.html``, complete in itself, ``summary.md``, and the
    claims of all figures as ``claims.csv`` and ``claims.parquet``.

    Parameters
    ----------
    plan
        Of `plan`.
    folder
        Of the results; finished runs are stored in its `RUNS_FOLDER` and not repeated.
    engine
        Where to run.
    progress
        Called with each spec once its run is there.
    notify
        See `RunStore`.
    summary
        Where to write a page of claims and pictures, like ``summary.md``; the pictures, and where
        figures are named one by one their data, go into a folder of the same name beside it.
    workers
        How many runs at a time; every core that this process may use by default.

    Returns
    -------
    dict
        The judged claims of each name.

    Raises
    ------
    FlockError
        If runs failed (all others are stored), or files cannot be written.
    """
    runs = folder / RUNS_FOLDER
    store = RunStore(runs, notify) if notify else RunStore(runs)
    failures = run_missing(plan.specs, store, engine, progress, workers)
    for spec, error in failures.items():
        raise FlockError(f"{len(failures)} runs failed, the first of seed {spec.seed}: {error}")
    finished = []
    derived: dict[Any, Any] = {}
    for name in plan.names:
        figure = load(name)
        specs = list(dict.fromkeys(figure.runs(plan.settings)))
        outcome = figure.analyze(plan.settings, Results(store, specs, derived))
        mark_where_short(figure, plan.settings, specs, outcome)
        write_outcome(outcome, folder / name)
        finished.append((figure, specs, outcome))
    if ALL in plan.given:
        _write_report(plan, folder, finished)
    if summary is not None:
        _write_summary(plan, finished, summary)
    return {figure.name: outcome.claims for figure, _, outcome in finished}


def mark_where_short(
    figure: Reproduction, settings: Settings, specs: list[RunSpec], outcome: Outcome
) -> None:
    """Say so in a figure's pictures where its runs are shorter than the paper's."""
    if settings.minutes is None:
        return
    # A budget that suffices for short runs may not for those of full length.
    own = figure.runs(replace(settings, minutes=None, budget_core_min=math.inf))
    given_s, own_s = (max((spec.duration_s for spec in each), default=0.0) for each in (specs, own))
    if given_s < own_s:
        for picture in outcome.pictures.values():
            full = "in the full design" if figure.name in BUDGETED else "in the paper"
            mark_short(picture, given_s / 60, f"{own_s / 60:g} min {full}")


def _write_report(
    plan: Plan,
    folder: Path,
    finished: Finished,
) -> None:
    judged = [claim for _, _, outcome in finished for claim in outcome.claims]
    write_table(claims_table(judged), folder / "claims")
    write_file(folder / "report.html", html_report(plan.settings, finished).encode())
    write_file(folder / "summary.md", markdown_summary(plan.settings, finished).encode())


def _write_summary(plan: Plan, finished: Finished, summary: Path) -> None:
    outcomes = {figure.name: outcome for figure, _, outcome in finished}
    for figure, name, _ in shown_pictures(finished):
        picture = picture_bytes(outcomes[figure.name].pictures[name], "png")
        write_file(summary.with_suffix("") / f"{name}.png", picture)
    for figure, name in data_tables(finished):
        claims = outcomes[figure.name].claims
        table = claims_table(claims) if name == CLAIMS else outcomes[figure.name].tables[name]
        write_file(summary.with_suffix("") / f"{name}.csv", csv_bytes(table))
    page = markdown_summary(plan.settings, finished, summary.stem)
    write_file(summary, page.encode())
