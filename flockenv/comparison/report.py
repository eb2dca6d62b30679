"""The report of `flockenv compare`: means, paired differences, straight lines, files."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w
from rich.table import Table
from rich.text import Text

from flockenv._core import __version__
from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.comparison.case import Case
from flockenv.comparison.episodes import NO_LEADERS, ORDERING_TIMES, QUANTITIES
from flockenv.statistics import (
    CONFIDENCE,
    Difference,
    Line,
    fit_line,
    paired_difference,
    summarize,
)

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["ComparisonReport", "joined", "report"]


@dataclass(frozen=True, slots=True)
class ComparisonReport:
    """What policies reached in some cases.

    Attributes
    ----------
    cases : tuple of Case
        The cases.
    runs : pandas.DataFrame
        One row per episode, of `Case.run`.
    means : pandas.DataFrame
        One row for each case, policy and number of leaders: means with intervals, the share of the
        episodes that ordered, and the median time to it (infinite where none did).
    differences : pandas.DataFrame
        How much signed order each policy has beyond each one after it, its ``reference``, seed by
        seed, for each case and number of leaders; empty for a single policy.
    lines : pandas.DataFrame
        The line of each quantity over the number of leaders, by case and policy, over all its
        episodes and those without leaders; empty for a single number of leaders.
    conditions : dict
        What else the numbers depend on: the command, and the policies of each case as they print.
    """

    cases: tuple[Case, ...]
    runs: "pd.DataFrame"
    means: "pd.DataFrame"
    differences: "pd.DataFrame"
    lines: "pd.DataFrame"
    conditions: Mapping[str, Any] = field(default_factory=dict)

    def write(self, folder: Path) -> None:
        """Write the comparison into a folder, which is made.

        ``runs.csv``, ``means.csv``, ``differences.csv``, ``lines.csv``, ``run.toml`` (all that the
        numbers depend on but the parameters), for each case its parameters in ``NAME.toml``, and
        ``leader_curve.png`` if a case has several numbers of leaders.

        Raises
        ------
        OSError
            If one cannot be written; each is whole or as it was before.
        """
        folder.mkdir(parents=True, exist_ok=True)
        for name in ("runs", "means", "differences", "lines"):
            write_csv(folder / f"{name}.csv", getattr(self, name))
        write_text(folder / "run.toml", tomli_w.dumps(self._provenance()))
        for case in self.cases:
            header = f"# flockenv {__version__}: the flock; seeds, policies and options in run.toml"
            text = f"{header}\n{case.parameters.to_toml()}"
            write_text(folder / f"{case.name}.toml", text)
        if len(self.lines) > 0:
            from flockenv.comparison.figure import leader_curve

            titles = {case.name: case.title() for case in self.cases}
            leader_curve(self.means, folder / "leader_curve.png", runs=self.runs, titles=titles)

    def _provenance(self) -> dict[str, Any]:
        cases = {
            case.name: {
                "leaders": list(case.leaders),
                "seeds": {"first": case.seeds[0], "number": len(case.seeds)},
                "episode_s": case.episode_s,
                "environment": {"target": case.parameters.target, **case.environment},
            }
            for case in self.cases
        }
        return {"flockenv": __version__, **self.conditions, "cases": cases}

    def table(self) -> Table:
        """Return the mean signed orders as a table: rows are numbers of leaders."""
        runs = self.means["runs"].max()
        table = Table(title="signed order of the normal boats", title_justify="left", box=None)
        table.padding, table.pad_edge = (0, 1, 0, 0), False  # Four policies fit into 80 columns.
        table.caption = f"± half the {CONFIDENCE:.0%} interval of the mean over {runs} episodes"
        table.caption_justify = "left"
        table.add_column("", overflow="fold")
        table.add_column("leaders", no_wrap=True)
        policies = [name for name in self.means["policy"].unique() if name != NO_LEADERS]
        for name in policies or [NO_LEADERS]:
            table.add_column(Text(name), min_width=12, overflow="fold")
        for case in self.cases:
            own = self.means[self.means["case"] == case.name]
            name = case.name
            for k in sorted(own["leaders"].unique()):
                found = own[own["leaders"] == k].set_index("policy")
                # Flocks without leaders are the same for all policies.
                names = policies if k > 0 else [NO_LEADERS]
                cells = [_plus_minus(found.loc[name]) for name in names if name in found.index]
                table.add_row(Text(name), str(k), *cells)
                name = ""
        return table

    def in_words(self) -> str:
        """Return the differences and the lines, one per line of text."""
        differences = [
            f"{row['case']}, {row['policy']} minus {row['reference']}, k = {row['leaders']}: "
            f"{row['mean']:+.3f} [{row['low']:+.3f}, {row['high']:+.3f}], d = {row['effect']:.2f}"
            for row in self.differences.to_dict("records")
        ]
        names = [each.name for each in fields(Line)]
        lines = [
            f"{row['case']}, {row['policy']}: {row['quantity']} = "
            f"{Line(**{name: row[name] for name in names})}"
            for row in self.lines.to_dict("records")
        ]
        return "\n".join(differences + lines)


def _plus_minus(row: Mapping[str, Any]) -> str:
    half = (row["signed_order_high"] - row["signed_order_low"]) / 2
    return f"{row['signed_order']:.3f} ±{half:.3f}"


def report(
    cases: Sequence[Case],
    policies: Sequence[str],
    runs: "pd.DataFrame",
    conditions: Mapping[str, Any] | None = None,
) -> ComparisonReport:
    """Return what the episodes of some cases say.

    Parameters
    ----------
    cases, runs
        The cases, and the rows of `Case.run` of all of them.
    policies
        Names, those first whose differences from the others are wanted.
    conditions
        What else the numbers depend on.

    Raises
    ------
    MissingExtraError
        Without the extra ``plot``.
    """
    return ComparisonReport(
        tuple(cases),
        runs,
        _means(runs),
        _differences(runs, policies),
        _lines(runs, policies),
        conditions or {},
    )


def joined(tables: "Sequence[pd.DataFrame]") -> "pd.DataFrame":
    """Return the rows of several tables as one."""
    table: pd.DataFrame = require("pandas", "plot").concat(tables, ignore_index=True)
    return table


def _means(runs: "pd.DataFrame") -> "pd.DataFrame":
    by, times = ["case", "policy", "leaders"], list(ORDERING_TIMES)
    means = summarize(runs, by, list(QUANTITIES))
    came = runs[[*by, *times]].replace(math.inf, math.nan).groupby(by, sort=False)
    columns = came[times].median().fillna(math.inf)
    columns["ordered"] = came["ordering_time_wide_s"].count() / came.size()
    merged: pd.DataFrame = means.merge(columns.reset_index(), on=by, validate="one_to_one")
    return merged


def _differences(runs: "pd.DataFrame", policies: Sequence[str]) -> "pd.DataFrame":
    """Return what each policy has beyond each one after it, seed by seed."""
    rows = []
    for (case, k), own in runs[runs["leaders"] > 0].groupby(["case", "leaders"], sort=False):
        orders = own.pivot_table(
            index="seed", columns="policy", values="signed_order", dropna=False
        )
        for policy, reference in itertools.combinations(policies, 2):
            if {policy, reference} <= set(orders):
                found = asdict(paired_difference(orders[policy], orders[reference]))
                names = {"case": case, "policy": policy, "reference": reference, "leaders": k}
                rows.append(names | found)
    columns = [
        "case",
        "policy",
        "reference",
        "leaders",
        *(each.name for each in fields(Difference)),
    ]
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows, columns=columns)
    return table


def _lines(runs: "pd.DataFrame", policies: Sequence[str]) -> "pd.DataFrame":
    """Return the line of each quantity over the number of leaders, by case and policy."""
    rows = []
    for case, every in runs.groupby("case", sort=False):
        for policy in policies:
            own = every[every["policy"].isin([policy, NO_LEADERS])].dropna(subset=list(QUANTITIES))
            if policy not in set(own["policy"]) or own["leaders"].nunique() < 2 or len(own) < 3:
                continue
            for quantity in QUANTITIES:
                line = asdict(fit_line(own["leaders"], own[quantity]))
                rows.append({"case": case, "policy": policy, "quantity": quantity} | line)
    columns = ["case", "policy", "quantity", *(each.name for each in fields(Line))]
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows, columns=columns)
    return table
