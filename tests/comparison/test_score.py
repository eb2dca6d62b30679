"""Law: a score is the mean of a policy's flocks, and its gain is measured flock by flock.

On paper: orders of 0.1, 0.2 and 0.3 have the mean 0.2, with the standard error 0.1/√3 and Student's
quantile 4.303. A policy that is ahead by 0.1 in each flock gains 0.1 without any scatter.
"""

import math

import numpy as np
import pytest

import flockenv
from flockenv.comparison import compare_leaders, run_episodes, score_policies
from flockenv.comparison.score import SCORE

pytest.importorskip("pandas")
ORDERS = {"mine": np.array([0.2, 0.3, 0.4]), "tuned law": np.array([0.1, 0.2, 0.3])}


def test_three_flocks_on_paper():
    found = score_policies(ORDERS, "tuned law").set_index("policy")
    assert list(found) == list(SCORE)
    half = 4.3027 * 0.1 / math.sqrt(3)
    mine = found.loc["mine", ["flocks", "signed_order", "low", "high"]].to_list()
    assert mine == pytest.approx([3, 0.3, 0.3 - half, 0.3 + half], abs=1e-5)
    assert found.loc["mine", ["gain", "gain_low", "gain_high"]].to_list() == pytest.approx(
        [0.1] * 3
    )
    assert found.loc["tuned law", ["gain", "gain_low", "gain_high"]].isna().all()


def test_a_gain_is_of_pairs_and_not_of_means():
    """Flocks differ by up to 1, the policies by about 0.1 in each."""
    luck = np.linspace(-0.5, 0.5, 40)
    ahead = 0.1 + 0.001 * np.cos(np.arange(40))
    orders = {"law": luck, "mine": luck + ahead, "others": (luck + ahead)[::-1]}
    gains = score_policies(orders, "law").set_index("policy")
    widths = gains["gain_high"] - gains["gain_low"]
    assert widths["mine"] < 0.001
    assert widths["others"] > 0.2
    assert gains.loc["mine", "gain"] == pytest.approx(gains.loc["others", "gain"])


def test_without_a_reference_there_are_no_gains():
    found = score_policies(ORDERS)
    assert found["policy"].tolist() == ["mine", "tuned law"]
    assert found[["gain", "gain_low", "gain_high"]].isna().all(axis=None)
    assert not found[["signed_order", "low", "high"]].isna().any(axis=None)


def test_episodes_are_scored_as_a_comparison_does():
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="narrow")
    laws = {
        "damped law": flockenv.policies.DampedLaw(),
        "straight": flockenv.policies.StraightAhead(),
    }
    orders = {
        name: run_episodes(parameters, law, range(4), 20.0)["signed_order"]
        for name, law in laws.items()
    }
    found = score_policies(orders, "straight").set_index("policy")
    runs = compare_leaders(parameters, [2], laws, range(4), 20.0)
    means = runs.groupby("policy")["signed_order"].mean()
    assert found["signed_order"].to_dict() == pytest.approx(means.to_dict())


@pytest.mark.parametrize(
    ("orders", "reference", "error", "words"),
    [
        (
            ORDERS,
            "tuned",
            flockenv.ParameterError,
            "'tuned' is not a policy of these: .*'tuned law'",
        ),
        (
            {"a": [0.1, 0.2], "b": [0.1]},
            "b",
            flockenv.ParameterError,
            "2 and 1 values are not pairs",
        ),
        ({"a": []}, None, flockenv.ParameterError, "no values to average"),
        ({"a": [[0.1]]}, None, flockenv.ParameterError, r"orders\['a'\] has shape"),
        ([0.1, 0.2], None, TypeError, "orders must be a dictionary"),
    ],
)
def test_what_is_no_score_is_refused(orders, reference, error, words):
    with pytest.raises(error, match=words):
        score_policies(orders, reference)
