"""Law: an old name of a module or argument answers with the same, and warns of the new one."""

import importlib
import subprocess
import sys

import pytest

from flockenv import FlockParameters
from flockenv._io.moved_modules import MOVED
from flockenv.comparison import run_episodes
from flockenv.policies import SteeringLaw
from flockenv.policies.pretrained import learned


@pytest.mark.parametrize("old", MOVED)
def test_old_names_answer_and_warn(old):
    new = importlib.import_module(f"flockenv.{MOVED[old]}")
    moved = importlib.import_module(f"flockenv.{old}")
    name = new.__all__[0]
    with pytest.warns(
        DeprecationWarning, match=f"flockenv.{old} has moved to flockenv.{MOVED[old]}"
    ):
        assert getattr(moved, name) is getattr(new, name)
    with pytest.raises(AttributeError, match="nothing_of_it"):
        moved.nothing_of_it  # noqa: B018


def test_old_names_are_imported_as_before():
    code = (
        "import flockenv.arrangement; from flockenv import arrangement; "
        "from flockenv.arrangement import largest_cluster; "
        "assert largest_cluster is arrangement.largest_cluster; "
        "assert largest_cluster is flockenv.arrangement.largest_cluster"
    )
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], check=True)


def test_importing_flockenv_warns_of_nothing():
    subprocess.run([sys.executable, "-W", "error", "-c", "import flockenv"], check=True)


def test_an_old_argument_is_the_new_one_and_warns():
    parameters = FlockParameters(n_boats=4, n_leaders=1, pool="table-1")
    rest = {"policy": SteeringLaw(), "seeds": [2], "duration_s": 1.0}
    expected = run_episodes(parameters, **rest)
    with pytest.warns(DeprecationWarning, match="the argument scene is called parameters"):
        found = run_episodes(scene=parameters, **rest)
    assert found == expected


def test_an_old_attribute_is_the_new_one_and_warns():
    law = learned("table-1")
    with pytest.warns(DeprecationWarning, match="the attribute made is called provenance"):
        assert law.made is law.provenance
