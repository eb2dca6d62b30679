"""One HTML page of all that was reproduced, complete in itself: a person can open and send it."""

import base64
import platform
from collections.abc import Mapping, Sequence
from html import escape
from importlib.metadata import version
from typing import Any

from flockenv import _core
from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim, number
from flockenv.reproduce.files import picture_bytes
from flockenv.reproduce.reproduction import Outcome, Reproduction, Settings
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RESULTS_VERSION
from flockenv.statistics.intervals import CONFIDENCE

__all__ = ["html_report"]

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-size: 14px; margin: 1rem 0; }
th, td { border-bottom: 1px solid #ccc; padding: .25rem .6rem; text-align: left; }
td { vertical-align: top; }
.holds { color: #00694d; font-weight: 600; }
.not { color: #a34700; font-weight: 600; }
.open { color: #555; font-weight: 600; }
figure { display: inline-block; margin: 1rem 1rem 1rem 0; }
img { width: 28rem; max-width: 100%; }
"""


def html_report(
    settings: Settings,
    finished: Sequence[tuple[Reproduction, Sequence[RunSpec], Outcome]],
) -> str:
    """Return the page: claims first, then each figure with what was run, then versions."""
    claims = [claim for _, _, outcome in finished for claim in outcome.claims]
    parts = [
        "<h1>Patterns and transitions in a school of boats, reproduced</h1>",
        "<p>Figures and claims of Tarcai et al., <i>Patterns, transitions and the role of leaders "
        "in the collective dynamics of a simple robotic flock</i> (2011), measured with flockenv "
        f"{escape(_core.__version__)}. A claim is stated as a range of a measured quantity: it "
        f"holds if the whole {CONFIDENCE:.0%} interval lies inside, does not hold if all of it "
        "lies outside, and is inconclusive otherwise. Ranges were fixed before the runs.</p>",
        "<h2>Claims</h2>",
        _claims(claims) if claims else "<p>None of these figures has one.</p>",
    ]
    parts += [_section(*each) for each in finished]
    parts += ["<h2>Versions</h2>", _table([["", ""], *map(list, _versions(settings).items())])]
    body = "\n".join(parts)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>flockenv reproduce</title><style>{_STYLE}</style></head>\n<body>\n{body}\n"
        "</body></html>\n"
    )


def _section(reproduction: Reproduction, specs: Sequence[RunSpec], outcome: Outcome) -> str:
    parts = [f"<h2>{escape(reproduction.name)}: {escape(reproduction.title)}</h2>"]
    parts.append(f"<p>Section {escape(reproduction.section)} of the paper.</p>")
    for name, figure in outcome.pictures.items():
        data = base64.b64encode(picture_bytes(figure, "png")).decode()
        image = f'<img alt="{escape(name)}" src="data:image/png;base64,{data}">'
        caption = escape(outcome.captions.get(name, name))
        parts.append(f"<figure>{image}<figcaption>{caption}</figcaption></figure>")
    parts += [f"<p>{escape(note)}</p>" for note in outcome.notes]
    if outcome.claims:
        parts.append(_claims(outcome.claims))
    for name in outcome.shown:
        table = outcome.tables[name]
        rows = [list(table.columns), *table.to_numpy().tolist()]
        parts.append(_table([[escape(str(cell)) for cell in row] for row in rows]))
    parts += ["<details><summary>What was run</summary>", _runs(specs), "</details>"]
    return "\n".join(parts)


def _claims(claims: Sequence[CheckedClaim]) -> str:
    head = ["claim", "section", "for", "measured", "interval", "claimed range", "verdict"]
    rows = [head]
    for checked in claims:
        claim = checked.claim
        kind = {HOLDS: "holds", DOES_NOT_HOLD: "not"}.get(checked.verdict, "open")
        note = f"<br><small>{escape(checked.note)}</small>" if checked.note else ""
        rows.append(
            [
                escape(claim.text) + note,
                escape(claim.section),
                escape(checked.scope),
                f"{number(checked.measured)}<br><small>{escape(claim.quantity)}</small>",
                checked.ends,
                escape(claim.accepted),
                f'<span class="{kind}">{checked.verdict}</span>',
            ]
        )
    return _table(rows)


def _runs(specs: Sequence[RunSpec]) -> str:
    if not specs:
        return "<p>Nothing.</p>"
    plain = [_plain(spec) for spec in specs]
    names = list(plain[0])
    values: Mapping[str, list[Any]] = {
        name: list(dict.fromkeys(str(each[name]) for each in plain)) for name in names
    }
    hours = sum(spec.duration_s for spec in specs) / 3600
    rows = [["field", "values"]]
    rows += [[escape(name), escape(", ".join(values[name]))] for name in names]
    return f"<p>{len(specs)} runs, {hours:.3g} hours of flock time.</p>" + _table(rows)


def _plain(spec: RunSpec) -> dict[str, Any]:
    rest = ("seed", "duration_s", "sample_hz", "protocol", "keep")
    return {name: getattr(spec, name) for name in rest} | spec.parameters.to_dict()


def _versions(settings: Settings) -> dict[str, str]:
    packages = ("numpy", "scipy", "pandas", "pyarrow", "matplotlib")
    length = "the paper's" if settings.minutes is None else f"{settings.minutes:g} minutes"
    return {
        "flockenv": f"{_core.__version__}, results version {RESULTS_VERSION}",
        "Python": platform.python_version(),
        **{name: version(name) for name in packages},
        "machine": f"{platform.system()} {platform.machine()}",
        "first seed": str(settings.seed),
        "length of a run": length,
    }


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Return a table of cells that are HTML already; the first row is its head."""
    head = "".join(f"<th>{cell}</th>" for cell in rows[0])
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows[1:])
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
