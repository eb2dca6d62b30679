"""Law: the installed package is this source tree, and what is imported is what is used."""

import re
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import flockenv
from flockenv.cli import COMMANDS

REPOSITORY = Path(__file__).parents[2]
OPTIONAL = (
    "torch",
    "stable_baselines3",
    "matplotlib",
    "pandas",
    "scipy",
    "pyarrow",
    "pygame",
    "ray",
)


def test_version_is_the_one_of_cargo_toml():
    cargo = (REPOSITORY / "Cargo.toml").read_text()
    assert flockenv.__version__ == re.search(r'^version = "(.+)"$', cargo, re.MULTILINE)[1]


def test_import_needs_no_optional_library():
    blocked = f"import sys; sys.modules.update(dict.fromkeys({OPTIONAL}))"
    subprocess.run([sys.executable, "-c", f"{blocked}; import flockenv"], check=True)


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import flockenv", ("rich", "typer")),
        (
            "import flockenv as f; p = f.FlockParameters(n_leaders=1); "
            "f.simulate(p, 1, 1.0, policy='learned')",
            ("rich", "typer"),
        ),
        *(
            (
                f"import sys; sys.argv = ['bin/flockenv', {words}]; "
                "from flockenv.cli import main; main()",
                ("gymnasium", "numpy", "pettingzoo", *absent),
            )
            for words, *absent in (("'--help'",), ("'-h'",), ("'--version'", "pydantic"))
        ),
    ],
)
def test_libraries_are_imported_where_they_are_used(code, absent):
    end = "import atexit, sys; atexit.register(lambda: print('imported', *sys.modules))"
    words = subprocess.check_output([sys.executable, "-c", f"{end}; {code}"], text=True).split()
    found = {*words[words.index("imported") :]}
    assert "flockenv" in found
    assert not found & {*OPTIONAL, *absent}


def test_the_module_prints_its_help_without_gymnasium():
    command = [sys.executable, "-X", "importtime", "-m", "flockenv", "--help"]
    imported = subprocess.run(command, check=True, capture_output=True, text=True).stderr
    assert "flockenv.cli" in imported
    assert "gymnasium" not in imported


def test_the_names_of_the_package_are_those_of_its_modules():
    assert {*flockenv.__all__} <= {*dir(flockenv)}
    for name in flockenv.__all__:
        value = getattr(flockenv, name)
        assert getattr(value, "__name__", name).split(".")[-1] == name
    assert flockenv.statistics is import_module("flockenv.statistics")
    with pytest.raises(AttributeError, match="module 'flockenv' has no attribute 'Flocks'"):
        flockenv.Flocks  # noqa: B018


def test_the_help_has_the_first_sentence_of_every_command():
    for name, line in COMMANDS.items():
        command = getattr(import_module(f"flockenv.cli.{name}"), name)
        assert line == " ".join(command.__doc__.split("\n\n")[0].split())


def test_sources_without_the_compiled_simulator_say_so(tmp_path):
    compiled = shutil.ignore_patterns("*.so", "*.pyd")
    shutil.copytree(REPOSITORY / "flockenv", tmp_path / "flockenv", ignore=compiled)
    failed = subprocess.run(
        [sys.executable, "-c", "import flockenv"], cwd=tmp_path, capture_output=True, text=True
    )
    assert failed.returncode == 1
    assert "start Python in another folder than the clone's" in failed.stderr


@pytest.mark.parametrize("kind", ["function", "class", "method"])
def test_a_core_of_older_sources_is_named_with_the_command_that_builds_another(tmp_path, kind):
    stub = {
        "function": "def later(x: float) -> float: ...\n",
        "class": "class Later:\n    def later(self) -> None: ...\n",
        "method": "    def later(self) -> None: ...\n",
    }[kind]
    shutil.copytree(REPOSITORY / "flockenv", tmp_path / "flockenv")
    stubs = tmp_path / "flockenv" / "_core.pyi"
    text = stubs.read_text(encoding="utf-8")
    own = "class Parameters:\n"
    new = text.replace(own, own + stub) if kind == "method" else f"{text}\n{stub}"
    assert new != text
    stubs.write_text(new, encoding="utf-8")

    def imported() -> subprocess.CompletedProcess:
        command = [sys.executable, "-c", "import flockenv"]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)

    assert imported().returncode == 0  # No clone: nothing to build there.
    (tmp_path / "Cargo.toml").touch()
    failed = imported()
    assert failed.returncode == 1
    name = "Later" if kind == "class" else "later"
    ending = f"it has no {name}. Run `make build` in {tmp_path}\n"
    assert failed.stderr.endswith(ending)
    stubs.write_text(text, encoding="utf-8")
    assert imported().returncode == 0
