"""Law: developers install one set of versions, which names each dependency and no address."""

import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LOCKED = [
    Requirement(line)
    for line in (ROOT / "requirements.lock").read_text().splitlines()
    if not line.startswith("#")
]
OF_OTHER_ENVIRONMENTS = {"all", "benchmarl", "ray", "torchrl", "video"}


def direct() -> list[str]:
    extras = PROJECT["project"]["optional-dependencies"]
    return [
        *PROJECT["project"]["dependencies"],
        *(each for name in extras.keys() - OF_OTHER_ENVIRONMENTS for each in extras[name]),
        *(each for group in PROJECT["dependency-groups"].values() for each in group),
    ]


@pytest.mark.parametrize("text", sorted(set(direct())))
def test_each_dependency_is_pinned_to_a_version_that_is_allowed(text):
    wanted = Requirement(text)
    pins = [each for each in LOCKED if each.name.lower() == wanted.name.lower()]
    assert pins
    for pin in pins:
        (version,) = (clause.version for clause in pin.specifier)
        assert wanted.specifier.contains(version), pin


def test_the_lock_holds_for_any_registry():
    assert not any(each.url for each in LOCKED)
    assert "://" not in (ROOT / "requirements.lock").read_text()
