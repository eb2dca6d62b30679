"""The summary of a report in Markdown: key figures and the table of claims."""

from collections import Counter
from collections.abc import Sequence

from flockenv import _core
from flockenv.analysis import CONFIDENCE
from flockenv.reproduce.catalogue import ALL, resolve
from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, INCONCLUSIVE, CheckedClaim, number
from flockenv.reproduce.reproduction import Outcome, Reproduction, Settings
from flockenv.run_store import RESULTS_VERSION
from flockenv.runs import RunSpec

__all__ = ["KEY_FIGURES", "command", "markdown_summary"]

KEY_FIGURES = ("fig9", "fig12", "fig14", "fig17")
"""The figures shown, as far as they are there: two of the experiment, two of the simulation."""


def markdown_summary(
    settings: Settings,
    finished: Sequence[tuple[Reproduction, Sequence[RunSpec], Outcome]],
    pictures: str = "{name}/{name}.png",
) -> str:
    """Return the page; `pictures` tells where it finds the picture of a name."""
    hours = sum({spec.key: spec.duration_s for _, specs, _ in finished for spec in specs}.values())
    minutes = settings.minutes
    length = "of the paper's own length" if minutes is None else f"of {minutes:g} min"
    lines = [
        "# The paper's figures and claims, reproduced",
        "",
        f"Written by `{command(settings, finished)}` of flockenv {_core.__version__} (results "
        f"version {RESULTS_VERSION}); runs {length}, {hours / 3600:.0f} hours of flock time, first "
        f"seed {settings.seed}. A claim holds if the {CONFIDENCE:.0%} interval of the measured "
        "quantity lies in the claimed range, does not hold if it lies outside, and is inconclusive "
        "otherwise; the ranges stand in the code and were settled before the runs.",
        "",
    ]
    claims = [claim for _, _, outcome in finished for claim in outcome.claims]
    counts = Counter(claim.verdict for claim in claims)
    lines += [
        f"Of {len(claims)} claims, one counted for each preset and setup it was measured with, "
        f"{counts[HOLDS]} hold, {counts[DOES_NOT_HOLD]} do not hold, and {counts[INCONCLUSIVE]} "
        "are inconclusive.",
        "",
    ]
    for figure, _, _ in finished:
        if figure.name in KEY_FIGURES:
            lines += [f"![{figure.title}]({pictures.format(name=figure.name)})", ""]
            lines += [f"{figure.name}: {figure.title}.", ""]
    for figure, _, outcome in finished:
        lines += [f"## {figure.name}: {figure.title}", ""]
        lines += [line for note in outcome.notes for line in (note, "")]
        if outcome.claims:
            lines += [*_claims(outcome.claims), ""]
        for name in outcome.shown:
            table = outcome.tables[name]
            rows: list[Sequence[object]] = [list(table.columns), *table.to_numpy().tolist()]
            lines += [*_table(rows), ""]
    return "\n".join(lines)


def command(
    settings: Settings,
    finished: Sequence[tuple[Reproduction, Sequence[RunSpec], Outcome]],
) -> str:
    """Return the command that does this again."""
    names = [figure.name for figure, _, _ in finished]
    rest = [name for name in names if name not in resolve([ALL])]
    words = ["flockenv reproduce", ALL, *rest, f"--seed {settings.seed}"]
    if settings.minutes is not None:
        words.append(f"--minutes {settings.minutes:g}")
    if rest:
        words.append(f"--budget {settings.budget_core_min:g}")
    return " ".join(words)


def _claims(claims: Sequence[CheckedClaim]) -> list[str]:
    rows = [["claim", "section", "for", "quantity", "claimed", "measured", "interval", "verdict"]]
    for checked in claims:
        claim = checked.claim
        rows.append(
            [
                claim.text + (f" ({checked.note})" if checked.note else ""),
                claim.section,
                checked.scope,
                claim.quantity,
                claim.accepted,
                number(checked.measured),
                checked.ends,
                f"**{checked.verdict}**",
            ]
        )
    return _table(rows)


def _table(rows: Sequence[Sequence[object]]) -> list[str]:
    lines = [
        "| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows
    ]
    return [lines[0], "| --- " * len(rows[0]) + "|", *lines[1:]]
