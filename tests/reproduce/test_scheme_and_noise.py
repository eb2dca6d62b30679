"""What a claim hangs on follows from its four verdicts."""

import pandas as pd
import pytest

from flockenv.reproduce.catalogue import load
from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, INCONCLUSIVE
from flockenv.reproduce.report import html_report
from flockenv.reproduce.reproduction import Outcome, Settings
from flockenv.reproduce.simulation_table import dependence
from flockenv.reproduce.summary import markdown_summary

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
        ("----", "holds with none"),
        ("+--+", "holds with both presets"),
        ("+++?", "inconclusive with leapfrog, white noise"),
        ("+?--", "inconclusive with paper scheme, white noise"),
    ],
)
def test_the_conclusion(signs: str, words: str) -> None:
    verdicts = {name: VERDICTS[sign] for name, sign in zip(READINGS, signs, strict=True)}
    assert words in dependence(verdicts)


def test_tables_are_shown_in_full() -> None:
    settings = Settings()
    table = pd.DataFrame({"claim": ["a | b"], "conclusion": ["holds <always>"]})
    outcome = Outcome({"found": table, "rest": table}, shown=["found"])
    figure = load("scheme-and-noise")
    page = html_report(settings, [(figure, [], outcome)])
    assert page.count("holds &lt;always&gt;") == 1
    assert "| a \\| b | holds <always> |" in markdown_summary(settings, [(figure, [], outcome)])
