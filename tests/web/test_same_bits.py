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


def flown(answer_of_node, wasm, heading: float, seconds: float, **fields) -> np.ndarray:
    """Return the last poses of a flock whose leaders head where a visitor says."""
    request = {"parameters": fields, "seed": "7", "leaders": "you"}
    run = {"request": request, "samples": round(10 * seconds), "heading": heading}
    (end,) = answer_of_node({"wasm": str(wasm), "runs": [run]}, "tests/web/run_core.mjs")
    return numbers(end["pose"])


@pytest.mark.parametrize(("target", "heading"), [("cw", 0.5), ("ccw", -0.5)])
def test_a_visitor_who_asks_for_the_tangent_steers_as_the_damped_law(
    answer_of_node, wasm, target, heading
):
    fields = {"n_boats": 27, "n_leaders": 3, "bw_s": 0.3, "target": target}
    native = flockenv.simulate(flockenv.FlockParameters(**fields), 7, MINUTE_S, policy="damped law")
    assert np.array_equal(flown(answer_of_node, wasm, heading, MINUTE_S, **fields), native.pose[-1])


@pytest.mark.parametrize("outward_deg", [60.0, 15.0, -30.0])
def test_a_heading_is_clockwise_from_outward(answer_of_node, wasm, outward_deg):
    fields = {"n_boats": 12, "n_leaders": 3, "bw_s": 0.3}
    gains = flockenv.policies.DampedLaw().gains
    lean = np.radians(outward_deg)
    leaning = flockenv.policies.LeaningLaw("wide", lean, {}, gains=gains, bound="clip")
    native = flockenv.simulate(flockenv.FlockParameters(**fields), 7, 2.0, policy=leaning)
    heading = (90.0 - outward_deg) / 180.0
    pose = flown(answer_of_node, wasm, heading, 2.0, **fields)
    assert np.allclose(pose, native.pose[-1], atol=1e-3)
    other = flown(answer_of_node, wasm, -heading, 2.0, **fields)
    assert not np.allclose(other, native.pose[-1], atol=1.0)
