"""Law: what cannot be written is said before work, and files and policies may have any name."""

import os
from pathlib import Path

import pytest

import flockenv
from flockenv.cli.output import prepare
from flockenv.errors import ParameterError

TINY = ["-q", "--minutes", "0.02", "--set", "n_boats=3"]


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_files_are_prepared_or_refused(tmp_path):
    Path("file").touch()
    for path, words in (
        (Path("file"), "file already exists: --force overwrites it"),
        (tmp_path, "it is a folder"),
        (Path("file", "a.npz"), "a.npz cannot be written: "),
        (Path("a" * 300, "a.npz"), "a.npz cannot be written: File name too long"),
    ):
        with pytest.raises(ParameterError, match=words):
            prepare(path, overwrites=False)
    prepare(Path("file"), Path("a", "b", "new.npz"))
    assert {path.name for path in tmp_path.rglob("*")} == {"a", "file", "b"}


def written(name: str) -> str:
    """A file's name that this file system takes, with a file of a policy in it."""
    size = len(flockenv.envs.observation.observation_entries())
    try:
        Path(name).parent.mkdir(exist_ok=True)
        flockenv.policies.NetworkPolicy([[[0.1]] * size], [[0.0]]).save(name)
    except OSError:
        pytest.skip("this file system takes UTF-8 names only")
    return name


def test_recordings_may_have_any_name(cli):
    name = written(os.fsdecode(b"\xff\xfe run.npz"))
    cli.succeeds("run", *TINY, "--force", "--out", name)
    for title in (name, "[/b] $x$ <b>"):
        cli.succeeds("replay", name, "-q", "--html", "page.html", "--name", title)
    cli("replay", name, "-q", "--html", "page.html")
    assert "<title>\ufffd\ufffd run" in Path("page.html").read_text("utf-8")


def test_policies_may_have_any_name(cli):
    names = list(map(written, ["x[/b] $a_{ $.npz", "_under.npz", os.fsdecode(b"\xff.npz")]))
    short = ["-q", "--episodes", "2", "--minutes", "0.1", "--pool", "narrow", "--set", "n_boats=5"]
    wanted = [word for name in names for word in ("--policy", name)]
    done = cli.succeeds("compare", *short, "--n-leaders", "0-1", "--only", *wanted, "--out", "c")
    assert "a_{" in done.stdout
    assert "\ufffd" in Path("c", "run.toml").read_text("utf-8")
    assert Path("c", "card.md").read_text("utf-8").startswith("# b] $a_{ $\n")
    assert Path("c", "leader_curve.png").stat().st_size > 0
