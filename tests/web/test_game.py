"""Law: in the page's game a hand that does nothing loses against the law, one that leads well wins.

A round has three flocks of five minutes each, as its link says. They have the law's own starts.
"""

import numpy as np
import pytest

pytestmark = pytest.mark.live

ROUNDS = 100


@pytest.fixture(scope="module")
def scores(answer_of_node, wasm) -> dict[str, np.ndarray]:
    question = {"wasm": str(wasm), "rounds": ROUNDS}
    answer = answer_of_node(question, "tests/web/play_rounds.mjs")
    return {name: np.array(each) for name, each in answer.items()}


@pytest.mark.timeout(600)
def test_who_leads_well_wins_most_rounds_and_nobody_else_does(scores):
    law = scores.pop("the law")
    won = {hand: int((score > law).sum()) for hand, score in scores.items()}
    assert won.pop("of a person") >= 0.7 * ROUNDS, won
    # Hands that do nothing, or hold a key down.
    assert max(won.values()) <= 0.1 * ROUNDS, won
