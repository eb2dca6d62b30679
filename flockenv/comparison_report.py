"""The report of `flockenv compare`: means, straight lines, files."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

from flockenv._core import __version__
from flockenv.analysis import CONFIDENCE, Line, fit_line, summarise
from flockenv.comparison import NO_LEADERS, POLICIES, QUANTITIES, compare_leaders
from flockenv.parameters import FlockParameters

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["ComparisonReport", "report"]


@dataclass(frozen=True, slots=True)
class ComparisonReport:
    """Means of a comparison by policy and number of leaders, and the fitted lines.

    Attributes
    ----------
    scene : FlockParameters
        What was run, but for the number of leaders.
    means : pandas.DataFrame
        One row for each policy and number of leaders.
    lines : dict
        The line for each (policy, quantity), over all its runs and those without leaders.
    """

    scene: FlockParameters
    means: "pd.DataFrame"
    lines: dict[tuple[str, str], Line]

    def title(self) -> str:
        """Return what was run, in one line."""
        scene = self.scene
        return (
            f"{scene.n_boats} boats, pool {scene.pool}, bw = {scene.bw_s:g} s, "
            f"target {scene.target}, {scene.scheme} + {scene.noise}"
        )

    def table(self) -> Table:
        """Return the means as a table for the terminal."""
        table = Table(title=self.title(), title_justify="left", caption_justify="left")
        table.caption = (
            f"means over {self.means['runs'].max()} runs with {CONFIDENCE:.0%} intervals"
        )
        for column in ("policy", "leaders", "Ψ_o", "signed order"):
            table.add_column(column, no_wrap=True)
        for row in self.means.to_dict("records"):
            cells = [
                f"{row[q]:6.3f} [{row[f'{q}_low']:6.3f}, {row[f'{q}_high']:6.3f}]"
                for q in QUANTITIES
            ]
            table.add_row(row["policy"], str(row["leaders"]), *cells)
        return table

    def lines_in_words(self) -> str:
        """Return the fitted lines, one a row of text."""
        names = {"psi_o": "Ψ_o", "signed_order": "signed order"}
        return "\n".join(
            f"{policy}: {names[quantity]} = {line}"
            for (policy, quantity), line in self.lines.items()
        )


def report(
    scene: FlockParameters,
    leaders: Sequence[int],
    seeds: Sequence[int],
    duration_s: float,
    folder: Path,
    progress: Callable[[float], None],
) -> ComparisonReport:
    """Run a comparison of every policy and write its files.

    Writes ``runs.csv``, ``means.csv``, ``lines.csv``, ``leader_curve.png`` and
    ``parameters.toml`` into `folder`.

    Raises
    ------
    ParameterError
        For parameters and durations out of range; nothing is written then.
    MissingExtraError
        Without the extra ``plot``.
    """
    from flockenv.figures import leader_curve

    runs = compare_leaders(scene, leaders, list(POLICIES), seeds, duration_s, progress)
    means = summarise(runs, ["policy", "leaders"], list(QUANTITIES))
    lines = {}
    for policy in POLICIES:
        own = runs[runs["policy"].isin([policy, NO_LEADERS])]
        for quantity in QUANTITIES:
            lines[policy, quantity] = fit_line(own["leaders"], own[quantity])
    result = ComparisonReport(scene, means, lines)
    folder.mkdir(parents=True, exist_ok=True)
    runs.to_csv(folder / "runs.csv", index=False)
    means.to_csv(folder / "means.csv", index=False)
    _lines_csv(lines, folder / "lines.csv")
    header = f"# flockenv {__version__}, seeds {seeds[0]} to {seeds[-1]}, {duration_s:g} s each\n"
    (folder / "parameters.toml").write_text(header + scene.to_toml(), encoding="utf-8")
    leader_curve(runs, means, lines, result.title(), folder / "leader_curve.png")
    return result


def _lines_csv(lines: dict[tuple[str, str], Line], path: Path) -> None:
    rows = ["policy,quantity,slope,intercept,f,p,runs"]
    for (policy, quantity), line in lines.items():
        numbers = (line.slope, line.intercept, line.f, line.p, line.n)
        rows.append(",".join([policy, quantity, *map(str, numbers)]))
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
