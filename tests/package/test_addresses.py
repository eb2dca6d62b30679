"""Law: the addresses of repository and site are declared once, and a release waits for them."""

import runpy
import shutil
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
FILES = ("pyproject.toml", "Cargo.toml", "CITATION.cff", "README.md", ".github/addresses.toml")


@pytest.fixture
def main() -> Callable[..., None]:
    return runpy.run_path(str(REPOSITORY / ".github/addresses.py"))["main"]


@pytest.fixture
def clone(tmp_path) -> Path:
    for name in FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(REPOSITORY / name, tmp_path / name)
    return tmp_path


def declare(clone: Path, repository: str, site: str) -> None:
    text = f'repository = "{repository}"\nsite = "{site}"\n'
    (clone / ".github/addresses.toml").write_text(text)


def held(clone: Path) -> dict[str, str]:
    return {name: (clone / name).read_text() for name in FILES[:-1]}


def test_addresses_are_written_wherever_they_are_looked_for(main, clone):
    before = held(clone)
    for host in ("first.example", "second.example"):
        declare(clone, f"https://{host}/flockenv", f"https://{host}/pages/")
        main(clone)
        main(clone, "--check")
    project = tomllib.loads((clone / "pyproject.toml").read_text())
    assert project["project"]["urls"]["Repository"] == "https://second.example/flockenv"
    assert project["project"]["urls"]["Homepage"] == "https://second.example/pages/"
    package = tomllib.loads((clone / "Cargo.toml").read_text())["package"]
    assert package["repository"] == "https://second.example/flockenv"
    assert 'repository-code: "https://second.example/flockenv"' in held(clone)["CITATION.cff"]
    assert held(clone)["README.md"].splitlines()[2].startswith("[Pages and the live page](https")
    # Nothing else is changed, and nothing is left of the first ones.
    for name, text in held(clone).items():
        assert "first.example" not in text
        assert set(before[name].splitlines()) <= set(text.splitlines())


def test_a_release_waits_for_them(main, clone):
    declare(clone, "https://first.example/flockenv", "")
    with pytest.raises(SystemExit, match="has no site yet"):
        main(clone, "--check")
    declare(clone, "", "")
    with pytest.raises(SystemExit, match="has no repository and no site yet"):
        main(clone)
    declare(clone, "https://first.example/flockenv", "https://first.example/pages/")
    with pytest.raises(SystemExit, match=r"pyproject\.toml has other addresses"):
        main(clone, "--check")
    makefile = (REPOSITORY / "Makefile").read_text()
    (needs,) = [line for line in makefile.splitlines() if line.startswith("release-check:")]
    assert needs.split()[1] == "check-addresses"


def test_what_is_declared_is_what_is_written(main):
    """Before a release nothing is declared, and no file may have an address of its own."""
    declared = tomllib.loads((REPOSITORY / ".github/addresses.toml").read_text())
    if all(declared.values()):
        main(REPOSITORY, "--check")
    else:
        assert "[project.urls]" not in (REPOSITORY / "pyproject.toml").read_text()
        assert "\nrepository = " not in (REPOSITORY / "Cargo.toml").read_text()
        assert "\nrepository-code:" not in (REPOSITORY / "CITATION.cff").read_text()
