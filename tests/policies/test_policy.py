"""Law: whatever a policy is given as, it becomes one checked type, wherever it is taken."""

import sys

import numpy as np
import pytest

import flockenv
from flockenv import ParameterError
from flockenv.comparison import run_episodes
from flockenv.policies import LeaningLaw, Policy, SteeringLaw, policy

PARAMETERS = flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="wide")
PAPERS = {"seed": 3, "duration_s": 5.0}


class Held:
    """A rudder that is held, with whatever attributes it is told to have."""

    def __init__(self, **attributes) -> None:
        vars(self).update(attributes)

    def predict(self, observation, state=None, episode_start=None):
        return np.full(len(observation), 0.5), state


def write_module(folder, monkeypatch, text="") -> None:
    monkeypatch.chdir(folder)
    code = "from flockenv.policies import SteeringLaw as Law\nmade = Law()\ndef leaders():\n"
    (folder / "mine.py").write_text(f"{code}    return Law()\nnumber = 5\n{text}")
    monkeypatch.delitem(sys.modules, "mine", raising=False)


def test_every_spelling_is_one_policy(tmp_path, monkeypatch) -> None:
    """Each of these is the paper's law, at every control step."""
    write_module(tmp_path, monkeypatch)
    run = flockenv.simulate(PARAMETERS, policy="paper's law", **PAPERS)
    measured = run_episodes(PARAMETERS, "paper's law", [3], 30.0)
    before = [*sys.path]
    for given in (
        SteeringLaw(),
        SteeringLaw,
        lambda: SteeringLaw(),
        policy("paper's law"),
        lambda: policy("paper's law"),
        policy("mine:made", trust=True),
        policy("mine:Law", trust=True),
        policy("mine:leaders", trust=True),
    ):
        assert isinstance(policy(given), Policy)
        assert policy(given).control_hz == 10.0
        assert flockenv.simulate(PARAMETERS, policy=given, **PAPERS) == run
        assert run_episodes(PARAMETERS, given, [3], 30.0) == measured
    assert sys.path == before


def test_a_path_is_a_file(tmp_path) -> None:
    flockenv.policies.load("learned", pool="wide").save(tmp_path / "wide.json")
    named = flockenv.simulate(PARAMETERS, policy="learned", **PAPERS)
    for given in (tmp_path / "wide.json", str(tmp_path / "wide.json")):
        assert flockenv.simulate(PARAMETERS, policy=given, **PAPERS) == named
        each = dict.fromkeys(("leader_0", "leader_1"), given)
        led = flockenv.simulate(PARAMETERS, policy=each, **PAPERS)
        assert np.abs(led.pose - named.pose).max() < 1e-4
    with pytest.raises(FileNotFoundError):
        flockenv.simulate(PARAMETERS, policy=tmp_path / "none.json", **PAPERS)


def test_rate_and_pool_are_those_of_what_it_was_made_of() -> None:
    law = policy(None)
    assert (law.name, law.control_hz, law.pool) == ("paper's law at every substep", None, None)
    assert policy("paper's law at every substep").law == law.law
    learned = policy("learned", "wide")
    assert (learned.pool, learned.control_hz) == ("wide", 10.0)
    assert policy(Held(control_hz=4)).decisions_hz == 4.0
    assert policy(Held(decision_period_s=0.5, pool=(90.0, 30.0))).decisions_hz == 2.0
    assert policy(learned) is learned
    assert policy(Held(law=SteeringLaw().law)).law is None, "an object is more than what it holds"


def test_a_run_leaves_the_policy_as_it_was() -> None:
    """Draws of random rudders start again with every run."""
    random = flockenv.policies.RandomRudders(5)
    first, again = (flockenv.simulate(PARAMETERS, policy=random, **PAPERS) for _ in range(2))
    assert first == again
    other = flockenv.simulate(PARAMETERS, policy=flockenv.policies.RandomRudders(6), **PAPERS)
    assert first.pose.tobytes() != other.pose.tobytes()


REFUSED = [
    (5, None, ParameterError, "policy = 5 is not accepted: a policy's name or file"),
    (np, None, ParameterError, "policy = <module 'numpy'"),
    (lambda: 5, None, ParameterError, "policy = 5 is not accepted"),
    (lambda: Held, None, ParameterError, "policy = <class .*Held'> is not accepted"),
    (LeaningLaw, None, ParameterError, "policy = <class .*LeaningLaw'> is not accepted"),
    ("papers law", None, ParameterError, 'did you mean "paper\'s law"'),
    ("", None, ParameterError, "'' is not a policy"),
    ("tuned law", None, ParameterError, "pool = None .* pools with a name"),
    ("learned", "narrow", ParameterError, "learned leaders are for wide"),
    ("learned", (90.0, 30.0), ParameterError, "pools with a name"),
    (Held(pool="wide"), "narrow", ParameterError, "made for pool = 'wide'"),
    (policy("learned", "wide"), "narrow", ParameterError, "made for pool = 'wide'"),
    ("none.json", None, OSError, "none.json"),
    ("mine:made", None, ParameterError, "mine:made names code.*trust=True"),
    (Held(control_hz=0.0), None, ParameterError, "control_hz = 0.0 of a policy"),
    (Held(control_hz=np.inf), None, ParameterError, "control_hz = inf of a policy"),
    (Held(control_hz="10"), None, TypeError, "control_hz must be a number"),
    (Held(decision_period_s=-1.0), None, ParameterError, "decision_period_s = -1.0 of a policy"),
    (Held(decision_period_s=True), None, TypeError, "decision_period_s must be a number"),
    (Held(observation="own"), None, TypeError, "a policy's observation must be a dictionary"),
    (Held(mirror_to_target="no"), None, TypeError, "a policy's mirror_to_target must be True or"),
    (Held(action_mode="heading!"), None, ParameterError, "did you mean 'heading'"),
]


@pytest.mark.parametrize(("given", "pool", "error", "words"), REFUSED)
def test_what_is_no_policy_is_refused(tmp_path, monkeypatch, given, pool, error, words) -> None:
    write_module(tmp_path, monkeypatch)
    with pytest.raises(error, match=words):
        policy(given, pool)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mine:number", "policy = 5 is not accepted"),
        ("mine:nobody", "mine:nobody is not accepted: AttributeError"),
        ("no_such_module:Law", "no_such_module:Law is not accepted: ModuleNotFoundError"),
        ("raises:Law", "raises:Law is not accepted: ZeroDivisionError"),
    ],
)
def test_modules_without_a_policy_are_refused(tmp_path, monkeypatch, name, words) -> None:
    write_module(tmp_path, monkeypatch)
    (tmp_path / "raises.py").write_text("1 / 0")
    with pytest.raises(ParameterError, match=words):
        policy(name, trust=True)


def test_a_network_of_torch_is_told_how_it_becomes_one() -> None:
    torch = pytest.importorskip("torch")
    with pytest.raises(ParameterError, match=r"NetworkPolicy\.from_module"):
        policy(torch.nn.Linear(2, 1))
    with pytest.raises(ParameterError, match="object with predict"):
        flockenv.simulate(PARAMETERS, policy=torch.nn.Linear(2, 1), **PAPERS)
