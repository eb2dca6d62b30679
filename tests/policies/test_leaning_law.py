"""LeaningLaw: the damped law about a heading leaned outward by what is seen.

On paper: forward, with a gain g, a lean of b and a leader that heads along the target's tangent,
the rudder is g·1.2·tanh(b/1.2): it turns counter-clockwise, outward, while it moves clockwise.
"""

import copy
import json
import math
import pickle

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries
from flockenv.policies import DampedLaw, LeaningLaw, load
from flockenv.policies.laws import LEAN_FEATURES

GAINS = {"gain": 0.5, "backward_gain": 2.0, "damping": 9.0}
OWN = len(observation_entries(LeaningLaw("wide", 0.0, {}).observation)) - len(LEAN_FEATURES)


def row(**features: float) -> np.ndarray:
    """An observation of a forward leader on the tangent, with some standardized features."""
    names = [entry.name for entry in observation_entries(LeaningLaw("wide", 0.0, {}).observation)]
    found = np.zeros(len(names), np.float32)
    for name, value in {"sin_orientation": 1.0, "forward_velocity": 0.5}.items():
        found[names[:OWN].index(name)] = value
    for name, value in features.items():
        found[OWN + LEAN_FEATURES.index(name)] = value
    return found


def visited(law: LeaningLaw, pool: str = "narrow", **options) -> np.ndarray:
    env = flockenv.LeadersVectorEnv(
        4,
        n_boats=27,
        n_leaders=3,
        pool=pool,
        target="random",
        mirror_to_target=True,
        observation=law.observation,
        **options,
    )
    rows, _ = env.reset(seed=1)
    seen = [rows]
    for _ in range(100):
        rows, *_ = env.step(law.predict(rows)[0])
        seen.append(rows)
    return np.concatenate(seen)


def random_law(pool: str = "narrow", **options) -> LeaningLaw:
    numbers = np.random.default_rng(0).normal(0.0, 0.1, len(LEAN_FEATURES))
    return LeaningLaw(pool, 0.1, dict(zip(LEAN_FEATURES, numbers, strict=True)), **options)


def test_without_weights_it_is_the_damped_law():
    law = LeaningLaw("narrow", 0.0, {}, gains=GAINS)
    rows = visited(law)
    damped = DampedLaw(**GAINS, observation=law.observation, mirror_to_target=True)
    expected = damped.predict(rows)[0]
    assert (np.abs(expected) < 1).mean() > 0.3
    assert law.predict(rows)[0].tobytes() == expected.tobytes()
    assert LeaningLaw("narrow", 0.0, {}).gains == DampedLaw.tuned("narrow").gains


@pytest.mark.parametrize("features", [{}, {"near": 2.0}, {"near": -1.0, "fw": 0.5}])
@pytest.mark.parametrize("bound", ["tanh", "clip"])
def test_how_far_it_leans(features, bound):
    weights = {"near": 0.3, "fw": -2.0}
    lean = 0.2 + sum(weights[name] * value for name, value in features.items())
    bounded = 1.2 * math.tanh(lean / 1.2) if bound == "tanh" else max(-1.2, min(1.2, lean))
    law = LeaningLaw("wide", 0.2, weights, gains=GAINS, bound=bound)
    rudder = law.predict(row(**features))[0]
    assert rudder == pytest.approx(0.5 * bounded, abs=1e-6)


def test_a_file_keeps_every_bit(tmp_path):
    judged = {
        "signed_order": 0.4,
        "interval": [0.3, 0.5],
        "n_boats": 27,
        "n_leaders": 3,
        "bw_s": 0.45,
        "episode_s": 480.0,
        "seeds": [512, 1023],
    }
    law = random_law(gains=GAINS, judged=judged, provenance={"seed": "3"})
    law.save(tmp_path / "law.json")
    rows = visited(law)
    for again in (
        load(tmp_path / "law.json"),
        pickle.loads(pickle.dumps(law)),
        copy.deepcopy(law),
        LeaningLaw.from_json(law.to_json()),
    ):
        assert law.predict(rows)[0].tobytes() == again.predict(rows)[0].tobytes()
        assert (again.judged, again.provenance) == (judged, {"seed": "3"})
        assert (again.law, again.digest, repr(again)) == (law.law, law.digest, repr(law))
        assert (again.weights, again.bias, again.pool) == (law.weights, 0.1, "narrow")
    assert random_law(gains=GAINS).digest == law.digest
    assert random_law().digest != law.digest


def text(change) -> str:
    values = json.loads(random_law().to_json())
    change(values)
    return json.dumps(values)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda law: law["weights"].pop("near"), "weights lack near"),
        (lambda law: law["weights"].update(far=1.0), '"far", which is no lean feature'),
        (lambda law: law["weights"].update(near=math.nan), "expected value"),
        (lambda law: law["weights"].update(near="1"), "invalid type: string"),
        (lambda law: law["weights"].update(near=1e12), "near = 1000000000000"),
        (lambda law: law.update(weights=[0.1] * 29), "invalid type: sequence"),
        (lambda law: law.update(format=2), "this version of flockenv reads format 1"),
        (lambda law: law.pop("format"), "missing field `format`"),
        (lambda law: law.update(code="import os"), "unknown field `code`"),
        (lambda law: law.update(pool="bath"), "standardized only in the pools wide and narrow"),
        (lambda law: law.update(bound="relu"), "unknown variant `relu`"),
        (lambda law: law["gains"].pop("gain"), "missing field `gain`"),
        (lambda law: law.update(decision_period_s=-1.0), "decision_period_s = -1"),
        (lambda law: law.update(gains=GAINS, decision_period_s=1.0), "none, unless the gains are"),
        (lambda law: law.update(judged={"signed_order": 0.5}), "missing field `interval`"),
    ],
)
def test_damaged_files_are_named(tmp_path, change, message):
    path = tmp_path / "law.json"
    path.write_text(text(change))
    with pytest.raises(flockenv.ParameterError) as raised:
        load(path)
    assert str(raised.value).startswith(f"{path} is not a complete policy: ")
    assert message in str(raised.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "EOF"),
        (b"cos\nsystem\n(S'true'\ntR.", "expected value"),
        (b"\x80\x04\x95", "utf-8"),
        (b"[" * 100_000, "invalid type: sequence"),
        (b" " * (1 << 20) + b"{}", "is not a policy: it is larger than"),
        (b'{"format": 1e999}', "number out of range"),
    ],
)
def test_other_content_is_refused_and_nothing_in_it_is_executed(tmp_path, content, message):
    path = tmp_path / "law.json"
    path.write_bytes(content)
    with pytest.raises(flockenv.ParameterError, match=message):
        load(path)


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (("wide", math.nan, {}), {}, "not JSON compliant"),
        (("wide", 0.0, {"near": math.inf}), {}, "not JSON compliant"),
        (("wide", 0.0, {"far": 1.0}), {}, "no lean feature"),
        (("bath", 0.0, {}), {}, "pools wide and narrow"),
        (("bath", 0.0, {}), {"gains": GAINS}, "pools wide and narrow"),
        (("wide", 0.0, {}), {"gains": {"gain": 1.0}}, "missing field `backward_gain`"),
        (("wide", "many", {}), {}, "invalid type"),
        (("wide", {1, 2}, {}), {}, "is not a number"),
    ],
)
def test_bad_numbers(arguments, options, message):
    with pytest.raises(flockenv.ParameterError, match=message):
        LeaningLaw(*arguments, **options)


def test_learned_leaders_lead_better_than_the_papers() -> None:
    """By half as much again, where measured."""
    bw_s = flockenv.FlockParameters.critical_bw_s("simulation", "wide")
    parameters = flockenv.FlockParameters(n_boats=27, n_leaders=3, pool="wide", bw_s=bw_s)
    differences = []
    for seed in range(32):
        ours, papers = (
            flockenv.simulate(parameters, seed, 240.0, policy=name).analyzed().order
            for name in ("learned", "paper's law")
        )
        differences.append(ours.signed_order("cw").mean() - papers.signed_order("cw").mean())
    assert np.mean(differences) > 3 * np.std(differences, ddof=1) / np.sqrt(len(differences))
