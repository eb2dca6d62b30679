"""Law: the leaders that ship are those that led best in the validation flocks."""

from pathlib import Path

import pandas as pd
import pytest

import flockenv
from flockenv.runs.seeds import release_seeds

RESULTS = Path(__file__).parent / "results" / "pretrained"


def scores(pool: str) -> pd.Series:
    return pd.read_csv(RESULTS / f"validation-{pool}.csv", index_col="policy")["score"]


def test_the_shipped_leaders_led_best() -> None:
    named = flockenv.policies.load("learned", pool="wide")
    assert scores("wide").idxmax() == f"seed {named.provenance['seed']}"
    assert named.provenance["command"] == "python baselines/pretrained.py --pool wide"
    seeds = release_seeds("pretrained", 512)
    assert named.judged["seeds"] == [seeds[0], seeds[-1]]


def test_the_shipped_leaders_were_judged_as_their_training() -> None:
    named = flockenv.policies.load("learned", pool="wide")
    judged = pd.read_csv(RESULTS / "evaluation.csv", index_col="policy")
    found = judged.loc[f"seed {named.provenance['seed']}", "signed_order"]
    # Each was judged in 512 flocks of its own.
    assert found == pytest.approx(named.judged["signed_order"], abs=0.05)


def test_no_search_in_narrow_passes_the_tuned_law() -> None:
    assert scores("narrow").idxmax() == "tuned law"
