"""Law: a page names what there is: files, commands, options, make targets, functions and fields."""

import dataclasses
import importlib
import importlib.util
import inspect
import io
import re
import shlex
import tokenize
from functools import cache
from pathlib import Path

import gymnasium
import pytest
import typer

from flockenv._io.extras import MissingExtraError
from flockenv.cli import app

pytest.importorskip("stable_baselines3")

REPOSITORY = Path(__file__).parents[2]
DOCS = REPOSITORY / "docs"
FENCE = re.compile(r"^( *)(`{3,})(?:\{?(\w*).*?)$(.*?)^\1\2$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
WORD = re.compile(r"[^\W\d]\w*")
CODE = ("*.py", "*.pyi", "*.rs", "*.mjs", "*.js", "*.html", "*.css", "*.toml", "*.yml", "*.slurm")
#: What readers of a page make themselves, and names in files of other programs.
OTHERS = {
    "CONTRIBUTING.md": {"llvm-tools", "x86_64-unknown-linux-musl"},
    "benches/README.md": {"callgrind_annotate"},
    "docs/environments/index.md": {"flockenv/leaders", "flockenv/lean"},
    "docs/extend/task.md": {"carousel.monitor.csv"},
    "docs/other_learners.md": {"TanhNormal"},
    "docs/reference/files.md": {"flockenv recording 1", "runs/VERSION-RESULTS/XX/KEY.npz"},
    "docs/speed_vs_error.md": {"boids"},
    "docs/runs.md": {"run_sweep(sweep, folder, engine=lambda workers: client.get_executor())"},
    "docs/tracks.md": {
        "individuals",
        "mouse1.nose_x",
        "movement",
        "nose_x",
        "nose_y",
        "model.toml",
    },
}
FOLDERS = ("baselines", "benches", "docs", "examples", "flockenv", "src", "studies", "tests", "web")
FOREIGN = (
    "gymnasium",
    "gymnasium.utils.performance",
    "gymnasium.wrappers",
    "pettingzoo",
    "stable_baselines3.common.evaluation",
    "stable_baselines3.common.callbacks",
    "stable_baselines3.common.vec_env",
    "stable_baselines3.common.monitor",
    "torch",
    "pandas",
    "concurrent.futures",
    "xarray",
)


def _pages() -> dict[str, str]:
    """The text of each page, those that are generated included."""
    from docs.scripts import environment_pages

    folders = ("docs", "studies", "benches", "baselines", "web", "examples")
    found = [*REPOSITORY.glob("*.md"), *(f for each in folders for f in _files(each, "*.md"))]
    texts = {str(path.relative_to(REPOSITORY)): path.read_text("utf-8") for path in found}
    made = environment_pages.pages()
    return texts | {str(path.relative_to(REPOSITORY)): text for path, text in made.items()}


def _files(folder: str, pattern: str) -> list[Path]:
    skipped = {"target", "_build", "node_modules", ".venv", "results"}
    names = {path: path.relative_to(REPOSITORY) for path in (REPOSITORY / folder).rglob(pattern)}
    copied = DOCS / "studies"  # by the build of the pages
    return [
        path
        for path, name in names.items()
        if not skipped & {*name.parts[:-1]} and copied not in path.parents
    ]


PAGES = _pages()


@cache
def _files_of_code() -> list[Path]:
    """All code of the repository, this folder of tests aside, which has lists of names."""
    files = [path for each in FOLDERS for kind in CODE for path in _files(each, kind)]
    files += [REPOSITORY / name for name in ("Makefile", "Cargo.toml", "pyproject.toml")]
    files += (*REPOSITORY.glob("*/*.sh"), *REPOSITORY.glob("benches/Makefile"))
    files += (REPOSITORY / ".github").rglob("*.yml")
    return [path for path in files if path.parent != Path(__file__).parent]


@cache
def _code() -> str:
    return "\n".join(path.read_text("utf-8", errors="ignore") for path in _files_of_code())


@cache
def _words() -> set[str]:
    """The words of the code. Comments and docstrings may speak of what there was."""
    texts = (
        _without_comments(path.suffix, path.read_text("utf-8", errors="ignore"))
        for path in _files_of_code()
    )
    return {word for text in texts for word in WORD.findall(text)}


def _without_comments(kind: str, text: str) -> str:
    if kind in (".rs", ".mjs", ".js"):
        return re.sub(r"(?<!:)//[^\n]*", "", text)
    if kind not in (".py", ".pyi"):
        return re.sub(r"(?m)(?:^|\s)#[^\n]*", "", text)
    kept, starts = [], True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        # A string that starts a statement is a docstring.
        if token.type != tokenize.COMMENT and not (starts and token.type == tokenize.STRING):
            kept.append(token.string)
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            between = (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
            starts = token.type in between
    return "\n".join(kept)


@cache
def _commands() -> dict[str, set[str]]:
    """The options of each command."""
    group = typer.main.get_command(app)
    return {
        name: {text for each in command.params for text in (*each.opts, *each.secondary_opts)}
        | {"--help", "-h"}
        for name, command in group.commands.items()
    }


@cache
def _targets() -> tuple[set[str], set[str]]:
    """The targets of the Makefile, and the variables that it and its scripts read."""
    text = (REPOSITORY / "Makefile").read_text("utf-8")
    targets = re.findall(r"^([a-z][\w -]*):(?!=)", text, re.MULTILINE)
    for script in ("benches/Makefile", ".github/release.sh", "tests/other.sh"):
        text += (REPOSITORY / script).read_text("utf-8")
    variables = re.findall(r"^(\w+) [?:]?=|\$[({](\w+)", text, re.MULTILINE)
    return {name for each in targets for name in each.split()}, {n for v in variables for n in v}


@cache
def _public() -> dict[str, object]:
    """The public classes and functions by their bare names."""
    modules = ["flockenv", "policies", "comparison", "sb3", "tracks", "replay", "runs.sweep"]
    modules += ["recording", "flock", "order", "envs.batch", "runs.spec", "rendering"]
    found: dict[str, object] = {}
    for name in modules:
        module = importlib.import_module("flockenv" if name == "flockenv" else f"flockenv.{name}")
        found |= {k: v for k, v in vars(module).items() if inspect.isclass(v) and k[0] != "_"}
    return found


def _resolves(path: str) -> bool:
    """Whether a dotted name is a module, or an attribute of one."""
    parts = path.split(".")
    for split in range(len(parts), 0, -1):
        module = ".".join(parts[:split])
        try:
            if importlib.util.find_spec(module) is None:
                continue
            found: object = importlib.import_module(module)
        except MissingExtraError:
            return {*parts[split:]} <= _words()
        except ModuleNotFoundError as error:
            if not module.startswith(str(error.name)):
                return {*parts[split:]} <= _words()
            continue
        return _has(found, parts[split:])
    return False


def _in_rust(owner: str, member: str) -> bool:
    """Whether a file says what the owner is or does, and has such a function or variant."""
    named = re.compile(rf"\b(impl|enum|struct|trait)\b[^\n]*\b{owner}\b")
    made = re.compile(rf"\b(fn|const) {member}\b|^ +{member}\b", re.MULTILINE)
    texts = (path.read_text("utf-8") for path in _files("src", "*.rs"))
    return any(named.search(text) and made.search(text) for text in texts)


def _has(found: object, names: list[str]) -> bool:
    for place, name in enumerate(names):
        if dataclasses.is_dataclass(found) and name in found.__dataclass_fields__:
            return True
        if name in getattr(found, "__annotations__", {}):
            return True
        if inspect.isclass(found) and f"self.{name}" in inspect.getsource(found):
            return True
        if not hasattr(found, name):
            return False
        found = inspect.getattr_static(found, name) if place else getattr(found, name)
        if isinstance(found, property):
            return True
    return True


def wrong_command(line: str) -> str | None:
    """Say what a line for a shell names that does not exist."""
    line = line.split(" && ")[0]
    try:
        program, *words = shlex.split(line, comments=True)
    except ValueError:
        return None
    program = program.removeprefix(".venv/bin/")
    options = {re.split("[=, ]", word)[0] for word in words if re.match(r"--?[a-z]", word)}
    if program == "make":
        targets, variables = _targets()
        values = {word.split("=")[0] for word in words if "=" in word}
        unknown = {word for word in words if "=" not in word} - targets | (values - variables)
    elif program == "flockenv" and words:
        if words[0].startswith("-"):
            return None if words[0] in ("--version", "--help") else f"flockenv {words[0]}"
        if words[0].isupper():
            return None
        if words[0] not in _commands():
            return f"flockenv {words[0]}"
        unknown = options - _commands()[words[0]]
    elif program.startswith("python") and (script := _script(words)):
        path = REPOSITORY / script
        if script.split("/")[0] in ("baselines", "benches", "docs", "examples", "studies"):
            if not path.exists():
                return script
            text = path.read_text("utf-8")
            unknown = {
                option
                for option in options
                if option not in text and option[2:].replace("-", "_") not in text
            }
            unknown = {each for each in unknown if each[2:].replace("-", "_") not in _words()}
        else:
            unknown = set()
    else:
        unknown = set()
    return ", ".join(sorted(unknown)) or None


def _script(words: list[str]) -> str | None:
    """Return the file that the words behind `python` run; None for other modules."""
    if words[:1] == ["-m"] and words[1].startswith("studies."):
        return f"{words[1].replace('.', '/')}.py"
    return words[0] if words and words[0].endswith(".py") else None


def wrong_name(name: str) -> str | None:
    """Say what a name in backticks names that does not exist."""
    first = name.split()[0]
    if first in ("make", "flockenv", "python") and " " in name:
        return wrong_command(name)
    if name.startswith("--"):
        every = {option for options in _commands().values() for option in options}
        given = re.findall(r"(?<!\S)--[\w-]+", name)
        known = every | {*re.findall(r"--[a-z][\w-]+", _code())}
        unknown = [each for each in given if each not in known and _field(each) not in _words()]
        return ", ".join(unknown) or None
    if name.startswith(("results/", "mine/", "my_")):
        # What commands and readers write.
        return None
    if name.startswith("flockenv/") and name in gymnasium.registry:
        return None
    if re.fullmatch(rf"(?:{'|'.join(FOLDERS)})/[\w./-]+", name):
        made = (
            "flockenv/replay/live.html",
            "docs/_build/",
            "benches/target/",
            "docs/environments/tables.md",
        )
        return None if (REPOSITORY / name).exists() or name.startswith(made) else name
    if re.fullmatch(r"[\w./-]+\.(?:py|rs|md|mjs|csv|toml|json|yml|npz|png|html|sh|slurm)", name):
        there = (REPOSITORY / name).exists() or f"/{name}" in _listing() or name in _code()
        return None if there else name
    dotted = re.match(r"([A-Za-z_]\w*(?:\.\w+)+)", name)
    if dotted and dotted[1].startswith("flockenv."):
        return None if _resolves(dotted[1]) else dotted[1]
    if dotted and dotted[1].split(".")[0] in _public():
        owner, *attributes = dotted[1].split(".")
        return None if _has(_public()[owner], attributes) else dotted[1]
    rust = re.match(r"(\w+)::(\w+)", name)
    if rust:
        return None if _in_rust(*rust.groups()) else name
    words = WORD.findall(re.sub(r"\"[^\"]*\"|'[^']*'", "", name))
    unknown = [word for word in words if word not in _words() and not _foreign(word)]
    return ", ".join(unknown) or None


def _field(option: str) -> str:
    return option[2:].replace("-", "_")


@cache
def _listing() -> str:
    return "\n".join(f"/{path.relative_to(REPOSITORY)}" for path in _files(".", "*"))


@cache
def _foreign(word: str) -> bool:
    return any(hasattr(importlib.import_module(module), word) for module in FOREIGN)


@pytest.mark.parametrize("page", sorted(PAGES))
def test_names_exist(page):
    prose = FENCE.sub("", PAGES[page])
    shown = " ".join(match[4] for match in FENCE.finditer(PAGES[page]))
    made = re.findall(r"<!-- new file: (\S+) -->", PAGES[page])
    known = {*made, *OTHERS.get(page, ()), *WORD.findall(shown)}
    wrong = {name: wrong_name(name) for name in sorted({*NAME.findall(prose)} - known)}
    folder = (REPOSITORY / page).parent
    assert {
        name: why
        for name, why in wrong.items()
        if why and why not in shown and not (folder / why).exists()
    } == {}


@pytest.mark.parametrize("page", sorted(PAGES))
def test_commands_and_imports_exist(page):
    for _, _, language, block in FENCE.findall(PAGES[page]):
        lines = block.replace("\\\n", " ").splitlines()
        if language in ("sh", "bash", "console", "loop"):
            wrong = [wrong_command(line.removeprefix("$ ")) for line in lines if line.strip()]
            assert [each for each in wrong if each] == []
        if language == "python":
            used = {*re.findall(r"(?<![\w./\"'-])(?<!from )flockenv(?:\.\w+)+", block)}
            for module, names in re.findall(r"from (flockenv[\w.]*) import (\([^)]*|.*)", block):
                used |= {f"{module}.{name}" for name in WORD.findall(names)}
            assert [name for name in sorted(used) if not _resolves(name)] == []


@pytest.mark.parametrize(
    "name",
    [
        "compute_rewards",
        "flockenv judge",
        "flockenv run --leader-count 3",
        "make everything",
        "make test THREADS=2",
        "--no-such-option",
        "docs/nothing.md",
        "flockenv.policies.SteerLaw",
        "FlockParameters.bw_seconds",
        "Flock::advance_backwards",
        "python -m studies.section4.fig99",
    ],
)
def test_what_does_not_exist_is_found(name):
    assert wrong_name(name)


def test_comments_and_docstrings_name_nothing():
    code = '"""One."""\ndef two():\n    """Three."""\n    return "four"  # five\n'
    assert WORD.findall(_without_comments(".py", code)) == ["def", "two", "return", "four"]
    assert WORD.findall(_without_comments(".rs", "//! One\nlet two = 3; // Four\n")) == [
        "let",
        "two",
    ]
    assert WORD.findall(_without_comments(".toml", "# One\ntwo = 3\n")) == ["two"]
