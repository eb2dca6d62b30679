"""Law: a page of docs/extend is a patch of this tree. `make extend` also runs its commands."""

import importlib.util
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
FOLDER = REPOSITORY / "docs" / "extend"
spec = importlib.util.spec_from_file_location("follow", FOLDER / "follow.py")
follow = importlib.util.module_from_spec(spec)
spec.loader.exec_module(follow)
PATCHES = sorted(path.stem for path in FOLDER.glob("*.md") if "```diff" in path.read_text("utf-8"))


@pytest.fixture
def tree(tmp_path):
    for folder in ("src", "flockenv", "tests"):
        skipped = shutil.ignore_patterns("__pycache__", "node_modules", "*.so", "*.npz")
        shutil.copytree(REPOSITORY / folder, tmp_path / folder, ignore=skipped)
    return tmp_path


@pytest.mark.parametrize("page", PATCHES)
def test_a_page_can_be_applied(page, tree):
    commands = follow.apply((FOLDER / f"{page}.md").read_text("utf-8"), tree)
    assert any("make build" in each for each in commands)
    assert any("make test-python" in each for each in commands)
    rust = [str(path) for path in tree.glob("src/**/*.rs") if path != tree / "src/lib.rs"]
    style = ["rustfmt", "--edition", "2024", "--check", "--config", "skip_children=true"]
    assert rust
    if shutil.which("rustfmt"):
        done = subprocess.run([*style[:4], *rust], capture_output=True, text=True, check=False)
        assert done.stdout == ""


def test_a_page_that_does_not_fit_is_refused(tmp_path):
    (tmp_path / "a.py").write_text("one\ntwo\none\n")
    page = "```diff\n+++ a.py\n@@\n{}+three\n```\n"
    for before, times in ((" one\n", 2), (" four\n", 0), ("-two\n+two\n one\n one\n", 0)):
        with pytest.raises(follow.PageError, match=f"{times} times"):
            follow.apply(page.format(before), tmp_path)
    assert follow.apply(page.format(" two\n-one\n"), tmp_path) == []
    assert (tmp_path / "a.py").read_text() == "one\ntwo\nthree\n"
    with pytest.raises(follow.PageError, match="already"):
        follow.apply("<!-- new file: a.py -->\n\n```python\nnew\n```\n", tmp_path)
