"""The report of `flockenv compare`: means, straight lines, files."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w
from rich.table import Table
from rich.text import Text

from flockenv._core import __version__
from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.comparison.episodes import (
    CONTROL_HZ,
    NO_LEADERS,
    ORDERING_TIMES,
    QUANTITIES,
    compare_leaders,
)
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.model import as_policy
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

__all__ = ["ComparisonReport", "report"]


# Columns that a table of one line per row needs.
_WIDE = 132
# The width of "[-0.123, 0.045]".
_INTERVAL_WIDTH = 15

NAMES = {
    "psi_o": "Ψ_o",
    "signed_order": "signed order",
    "share_towards_target": "time towards target",
}
"""Printed names of the `QUANTITIES`."""


@dataclass(frozen=True, slots=True)
class ComparisonReport:
    """Means of a comparison by policy and number of leaders, and the fitted lines.

    Attributes
    ----------
    parameters : FlockParameters
        Of the flock, except for the number of leaders.
    means : pandas.DataFrame
        One row for each policy and number of leaders.
    lines : dict
        The line for each (policy, quantity), over all its runs and those without leaders;
        empty for a single number of leaders.
    differences : pandas.DataFrame
        How much signed order each policy has beyond each one before it, its ``reference``, seed by
        seed, for each number of leaders; empty for a single policy.
    runs : pandas.DataFrame
        One row per episode, of `compare_leaders`.
    conditions : dict
        What the numbers depend on, the parameters aside: seeds, policies, options.
    environment : dict
        Options of the environment that differ from its defaults.
    """

    parameters: FlockParameters
    means: "pd.DataFrame"
    lines: dict[tuple[str, str], Line]
    differences: "pd.DataFrame"
    runs: "pd.DataFrame"
    conditions: Mapping[str, Any]
    environment: Mapping[str, Any] = field(default_factory=dict)

    def write(self, folder: Path) -> None:
        """Write the comparison into a folder, which is made.

        ``runs.csv``, ``means.csv``, ``lines.csv``, ``differences.csv``, ``leader_curve.png``,
        ``parameters.toml`` (those of the flock) and ``run.toml`` (all else that the numbers depend
        on).

        Raises
        ------
        OSError
            If one cannot be written; each is whole or as it was before.
        """
        from flockenv.comparison.figure import leader_curve

        folder.mkdir(parents=True, exist_ok=True)
        for name, table in (
            ("runs", self.runs),
            ("means", self.means),
            ("lines", _lines_table(self.lines)),
            ("differences", self.differences),
        ):
            write_csv(folder / f"{name}.csv", table)
        write_text(folder / "run.toml", tomli_w.dumps(dict(self.conditions)))
        header = f"# flockenv {__version__}: the flock; seeds, policies and options in run.toml\n"
        write_text(folder / "parameters.toml", header + self.parameters.to_toml())
        picture = folder / "leader_curve.png"
        leader_curve(self.runs, self.means, self.lines, self.title(), picture)

    def title(self) -> str:
        """Return the parameters and the options in one line."""
        parameters, options = self.parameters, dict(self.environment)
        target = options.pop("target", parameters.target)
        dropped = options.pop("dropout_rate", 0.0)
        parts = [
            f"{parameters.n_boats} boats",
            f"pool {parameters.pool}",
            f"bw = {parameters.bw_s:g} s",
            "alternating targets" if target == "alternate" else f"target {target}",
            *([f"{100 * dropped:.3g} % of positions dropped"] if dropped else []),
            *(f"{name} = {value}" for name, value in options.items()),
            f"{parameters.scheme} + {parameters.noise_scheme}",
        ]
        return ", ".join(parts)

    def table(self, width: int = _WIDE) -> Table:
        """Return the means as a table for a terminal of this width in columns."""
        is_wide = width >= _WIDE
        table = Table(title=self.title(), title_justify="left", caption_justify="left")
        table.caption = (
            f"means over {self.means['runs'].max()} runs with {CONFIDENCE:.0%} intervals"
        )
        if not is_wide:
            table.box, table.padding, table.pad_edge = None, (0, 1, 0, 0), False
        table.add_column("policy", overflow="fold")
        table.add_column("leaders", no_wrap=True)
        for quantity in QUANTITIES:
            table.add_column(NAMES[quantity], no_wrap=is_wide, min_width=_INTERVAL_WIDTH)
        table.add_column("ordered", no_wrap=True)
        for row in self.means.to_dict("records"):
            cells = [
                f"{row[q]:6.3f}{' ' if is_wide else chr(10)}"
                f"[{row[f'{q}_low']:.3f}, {row[f'{q}_high']:.3f}]"
                for q in QUANTITIES
            ]
            ordered = f"{row['ordered']:4.0%}"
            table.add_row(Text(row["policy"]), str(row["leaders"]), *cells, ordered)
        return table

    def differences_in_words(self) -> str:
        """Return the differences from the first policy, one per line."""
        shown = self.differences
        if len(shown) > 0:
            shown = shown[shown["reference"] == shown["reference"].iloc[0]]
        return "\n".join(
            f"{row['policy']} - {row['reference']}, k = {row['leaders']}: signed order "
            f"{row['mean']:+.3f} [{row['low']:+.3f}, {row['high']:+.3f}], d = {row['effect']:.2f}"
            for row in shown.to_dict("records")
        )

    def lines_in_words(self) -> str:
        """Return the fitted lines, one per line of text."""
        return "\n".join(
            f"{policy}: {NAMES[quantity]} = {line}"
            for (policy, quantity), line in self.lines.items()
        )


def report(
    parameters: FlockParameters,
    leaders: Sequence[int],
    policies: Mapping[str, Callable[[], LeaderPolicy | str]],
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None],
    environment: Mapping[str, Any] | None = None,
) -> ComparisonReport:
    """Run a comparison of policies.

    Raises
    ------
    ParameterError
        For parameters, seeds and durations out of range.
    MissingExtraError
        Without the extra ``plot``.
    """
    # All of them before hours of runs.
    for package in ("matplotlib", "pandas", "scipy"):
        require(package, "plot")
    runs = compare_leaders(parameters, leaders, policies, seeds, duration_s, progress, environment)
    means = _means(runs)
    lines = {}
    for policy in policies:
        own = runs[runs["policy"].isin([policy, NO_LEADERS])]
        for quantity in QUANTITIES if own["leaders"].nunique() > 1 else ():
            lines[policy, quantity] = fit_line(own["leaders"], own[quantity])
    differences = _differences(runs, list(policies))
    conditions = {
        "flockenv": __version__,
        "duration_s": float(duration_s),
        "leaders": [int(k) for k in leaders],
        "seeds": {"first": int(seeds[0]), "last": int(seeds[-1]), "number": len(seeds)},
        "policies": {name: str(as_policy(make())) for name, make in policies.items()},
        "environment": {
            "target": parameters.target,
            "control_hz": CONTROL_HZ,
            **(environment or {}),
        },
    }
    return ComparisonReport(
        parameters, means, lines, differences, runs, conditions, environment or {}
    )


def _means(runs: "pd.DataFrame") -> "pd.DataFrame":
    """Return means and intervals, which part of the runs ordered, and how soon those did (medians).

    A median is infinite where none did.
    """
    by, times = ["policy", "leaders"], list(ORDERING_TIMES)
    means = summarize(runs, by, list(QUANTITIES))
    came = runs[[*by, *times]].replace(math.inf, math.nan).groupby(by, sort=False)
    columns = came[times].median().fillna(math.inf)
    columns["ordered"] = came["ordering_time_wide_s"].count() / came.size()
    merged: pd.DataFrame = means.merge(columns.reset_index(), on=by, validate="one_to_one")
    return merged


def _differences(runs: "pd.DataFrame", policies: Sequence[str]) -> "pd.DataFrame":
    """Return what each policy has beyond each one before it, seed by seed."""
    pandas = require("pandas", "plot")
    runs = runs[runs["leaders"] > 0]
    orders = runs.pivot_table(index=["leaders", "seed"], columns="policy", values="signed_order")
    rows = [
        {"policy": policy, "reference": reference, "leaders": k}
        | asdict(paired_difference(orders.loc[k][policy], orders.loc[k][reference]))
        for reference, policy in itertools.combinations(policies, 2)
        for k in sorted(runs["leaders"].unique())
    ]
    columns = ["policy", "reference", "leaders", *(each.name for each in fields(Difference))]
    table: pd.DataFrame = pandas.DataFrame(rows, columns=columns)
    return table


def _lines_table(lines: Mapping[tuple[str, str], Line]) -> "pd.DataFrame":
    pandas = require("pandas", "plot")
    rows = [
        {"policy": policy, "quantity": quantity} | asdict(line)
        for (policy, quantity), line in lines.items()
    ]
    table: pd.DataFrame = pandas.DataFrame(rows).rename(columns={"n": "runs"})
    return table
