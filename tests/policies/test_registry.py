"""Law: a policy's name, its file and the object itself steer the same, wherever they are given."""

import ast
import runpy
from pathlib import Path

import pytest

import flockenv
from flockenv import _core
from flockenv.comparison.figure import COLORS
from flockenv.policies import names
from flockenv.policies.names import LAWS
from flockenv.policies.registry import NAMES, POOL_POLICIES, policy, quoted

REPOSITORY = Path(__file__).parents[2]
PARAMETERS = flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="narrow")
RUN = {"seed": 3, "duration_s": 5.0}


@pytest.mark.parametrize("name", [*NAMES])
def test_names_steer_as_the_policies_they_stand_for(name: str) -> None:
    parameters = PARAMETERS.replace(pool="wide")
    named = policy(name, "wide")
    assert flockenv.simulate(parameters, policy=name, **RUN) == flockenv.simulate(
        parameters, policy=named, **RUN
    )


def test_learned_leaders_are_loaded_by_name_and_by_file() -> None:
    named = flockenv.policies.load("learned", pool="wide")
    assert named.law == policy("learned", "wide").law
    file = REPOSITORY / "src" / "policies" / "learned" / "wide.json"
    assert named.to_json() == flockenv.policies.load(file).to_json()


def test_a_pool_without_learned_leaders_says_which_have_some() -> None:
    elsewhere = PARAMETERS.replace(pool=(150.0, 30.0))
    for call, words in (
        (lambda: flockenv.policies.load("learned", pool="narrow"), "pool = narrow .* are for wide"),
        (lambda: flockenv.policies.load("learned", pool="bath"), "pool = bath .* are for wide"),
        (lambda: flockenv.policies.load("learned"), "pools with a name"),
        (lambda: flockenv.simulate(PARAMETERS, policy="learned", **RUN), "better than the tuned"),
        (lambda: flockenv.simulate(elsewhere, policy="learned", **RUN), "pools with a name"),
    ):
        with pytest.raises(flockenv.ParameterError, match=words):
            call()
    with pytest.raises(flockenv.ParameterError, match="'wide' is not accepted with the file"):
        flockenv.policies.load("other.npz", pool="wide")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("papers law", 'did you mean "paper\'s law"'),
        ("damped law, learned", "one by one"),
        ("paper's law at every substep, learned", "one by one"),
        ("nobody", quoted([*NAMES])),
    ],
)
def test_unknown_names_are_reported_with_what_there_is(name: str, words: str) -> None:
    with pytest.raises(flockenv.ParameterError) as reported:
        policy(name, "narrow")
    assert words in str(reported.value)


def test_names_of_laws_and_their_colors_stand_in_the_core_alone():
    assert [*LAWS] == [each["name"] for each in _core.LAWS]
    assert {*LAWS} <= {*NAMES}
    assert {name for name, law in LAWS.items() if law["is_of_pool"]} == {*POOL_POLICIES}
    assert {name: law["color"] for name, law in LAWS.items() if law["color"]} == COLORS
    folder = Path(flockenv.__file__).parent
    written = {
        (path.name, node.value)
        for path in folder.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and node.value in LAWS
    }
    assert written == set()


@pytest.mark.parametrize("place", range(6))
def test_one_more_law_changes_no_other_name(place: int, monkeypatch: pytest.MonkeyPatch) -> None:
    own = {name: value for name, value in vars(names).items() if name.isupper()}
    more = {"name": "full rudder", "doc": "", "color": None, "is_of_pool": False}
    declared = [*_core.LAWS]
    monkeypatch.setattr(_core, "LAWS", [*declared[:place], more, *declared[place:]])
    found = runpy.run_path(names.__file__)
    assert found["OTHER_LAWS"] == ("full rudder",)
    for name in own.keys() - {"LAWS", "OTHER_LAWS", "_CONSTANTS"}:
        assert found[name] == own[name]
