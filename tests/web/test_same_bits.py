"""Law: a flock has the same bits in WebAssembly as in the native build."""

import base64

import numpy as np
import pytest

import flockenv
from flockenv.policies.names import LAWS

pytestmark = pytest.mark.live

MINUTE_S = 60.0


def numbers(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), np.float64).reshape(-1, 3)


@pytest.mark.parametrize(
    ("policy", "changes"),
    [
        *((name, {}) for name in LAWS),
        # A policy of its own for each leader; one of them mirrors a counter-clockwise target.
        ("learned,paper's law,tuned law", {"target": "ccw"}),
        ("paper's law at every substep", {"scheme": "moreau", "noise_scheme": "per-step"}),
        (
            "paper's law at every substep",
            {"pool": "narrow", "speed_spread_cm_s": 1.0, "current_gain": 0.1},
        ),
    ],
)
def test_a_minute_of_27_boats_with_leaders(policy, changes, answer_of_node, wasm):
    fields = {"n_boats": 27, "n_leaders": 3, "bw_s": 0.3, **changes}
    parameters = flockenv.FlockParameters(**fields)
    each = {f"leader_{k}": name for k, name in enumerate(policy.split(","))}
    native = flockenv.simulate(parameters, 7, MINUTE_S, policy=each if len(each) > 1 else policy)
    request = {"parameters": fields, "seed": "7", "leaders": policy}
    question = {"wasm": str(wasm), "runs": [{"request": request, "samples": round(10 * MINUTE_S)}]}
    (end,) = answer_of_node(question, "tests/web/run_core.mjs")
    assert end["samples"] == len(native)
    assert np.array_equal(numbers(end["pose"]), native.pose[-1])
    assert np.array_equal(numbers(end["velocity"]), native.velocity[-1])
