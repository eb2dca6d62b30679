"""What a claim hangs on follows from its four verdicts."""

import pandas as pd
import pytest

from flockenv.reproduce.catalogue import load, resolve
from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, INCONCLUSIVE
from flockenv.reproduce.report import html_report
from flockenv.reproduce.reproduction import Outcome, Settings
from flockenv.reproduce.simulation.table import dependence, statements
from flockenv.reproduce.summary import command, markdown_summary

READINGS = (
    "paper scheme, per-step noise",
    "paper scheme, white noise",
    "leapfrog, per-step noise",
    "leapfrog, white noise",
)
VERDICTS = {"+": HOLDS, "-": DOES_NOT_HOLD, "?": INCONCLUSIVE}


@pytest.mark.parametrize(
    ("signs", "words"),
    [
        ("++++", "whatever the scheme and the noise"),
        ("++--", "only with the paper's scheme"),
        ("+-+-", "only with the paper's noise convention"),
        ("+---", "only with the paper's scheme and noise together"),
        ("----", "holds with no reading"),
        ("+--+", "holds with both presets"),
        ("+++?", "inconclusive with leapfrog, white noise"),
        ("+?--", "inconclusive with paper scheme, white noise"),
    ],
)
def test_the_conclusion(signs: str, words: str) -> None:
    verdicts = {name: VERDICTS[sign] for name, sign in zip(READINGS, signs, strict=True)}
    assert words in dependence(verdicts)


def test_the_statements_name_every_claim_once() -> None:
    rows = []
    for claim, signs in (("a", "++++"), ("b", "+--+"), ("c", "+-+-"), ("d", "+?--")):
        verdicts = {name: VERDICTS[sign] for name, sign in zip(READINGS, signs, strict=True)}
        row = {"claim": claim, "pool": "table-1", **verdicts, "conclusion": dependence(verdicts)}
        rows.append(row)
    said = statements(pd.DataFrame(rows))
    assert said == [
        "Pool table-1: 2 of 4 claims hold with both presets, paper and simulation: a; b.",
        "Pool table-1: 1 of 4 claims hold only with the paper's noise convention: c.",
        "Pool table-1: 1 of 4 claims are inconclusive with some reading, or depend on no single "
        "choice: d.",
    ]


def test_the_summary_reports_the_command_that_made_it() -> None:
    names = [*resolve(["all"]), "transition-order"]
    finished = [(load(name), [], Outcome({})) for name in names]
    words = "flockenv reproduce all transition-order --seed 3 --minutes 2 --budget 7"
    assert command(Settings(3, 2.0, 7.0), finished) == words
    assert command(Settings(), finished[:-1]) == "flockenv reproduce all --seed 0"
    few = f"flockenv reproduce {names[2]} {names[0]} --seed 0"
    assert command(Settings(), [finished[2], finished[0]]) == few
    assert f"`{words}`" in markdown_summary(Settings(3, 2.0, 7.0), finished)


def test_tables_are_shown_in_full() -> None:
    settings = Settings()
    table = pd.DataFrame({"claim": ["a | b"], "conclusion": ["holds <always>"]})
    outcome = Outcome({"found": table, "rest": table}, shown=["found"])
    figure = load("scheme-and-noise")
    page = html_report(settings, [(figure, [], outcome)])
    assert page.count("holds &lt;always&gt;") == 1
    assert "| a \\| b | holds <always> |" in markdown_summary(settings, [(figure, [], outcome)])
