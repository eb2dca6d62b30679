"""Law: commands, files and dotted names that a page names exist."""

import dataclasses
import importlib
import importlib.util
import inspect
import re
import shlex
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
FOLDERS = ("baselines", "benches", "docs", "examples", "flockenv", "src", "studies", "tests", "web")
CODE = ("*.py", "*.rs", "*.mjs", "*.js", "*.html", "*.toml", "*.yml", "*.slurm", "*.sh")
SCRIPTS = ("baselines", "benches", "docs", "examples", "studies")
FILE = re.compile(r"[\w./-]+\.(?:py|rs|md|mjs|csv|toml|json|yml|npz|png|html|sh|slurm)")
MADE = (
    "results/",
    "mine/",
    "my_",
    "docs/_build/",
    "benches/target/",
)
"""What builds, commands and readers write."""
OTHERS = {
    "docs/environments/index.md": {"flockenv/leaders", "flockenv/lean"},
    "docs/extend/task.md": {"carousel.monitor.csv"},
    "docs/reference/files.md": {"flockenv recording 1", "runs/VERSION-RESULTS/XX/KEY.npz"},
    "docs/tracks.md": {"model.toml", "trajectories.csv"},
}
"""What readers of a page make themselves, and names of other programs."""


def _pages() -> dict[str, str]:
    """The text of each page, those that are generated included."""
    from docs.scripts import environment_pages

    folders = ("docs", "studies", "benches", "baselines", "web", "examples")
    found = [*REPOSITORY.glob("*.md"), *(f for each in folders for f in _files(each, "*.md"))]
    texts = {str(path.relative_to(REPOSITORY)): path.read_text("utf-8") for path in found}
    made = environment_pages.pages()
    return texts | {str(path.relative_to(REPOSITORY)): text for path, text in made.items()}


def _files(folder: str, pattern: str) -> list[Path]:
    skipped = {"target", "_build", "node_modules", ".venv", "__pycache__", ".pytest_cache"}
    names = {path: path.relative_to(REPOSITORY) for path in (REPOSITORY / folder).rglob(pattern)}
    copied = (DOCS / "studies", DOCS / "examples")  # by the build of the pages
    return [
        path
        for path, name in names.items()
        if not skipped & {*name.parts[:-1]} and not {*copied} & {*path.parents}
    ]


PAGES = _pages()


@cache
def _code() -> str:
    """All code of the repository, this folder of tests aside: it names the files that it writes."""
    files = [path for each in FOLDERS for kind in CODE for path in _files(each, kind)]
    files += [REPOSITORY / name for name in ("Makefile", "Cargo.toml", "pyproject.toml")]
    files += (*REPOSITORY.glob("benches/Makefile"), *(REPOSITORY / ".github").rglob("*.yml"))
    kept = (path for path in files if path.parent != Path(__file__).parent)
    return "\n".join(path.read_text("utf-8", errors="ignore") for path in kept)


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
            return _in_source(parts)
        except ModuleNotFoundError as error:
            if not module.startswith(str(error.name)):
                return _in_source(parts)
            continue
        return _has(found, parts[split:])
    return False


def _in_source(parts: list[str]) -> bool:
    """Whether a module whose library is missing defines the first name behind it."""
    for split in range(len(parts), 0, -1):
        file = REPOSITORY.joinpath(*parts[:split]).with_suffix(".py")
        if file.exists():
            text, names = file.read_text("utf-8"), parts[split : split + 1]
            return all(re.search(rf"^(?:class |def )?{name}\b", text, re.M) for name in names)
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
        words = shlex.split(line, comments=True)
    except ValueError:
        return None
    while words and re.fullmatch(r"\w+=\S*", words[0]):
        words = words[1:]
    if not words:
        return None
    program, *words = words
    program = re.sub(r"^\.venv[\w-]*/bin/", "", program)
    if program == "make":
        targets, variables = _targets()
        values = {word.split("=")[0] for word in words if "=" in word}
        wrong = {word for word in words if "=" not in word} - targets | (values - variables)
    elif program == "flockenv" and words:
        wrong = _wrong_flockenv(words)
    elif program.startswith("python") and (script := _script(words)):
        wrong = _wrong_script(script, _options(words))
    else:
        wrong = set()
    return ", ".join(sorted(wrong)) or None


def _options(words: list[str]) -> set[str]:
    return {re.split("[=, ]", word)[0] for word in words if re.match(r"--?[a-z]", word)}


def _wrong_flockenv(words: list[str]) -> set[str]:
    command = words[0]
    if command in ("--version", "--help") or command.isupper():
        return set()
    if command not in _commands():
        return {f"flockenv {command}"}
    return _options(words) - _commands()[command]


def _script(words: list[str]) -> str | None:
    """Return the file of the repository that the words behind `python` run."""
    if words[:1] == ["-m"] and words[1].split(".")[0] in SCRIPTS:
        return f"{words[1].replace('.', '/')}.py"
    is_ours = bool(words) and words[0].endswith(".py") and words[0].split("/")[0] in SCRIPTS
    return words[0] if is_ours else None


def _wrong_script(script: str, options: set[str]) -> set[str]:
    path = REPOSITORY / script
    if not path.exists():
        return {script}
    text = path.read_text("utf-8")
    if script.startswith("studies/"):
        text += (REPOSITORY / "studies" / "study.py").read_text("utf-8")
    fields = {option: option[2:].replace("-", "_") for option in options - {"-m"}}
    return {
        option
        for option, name in fields.items()
        if not re.search(rf"(?:{re.escape(option)}|\b{name})(?![\w-])", text)
    }


def wrong_name(name: str) -> str | None:
    """Say what a name in backticks names that does not exist."""
    first = name.split()[0]
    if first in ("make", "flockenv", "python") and " " in name:
        return wrong_command(name)
    if name.startswith("--"):
        return None if _is_option(re.split("[=, ]", name)[0]) else name
    if name.startswith(MADE) or name in gymnasium.registry:
        return None
    if re.fullmatch(rf"(?:{'|'.join(FOLDERS)})/[\w./-]+", name):
        is_live = name == "flockenv/replay/live.html"
        return None if (REPOSITORY / name).exists() or is_live else name
    if FILE.fullmatch(name):
        there = (REPOSITORY / name).exists() or f"/{name}" in _listing() or name in _code()
        return None if there else name
    return _wrong_dotted(name)


def _wrong_dotted(name: str) -> str | None:
    dotted = re.match(r"([A-Za-z_]\w*(?:\.\w+)+)", name)
    if dotted and dotted[1].startswith("flockenv."):
        return None if _resolves(dotted[1]) else dotted[1]
    if dotted and dotted[1].split(".")[0] in _public():
        owner, *attributes = dotted[1].split(".")
        return None if _has(_public()[owner], attributes) else dotted[1]
    rust = re.match(r"(\w+)::(\w+)", name)
    return name if rust and not _in_rust(*rust.groups()) else None


def _is_option(option: str) -> bool:
    """Whether a command takes an option, or code writes it down."""
    every = {each for options in _commands().values() for each in options}
    return option in every or re.search(rf"{re.escape(option)}(?![\w-])", _code()) is not None


@cache
def _listing() -> str:
    return "\n".join(f"/{path.relative_to(REPOSITORY)}" for path in _files(".", "*"))


@pytest.mark.parametrize("page", sorted(PAGES))
def test_names_exist(page):
    prose = FENCE.sub("", PAGES[page])
    shown = " ".join(match[4] for match in FENCE.finditer(PAGES[page]))
    made = re.findall(r"<!-- new file: (\S+) -->", PAGES[page])
    names = {*NAME.findall(prose)} - {*made, *OTHERS.get(page, ())}
    wrong = {name: wrong_name(name) for name in sorted(names)}
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
                used |= {f"{module}.{name}" for name in re.findall(r"[^\W\d]\w*", names)}
            assert [name for name in sorted(used) if not _resolves(name)] == []


@pytest.mark.parametrize(
    "name",
    [
        "flockenv judge",
        "flockenv run --leader-count 3",
        "make everything",
        "make test THREADS=2",
        "--no-such-option",
        "docs/nothing.md",
        "nothing.csv",
        "flockenv.policies.SteerLaw",
        "flockenv.rllib.LeaderModule",
        "FlockParameters.bw_seconds",
        "Flock::advance_backwards",
        "python -m studies.section4.fig99",
        "python -m studies.section4.fig08 --no-run",
        "python baselines/learn_easy.py --sample 3",
        "OMP_NUM_THREADS=1 python baselines/learn_hard.py",
    ],
)
def test_what_does_not_exist_is_found(name):
    assert wrong_command(name) or wrong_name(name)
