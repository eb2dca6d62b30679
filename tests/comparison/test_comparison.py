"""Law: what cannot be compared is refused at the door, before a flock moves."""

import numpy as np
import pytest

import flockenv
from flockenv import ParameterError
from flockenv.comparison import compare_leaders, run_episodes
from flockenv.policies import load
from flockenv.runs.seeds import POLICY_SEEDS

LAW, STRAIGHT = {"law": "paper's law"}, {"straight": "straight ahead"}
WIDE = load("learned", pool="wide")
OTHER_POOL = r"'narrow'.*pool = 'wide'"


class Seldom:
    """A policy that decides neither at control steps nor between whole numbers of them."""

    decision_period_s = 0.15

    def predict(self, observation, state=None):
        return np.zeros(len(observation)), state


def options(**environment) -> dict:
    return {"environment": environment}


#: Arguments besides one leader under the paper's law, the error, and its words.
REFUSED = [
    ({"parameters": {}}, TypeError, "parameters must be FlockParameters"),
    ({"leaders": {1, 2}}, TypeError, "leaders must be a sequence"),
    ({"leaders": 2}, TypeError, "leaders must be a sequence"),
    ({"leaders": "12"}, TypeError, "leaders must be a sequence"),
    ({"leaders": [True]}, TypeError, "leaders must be an integer"),
    ({"leaders": [1.5]}, ParameterError, r"leaders = 1\.5 is not accepted: a whole number"),
    ({"leaders": [1, 9]}, ParameterError, "9 leaders among n_boats = 9 .* --n-leaders"),
    ({"leaders": [-1]}, ParameterError, "n_leaders = -1"),
    ({"leaders": []}, ParameterError, "nothing to compare"),
    ({"leaders": [0]}, ParameterError, "nobody to steer"),
    ({"policies": {}}, ParameterError, "nothing to compare"),
    ({"policies": ["paper's law"]}, TypeError, "policies must be a dictionary"),
    ({"policies": zip(["a"], ["law"], strict=True)}, TypeError, "policies must be a dictionary"),
    ({"policies": {"no leaders": "paper's law"}}, ParameterError, "is not a name for a policy"),
    *(
        ({"policies": {"mine": given}}, ParameterError, "policy = .* is not accepted: a policy's")
        for given in (5, {"leader_0": 5}, lambda: 5, np)
    ),
    ({"policies": {"mine": "papers law"}}, ParameterError, "did you mean"),
    ({"policies": {"mine": WIDE}}, ParameterError, OTHER_POOL),
    ({"policies": {"mine": Seldom()}}, ParameterError, "decision_period_s = 0.15"),
    ({"policies": {"mine": {"leader_0": WIDE}}}, ParameterError, OTHER_POOL),
    ({"policies": {"mine": {"leader_1": "damped law"}}}, ParameterError, "each of leader_0"),
    (
        {"policies": {"mine": {"leader_0": "damped law"}}, "leaders": [2]},
        ParameterError,
        "a policy for each of leader_0, leader_1",
    ),
    ({"seeds": 3}, TypeError, "seeds must be a sequence"),
    ({"seeds": {1: 2}}, TypeError, "seeds must be a sequence"),
    ({"seeds": [1, "2"]}, TypeError, "seed must be an integer"),
    ({"seeds": [1, 2, 1]}, ParameterError, "a seed more than once"),
    ({"seeds": [0, -1]}, ParameterError, "for training"),
    ({"seeds": POLICY_SEEDS["training"].seeds(2)}, ParameterError, "for training"),
    ({"duration_s": 0.0}, ParameterError, "episode_s = 0"),
    ({"duration_s": "long"}, TypeError, "episode_s must be a number"),
    ({"progress": None}, TypeError, "progress must be a function"),
    ({"finished": 3}, TypeError, "finished must be a function"),
    ({"environment": ["target"]}, TypeError, "environment must be a dictionary"),
    (options(dropout=0.1), ParameterError, "did you mean 'dropout_rate'"),
    (options(dropout_rate=2.0), ParameterError, "dropout_rate = 2"),
    (options(n_boats=9), ParameterError, "n_boats = 9 is not accepted .* the flock sets it"),
    (options(bw_s=0.9), ParameterError, "bw_s = 0.9 is not accepted"),
    (options(params=None), ParameterError, "the flock sets it"),
    (options(episode_s=9.0), ParameterError, "duration_s sets it"),
    (options(mirror_to_target=True), ParameterError, "a policy sets it"),
    (options(observation={}), ParameterError, "a policy sets it"),
    (options(autoreset_mode="disabled"), ParameterError, "the comparison sets it"),
    (options(reward={"jam": 1.0}), ParameterError, "the comparison sets it"),
    (options(action_mode="lean"), ParameterError, "action_mode 'rudder': not accepted in this"),
    (
        {"leaders": [0, 1], **options(dropout_rate=0.1)},
        ParameterError,
        "'no leaders' .* takes no dropout_rate",
    ),
    (
        {"policies": {"every": "paper's law at every substep"}, **options(dropout_rate=0.1)},
        ParameterError,
        "takes no dropout_rate",
    ),
    (
        {"policies": {"each": {"leader_0": "damped law"}}, **options(decision_period_s=1.0)},
        ParameterError,
        "decision_period_s is not accepted with a policy for each leader",
    ),
]


@pytest.mark.parametrize(("arguments", "error", "words"), REFUSED)
def test_what_cannot_be_compared_is_refused_first(arguments, error, words) -> None:
    parameters = flockenv.FlockParameters.preset("simulation").replace(n_boats=9, pool="narrow")
    seconds: list[float] = []
    given = {"parameters": parameters, "leaders": [1], "policies": LAW, "seeds": [1]}
    given |= {"duration_s": 5.0, "progress": seconds.append, **arguments}
    # What is sound comes first, and does not run either.
    if isinstance(given["policies"], dict) and given["policies"]:
        given["policies"] = {**STRAIGHT, **given["policies"]}
    with pytest.raises(error, match=words):
        compare_leaders(**given)
    assert seconds == []


def test_episodes_have_the_same_door(tmp_path) -> None:
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=1, pool="narrow")
    WIDE.save(tmp_path / "wide.json")
    for given in (WIDE, tmp_path / "wide.json", str(tmp_path / "wide.json")):
        with pytest.raises(ParameterError, match=OTHER_POOL):
            run_episodes(parameters, given, [1], 1.0)
    with pytest.raises(ParameterError, match="with n_leaders = 0 it steers nobody"):
        run_episodes(parameters.replace(n_leaders=0), "paper's law", [1], 1.0)
    with pytest.raises(TypeError, match="parameters must be FlockParameters"):
        run_episodes({}, None, [1], 1.0)
    with pytest.raises(TypeError, match="progress must be a function"):
        run_episodes(parameters, None, [1], 1.0, progress=3)
