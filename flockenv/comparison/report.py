"""The report of `flockenv compare`: means, paired differences, straight lines, files."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import tomli_w
from rich.console import Console
from rich.table import Table
from rich.text import Text

from flockenv._core import __version__
from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.comparison.case import Case
from flockenv.comparison.episodes import NO_LEADERS, ORDERING_TIMES, QUANTITIES
from flockenv.policies.base import Policy
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

_TABLES = ("runs", "means", "differences", "lines")


@dataclass(frozen=True)
class ComparisonReport:
    """Results of a comparison of policies, in one or more cases (extra ``plot``)."""

    cases: Sequence[Case]
    #: Names of policies, the user's first.
    policies: Sequence[str]
    #: One row per episode: the rows of `Case.run` of all cases.
    runs: "pd.DataFrame"
    #: Everything else on which the numbers depend.
    conditions: Mapping[str, object] = field(default_factory=dict)

    @cached_property
    def means(self) -> "pd.DataFrame":
        """Means with intervals by case, policy and number of leaders.

        Further columns are ``ordered``, the fraction of the episodes in which the flock ordered,
        and the median of each ordering time where it is finite (infinite if it never is).
        """
        by, times = ["case", "policy", "leaders"], list(ORDERING_TIMES)
        means = summarize(self.runs, by, list(QUANTITIES))
        # Without the infinite times of episodes in which the flock did not order.
        finite = self.runs[[*by, *times]].replace(math.inf, math.nan).groupby(by, sort=False)
        columns = finite[times].median().fillna(math.inf)
        columns["ordered"] = finite["ordering_time_wide_s"].count() / finite.size()
        merged: pd.DataFrame = means.merge(columns.reset_index(), on=by, validate="one_to_one")
        return merged

    @cached_property
    def differences(self) -> "pd.DataFrame":
        """Signed order of each policy minus that of every later policy, its ``reference``.

        Differences are taken seed by seed, for each case and number of leaders. The table is empty
        for a single policy.
        """
        rows = []
        runs_with_leaders = self.runs[self.runs["leaders"] > 0]
        for (case, k), runs in runs_with_leaders.groupby(["case", "leaders"], sort=False):
            orders = runs.pivot_table(
                index="seed", columns="policy", values="signed_order", dropna=False
            )
            for policy, reference in itertools.combinations(self.policies, 2):
                if {policy, reference} <= set(orders):
                    difference = asdict(paired_difference(orders[policy], orders[reference]))
                    names = {"case": case, "policy": policy, "reference": reference, "leaders": k}
                    rows.append(names | difference)
        return _table(rows, ["case", "policy", "reference", "leaders"], Difference)

    @cached_property
    def lines(self) -> "pd.DataFrame":
        """A straight line of each quantity over the number of leaders, by case and policy.

        The line is fitted to the policy's episodes and to those without leaders. The table is empty
        if all episodes have the same number of leaders.
        """
        rows = []
        for case, case_runs in self.runs.groupby("case", sort=False):
            for policy in self.policies:
                runs = case_runs[case_runs["policy"].isin([policy, NO_LEADERS])]
                runs = runs.dropna(subset=list(QUANTITIES))
                counts = runs["leaders"]
                if policy in set(runs["policy"]) and counts.nunique() > 1 and len(runs) > 2:
                    for quantity in QUANTITIES:
                        line = asdict(fit_line(counts, runs[quantity]))
                        rows.append({"case": case, "policy": policy, "quantity": quantity} | line)
        return _table(rows, ["case", "policy", "quantity"], Line)

    def write(self, folder: Path) -> None:
        """Write the comparison into a folder, which is made if it does not exist.

        The files are ``runs.csv``, ``means.csv``, ``differences.csv`` and ``lines.csv``;
        ``run.toml`` with everything that the numbers depend on, except for the parameters;
        ``NAME.toml`` with the parameters of each case; and ``leader_curve.png`` if a case has
        several numbers of leaders. Each file is either complete or unchanged.
        """
        folder.mkdir(parents=True, exist_ok=True)
        for name in _TABLES:
            write_csv(folder / f"{name}.csv", getattr(self, name))
        cases = {case.name: case.described() for case in self.cases}
        conditions = {"flockenv": __version__, **self.conditions, "cases": cases}
        write_text(folder / "run.toml", tomli_w.dumps(conditions))
        for case in self.cases:
            header = f"# flockenv {__version__}: case {case.name}; policies and options in run.toml"
            write_text(folder / f"{case.name}.toml", f"{header}\n{case.parameters.to_toml()}")
        if len(self.lines) > 0:
            from flockenv.comparison.figure import leader_curve

            titles = {case.name: case.title() for case in self.cases}
            leader_curve(self.means, folder / "leader_curve.png", runs=self.runs, titles=titles)

    def table(self) -> Table:
        """Return the mean signed orders as a table: rows are numbers of leaders."""
        table = Table(title="signed order of the normal boats", title_justify="left", box=None)
        table.padding, table.pad_edge = (0, 1, 0, 0), False  # Four policies fit into 80 columns.
        runs = self.means["runs"].max()
        table.caption = f"± half the {CONFIDENCE:.0%} interval of the mean over {runs} episodes"
        table.caption_justify = "left"
        table.add_column("", overflow="fold")
        table.add_column("leaders", no_wrap=True)
        policies = [name for name in self.means["policy"].unique() if name != NO_LEADERS]
        columns = policies or [NO_LEADERS]
        for name in columns:
            table.add_column(Text(name), min_width=12, overflow="fold")
        for case in self.cases:
            case_means = self.means[self.means["case"] == case.name]
            title = case.name
            for k in sorted(case_means["leaders"].unique()):
                means = case_means[case_means["leaders"] == k].set_index("policy")
                # Flocks without leaders are the same for all policies.
                names = columns if k > 0 else [NO_LEADERS] * len(columns)
                cells = [_plus_minus(means.loc[n]) if n in means.index else "" for n in names]
                table.add_row(Text(title), str(k), *cells)
                title = ""
        return table

    def in_words(self) -> str:
        """Return the differences and the lines, one per line of text."""
        differences = [
            f"{row['case']}, {row['policy']} minus {row['reference']}, k = {row['leaders']}: "
            f"{row['mean']:+.3f} [{row['low']:+.3f}, {row['high']:+.3f}]"
            + ("" if math.isnan(row["effect"]) else f", d = {row['effect']:.2f}")
            for row in self.differences.dropna(subset=["mean"]).to_dict("records")
        ]
        names = [column.name for column in fields(Line)]
        lines = [
            f"{row['case']}, {row['policy']}: {row['quantity']} = "
            f"{Line(**{name: row[name] for name in names})}"
            for row in self.lines.to_dict("records")
        ]
        return "\n".join([*differences, *lines])

    def card(self, name: str, policy: Policy | Mapping[str, Policy]) -> str:
        """Return a policy's model card as Markdown: its provenance and its comparison."""
        lines = [f"# {name}", "", f"The policy is `{policy_title(policy)}`.", ""]
        source = policy.source if isinstance(policy, Policy) else None
        provenance = getattr(source, "provenance", None) or {}
        lines += [f"- {key}: `{text}`" for key, text in provenance.items()]
        origin = f"`{self.conditions.get('command', '')}` made this with flockenv {__version__}."
        lines += ["", "## Comparison", "", origin, ""]
        lines += [
            f"- {case.name}: {case.title()}; {len(case.seeds)} episodes of {case.episode_s:g} s"
            for case in self.cases
        ]
        output = StringIO()
        Console(file=output, width=120).print(self.table())
        table = "\n".join(line.rstrip() for line in output.getvalue().splitlines())
        notes = [self.in_words(), *overlap_notes(self.runs)]
        return "\n".join([*lines, "", "```text", table, "", *notes, "```", ""])


def overlap_notes(episodes: "pd.DataFrame", words: str = "episodes") -> list[str]:
    """Return a line that says in how many episodes overlaps exceeded the tolerance.

    The list is empty if there is no such episode; `words` names the episodes.
    """
    deep = episodes[episodes["unsolved"] > 0]
    return overlap_note(len(episodes), len(deep), deep["worst_overlap_cm"].max(), words)


def overlap_note(total: int, deep: int, worst_cm: float, words: str) -> list[str]:
    """Return a line on the `deep` of `total` episodes whose overlaps exceeded the tolerance.

    The list is empty if `deep` is 0; `words` names the episodes.
    """
    if deep == 0:
        return []
    return [
        f"{deep} of {total} {words} left overlaps deeper than tolerance_cm; "
        f"the deepest is {worst_cm:.2g} cm"
    ]


def policy_title(policy: Policy | Mapping[str, Policy]) -> str:
    """Return in one line a policy's name, or the name of each leader's policy."""
    if isinstance(policy, Policy):
        return policy.name
    return "; ".join(f"{leader}: {own_policy.name}" for leader, own_policy in policy.items())


def _plus_minus(row: Mapping[str, float]) -> str:
    """Return the mean signed order of a row with half its interval."""
    half = (row["signed_order_high"] - row["signed_order_low"]) / 2
    return "unknown" if math.isnan(half) else f"{row['signed_order']:.3f} ±{half:.3f}"


def _table(
    rows: list[dict[str, object]], keys: list[str], result: type[Difference] | type[Line]
) -> "pd.DataFrame":
    """Return rows as a table, which has its columns even without rows."""
    columns = [*keys, *(column.name for column in fields(result))]
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows, columns=columns)
    return table
