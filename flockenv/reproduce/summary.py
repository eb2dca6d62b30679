"""The summary of a report in Markdown: key figures and the table of claims."""

from collections import Counter
from collections.abc import Sequence

from flockenv import _core
from flockenv.reproduce.catalogue import ALL, BUDGETED, resolve
from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, INCONCLUSIVE, CheckedClaim, number
from flockenv.reproduce.reproduction import Outcome, Reproduction, Settings
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RESULTS_VERSION
from flockenv.statistics.intervals import CONFIDENCE

__all__ = [
    "CLAIMS",
    "KEY_FIGURES",
    "Finished",
    "command",
    "data_tables",
    "markdown_summary",
    "shown_pictures",
]

CLAIMS = "claims"
"""Name of the table of claims."""

KEY_FIGURES = ("fig9", "fig12", "fig14", "fig17")
"""The figures shown for `all`: two of the experiment, two of the simulation."""

Finished = Sequence[tuple[Reproduction, Sequence[RunSpec], Outcome]]
"""Finished reproductions: each with its runs and its outcome."""


def markdown_summary(
    settings: Settings,
    finished: Finished,
    folder: str | None = None,
) -> str:
    """Return the page; its pictures and data are in a folder, or by figure in those of results."""
    hours = sum({spec.key: spec.duration_s for _, specs, _ in finished for spec in specs}.values())
    minutes = settings.minutes
    own = "of the lengths given below" if _is_beyond(finished) else "of the paper's own length"
    length = own if minutes is None else f"of {minutes:g} min"
    claims = [claim for _, _, outcome in finished for claim in outcome.claims]
    counts = Counter(claim.verdict for claim in claims)
    lines = [
        f"# {_title(finished)}",
        "",
        "A claim counts once for each preset and setup that it was measured with. Of "
        f"{len(claims)} claims, {counts[HOLDS]} hold, {counts[DOES_NOT_HOLD]} do not hold, and "
        f"{counts[INCONCLUSIVE]} are inconclusive.",
        "",
        f"`{command(settings, finished)}` of flockenv {_core.__version__} (results version "
        f"{RESULTS_VERSION}) wrote this page. Its runs are {length} and add up to "
        f"{hours / 3600:.0f} hours of flock time; their first seed is {settings.seed}. "
        f"A claim holds if the {CONFIDENCE:.0%} interval of the measured quantity lies in the "
        "claimed range, does not hold if it lies outside, and is inconclusive otherwise. The "
        "ranges stand in the code and were fixed before these runs. Verdicts are not corrected for "
        "the number of claims.",
        "",
    ]
    for figure, picture, caption in shown_pictures(finished):
        lines += [f"![{caption}]({folder or figure.name}/{picture}.png)", ""]
        lines += [f"{figure.name}: {caption}.", ""]
    for figure, _, outcome in finished:
        lines += [f"## {figure.name}: {figure.title}", ""]
        lines += [line for note in outcome.notes for line in (note, "")]
        if outcome.claims:
            lines += [*_claims(outcome.claims), ""]
        for name in outcome.shown:
            table = outcome.tables[name]
            rows: list[Sequence[object]] = [list(table.columns), *table.to_numpy().tolist()]
            lines += [*_table(rows), ""]
    if folder is not None and (data := data_tables(finished)):
        links = ", ".join(f"[{name}.csv]({folder}/{name}.csv)" for _, name in data)
        lines += [f"The numbers of this page are in {links}.", ""]
    return "\n".join(lines)


def data_tables(finished: Finished) -> list[tuple[Reproduction, str]]:
    """Return the tables that go along with the page of a single figure, `CLAIMS` first."""
    if len(finished) != 1:
        return []
    figure, _, outcome = finished[0]
    claims = [CLAIMS] if outcome.claims else []
    return [(figure, name) for name in (*claims, *outcome.shown, *outcome.data)]


def shown_pictures(finished: Finished) -> list[tuple[Reproduction, str, str]]:
    """Return figure, picture and caption: the key ones for `all`, otherwise every one."""
    return [
        (figure, picture, outcome.captions.get(picture, figure.title))
        for figure, _, outcome in finished
        for picture in outcome.pictures
        if figure.name in KEY_FIGURES or not _is_all(finished)
    ]


def command(settings: Settings, finished: Finished) -> str:
    """Return the command that does this again."""
    names = [figure.name for figure, _, _ in finished]
    if _is_all(finished):
        names = [ALL, *(name for name in names if name not in resolve([ALL]))]
    words = ["flockenv reproduce", *names, f"--seed {settings.seed}"]
    if settings.minutes is not None:
        words.append(f"--minutes {settings.minutes:g}")
    if not set(names).isdisjoint(BUDGETED):
        words.append(f"--budget {settings.budget_core_min:g}")
    return " ".join(words)


def _is_all(finished: Finished) -> bool:
    return {figure.name for figure, _, _ in finished} >= set(resolve([ALL]))


def _is_beyond(finished: Finished) -> bool:
    return all(figure.name in BUDGETED for figure, _, _ in finished)


def _title(finished: Finished) -> str:
    if len(finished) == 1 and not _is_all(finished):
        return finished[0][0].title
    return "The paper's figures and claims, reproduced"


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
