"""Law: what the pages show runs as it stands, in their order; what they name is there."""

import re
import shlex
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from sybil.document import Document
from sybil.example import Example, NotEvaluated
from sybil.parsers.myst import CodeBlockParser, PythonCodeBlockParser, SkipParser

import flockenv
from flockenv._io import extras

REPOSITORY = Path(__file__).parents[2]
DOCS = REPOSITORY / "docs"
EXECUTED = {
    "README.md": ["python"],
    "docs/start.md": ["python", "sh"],
    "docs/reference/python.md": ["python"],
    "docs/pictures.md": ["python", "sh"],
    "docs/runs.md": ["python"],
    "docs/extend/policy.md": ["python"],
    "docs/extend/task.md": ["python"],
    "docs/levels.md": ["python", "sh"],
    "docs/suite.md": ["python"],
    "docs/train.md": ["python", "sh"],
    "docs/training_reference.md": ["python", "sh"],
    "docs/other_learners.md": ["python"],
    "docs/tracks.md": ["python", "sh"],
}


@pytest.fixture
def run_shell(cli):
    """Run a block of commands as a user does, in this process, which has imported their libraries.

    No browser is opened.
    """

    def run(example: Example) -> None:
        for line in example.parsed.replace("\\\n", " ").splitlines():
            program, *words = shlex.split(line, comments=True)
            assert program == "flockenv", f"{example.path}, line {example.line}: skip this block"
            done = cli(*words, DISPLAY="", WAYLAND_DISPLAY="", BROWSER="")
            assert done.returncode == 0, f"{example.path}, line {example.line}: {done.stderr}"

    return run


@pytest.fixture
def _minutes_in_seconds(monkeypatch):
    """Let trainings on pages take three rollouts or a round, and comparisons two flocks."""
    from stable_baselines3 import PPO

    from flockenv.cli import train_branches
    from flockenv.comparison import case
    from flockenv.training import ppo
    from flockenv.training.branches import BranchTraining

    learn, compare = PPO.learn, case.compare_leaders

    def compared(parameters, leaders, policies, seeds, *others):
        return compare(parameters, leaders, policies, seeds[:2], *others)

    monkeypatch.setattr(
        PPO,
        "learn",
        lambda model, _, *others, **options: learn(
            model, 3 * model.n_steps * model.n_envs, *others, **options
        ),
    )
    monkeypatch.setattr(case, "compare_leaders", compared)
    ended = property(lambda training: len(training.curve["flock_hours"]) > 0)
    monkeypatch.setattr(BranchTraining, "has_ended", ended)
    for each in (ppo, train_branches):
        judge = each.compare_with_laws
        monkeypatch.setattr(each, "compare_with_laws", lambda *of, judge=judge: judge(*of[:2], 2))


@pytest.mark.filterwarnings("ignore:PettingZoo in TorchRL is tested")
@pytest.mark.parametrize("page", EXECUTED)
def test_blocks_run(page, tmp_path, monkeypatch, run_shell, request, capsys):
    monkeypatch.chdir(tmp_path)
    known = {*gymnasium.registry}
    request.addfinalizer(lambda: [gymnasium.registry.pop(n) for n in {*gymnasium.registry} - known])
    if page in ("docs/train.md", "docs/extend/task.md"):
        request.getfixturevalue("_minutes_in_seconds")
    parsers = {"python": PythonCodeBlockParser(), "sh": CodeBlockParser("sh", run_shell)}
    chosen = [parsers[language] for language in EXECUTED[page]]
    document = Document.parse(str(REPOSITORY / page), SkipParser(), *chosen)
    run = 0
    for example in document.examples():
        try:
            example.evaluate()
        except NotEvaluated:
            continue
        run += 1
    assert run >= 2
    printed = capsys.readouterr().out.split()
    said = re.findall(
        "^It prints .*", (REPOSITORY / page).read_text(encoding="utf-8"), re.MULTILINE
    )
    numbers = [number for line in said for number in re.findall(r"-?\d+\.\d+", line)]
    assert [number for number in numbers if number not in printed] == []
    assert page != "docs/start.md" or len(numbers) == 4


def test_the_recipe_for_a_step_finds_errors_that_fall_with_it():
    """Law: a shorter step errs less, in the page's flock and in one that presses at its walls.

    Without the half second before, the overlaps of the coarser step count as errors of the finer.
    """
    page = (DOCS / "runs.md").read_text(encoding="utf-8")
    cells = re.findall(r"```\{code-cell\} python\n(.*?)```", page, re.DOTALL)
    (recipe,) = [cell for cell in cells if "advance_with_error" in cell]
    (choice,) = [cell for cell in cells if "wanted_cm" in cell]
    small = {"boat_radius_cm": 4.0, "boat_shape": 1.0, "pool": (150.0, 60.0)}
    slow = {"speed_cm_s": 10.0, "reverse_speed_cm_s": 10.0}
    crowd = flockenv.FlockParameters(n_boats=40, bw_s=0.42, **small, **slow)
    for parameters in (flockenv.FlockParameters(n_boats=27, bw_s=0.2), crowd):
        names = {"flockenv": flockenv, "np": np, "parameters": parameters}
        exec(recipe + choice, names)  # noqa: S102 - the page is ours
        errors_cm = names["errors_cm"]
        steps = sorted(errors_cm, reverse=True)
        assert sorted(errors_cm.values(), reverse=True) == [errors_cm[dt_s] for dt_s in steps]
        assert errors_cm[steps[-1]] < errors_cm[steps[0]] / 10.0


def test_the_call_for_states_names_states():
    """Law: the entry of the states shows a call that works: one of them for each time."""
    page = (DOCS / "questions.md").read_text(encoding="utf-8")
    (entry,) = re.findall(r"^- \*\*(jamming, .*)$", page, re.MULTILINE)
    (call,) = re.findall(r"`(run\..*?)`", entry)
    run = flockenv.simulate(flockenv.FlockParameters(n_boats=8, pool="narrow"), 7, 20.0)
    states = eval(call, {"run": run})  # noqa: S307 - the page is ours
    assert len(states) == len(run)
    known = {*entry.partition("**")[0].split(", "), "between"}
    assert {state.split()[0] for state in states} <= known


def test_the_home_page_opens_with_a_flock():
    home = (DOCS / "index.md").read_text()
    assert home.index('<a href="flock.html">') < home.index("```{toctree}")
    assert 'html_extra_path[0] / "flock.html"' in (DOCS / "conf.py").read_text()
    # A page of this name would take its place.
    assert not (DOCS / "flock.md").exists()


def test_the_readme_names_both_front_doors():
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    assert "\nmake compare " in readme
    assert "\nmake test " in readme


def test_the_readme_is_cited_as_the_citation_file_says():
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```bibtex\n(.*?)```", readme, re.DOTALL)
    cited = dict(
        re.findall(r"^  (\w+) = \{+(.*?)\}+,$", block.partition("@article")[0], re.MULTILINE)
    )
    paper = dict(
        re.findall(r"^  (\w+) = \{(.*?)\},$", block.partition("@article")[2], re.MULTILINE)
    )
    file = (REPOSITORY / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {cited['version']}\n" in file
    assert f"\ndate-released: {cited['year']}-" in file
    assert f"name: {cited['author']}" in file
    for field in ("title", "journal", "year", "pages", "doi"):
        assert paper[field] in file
    names = re.findall(r"family-names: (.+), given-names: (.+)\}", file)
    assert paper["author"] == " and ".join(map(", ".join, names))


def test_every_public_name_has_a_reference():
    reference = "".join(page.read_text() for page in (DOCS / "reference").glob("*.md"))
    documented = re.findall(r"\.\. auto(?:class|exception|function):: ([\w.]+)", reference)
    names = {name.rpartition(".")[2] for name in documented}
    wanted = {*flockenv.__all__, *flockenv.policies.__all__} - {"__version__", "policies"}
    assert sorted(wanted - names) == []


def test_nothing_is_installed_by_a_name_that_is_not_ours_yet():
    """Anybody may take the name on the index until then: a release flips the constant."""
    name = r"""(?<![\w./-])flockenv(?=[\[\s"'`]|$)"""
    by_name = re.compile(rf"pip install [^`\n]*?{name}", re.MULTILINE)
    pages = [REPOSITORY / "README.md", *DOCS.glob("[!_]*/*.md"), *DOCS.glob("*.md")]
    pages += REPOSITORY.glob("flockenv/**/*.py")
    named = [page.name for page in pages if by_name.search(page.read_text("utf-8"))]
    assert by_name.search("pip install 'flockenv[train]'")
    assert not by_name.search('pip install "flockenv-0.1.0-cp311-abi3-….whl[plot]"')
    message = extras.install("plot")
    if extras.IS_PUBLISHED:
        assert by_name.search(message)
    else:
        assert named == ["extras.py"]
        assert not by_name.search(message)
        assert ".[plot]" in message
