"""Law: the distributed notices are those of the crates that are compiled in."""

import re
import tomllib
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]


def noticed() -> set[tuple[str, str]]:
    """Names and versions of the crates in the heads of the notices."""
    heads = re.findall(
        r"^\S.* \(.+\): (.+)\n-{80}$",
        (REPOSITORY / "LICENSES/crates.txt").read_text(),
        re.MULTILINE,
    )
    crates = [each.split(" ") for head in heads for each in head.split(", ")]
    return {(name, version) for name, version in crates}


def test_notices_are_of_the_locked_versions():
    lock = tomllib.loads((REPOSITORY / "Cargo.lock").read_text())
    locked = {(each["name"], each["version"]) for each in lock["package"]}
    assert noticed() - locked == set(), "run `make licenses`"


def test_every_dependency_has_a_notice():
    wanted = set(tomllib.loads((REPOSITORY / "Cargo.toml").read_text())["dependencies"])
    assert wanted - {name for name, _ in noticed()} == set(), "run `make licenses`"
