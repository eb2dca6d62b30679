"""Law: baselines, studies, docs and examples stand on names that the reference lists.

And nothing stands on studies but studies.
"""

import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
REFERENCE = (REPOSITORY / "docs" / "reference" / "python.md").read_text("utf-8")
IMPORT = re.compile(r"\bfrom (flockenv[\w.]*) import (?:\(([^)]*)\)|([\w, ]+))")
DIRECTIVE = re.compile(r"^\.\. (currentmodule|auto\w+):: (\S+)((?:\n +:.*)*)", re.MULTILINE)
#: Modules that show their help only where their libraries are installed: what each has, in words.
IN_WORDS = re.compile(r"`(flockenv\.\w+)` \(([^)]*)\)")


def listed() -> tuple[set[str], set[str]]:
    """The objects that the reference lists, and the modules all of which it lists."""
    names, modules, current = set(), set(), ""
    for kind, name, options in DIRECTIVE.findall(REFERENCE):
        if kind == "currentmodule":
            current = name
        elif kind == "automodule" and ":no-members:" not in options:
            modules.add(name)
        elif kind != "automodule":
            names.add(name if name.startswith("flockenv.") else f"{current}.{name}")
    for module, words in IN_WORDS.findall(REFERENCE):
        names |= {f"{module}.{name}" for name in re.findall(r"\w+", words)}
    return names, modules


NAMES, MODULES = listed()


def imports() -> Iterator[tuple[str, str, str]]:
    """Each file with what it imports of the package: module and name."""
    for folder in ("baselines", "studies", "docs", "examples"):
        for path in sorted((REPOSITORY / folder).rglob("*")):
            place = path.relative_to(REPOSITORY)
            copied = {("docs", "_build"), ("docs", "studies"), ("docs", "examples")}
            if path.suffix not in (".py", ".md", ".ipynb") or place.parts[:2] in copied:
                continue
            for module, several, few in IMPORT.findall(path.read_text("utf-8")):
                for name in re.findall(r"\w+", re.sub(r"#.*| as \w+", "", several or few)):
                    yield str(place), module, name


def is_listed(module: str, name: str) -> bool:
    if f"{module}.{name}" in NAMES:
        return True
    value = getattr(importlib.import_module(module), name)

    def has(place: str) -> bool:
        return getattr(importlib.import_module(place), name, has) is value

    again = (each.rpartition(".") for each in NAMES)
    return any(end == name and has(place) for place, _, end in again) or any(
        has(each) for each in MODULES if f"{each}.".startswith(f"{module}.")
    )


@pytest.mark.parametrize(("module", "name"), sorted({each[1:] for each in imports()}))
def test_what_is_imported_is_in_the_reference(module, name):
    files = [file for file, *each in imports() if each == [module, name]]
    assert is_listed(module, name), f"{', '.join(files)}: {module}.{name} is not a public name"


def test_the_check_would_notice():
    assert len({*imports()}) > 100
    assert is_listed("flockenv", "FlockParameters")
    for module, name in (("flockenv.replay", "MOST_BYTES"), ("flockenv.envs.batch", "mean_rows")):
        assert not is_listed(module, name)


def test_only_studies_import_studies():
    # Where the build of the pages copies them.
    built = {REPOSITORY / "docs" / name for name in ("studies", "_build")}
    found = [
        str(path.relative_to(REPOSITORY))
        for folder in ("flockenv", "web", "docs", "examples", "baselines", "benches", "tests")
        for path in (REPOSITORY / folder).rglob("*.py")
        if built.isdisjoint(path.parents)
        and re.search(r"^\s*(from|import) studies\b", path.read_text("utf-8"), re.MULTILINE)
    ]
    assert found == []
