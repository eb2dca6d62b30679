"""Law: a finished run is always written, nothing that a user gave is written over, and commands at
work in one folder do not disturb each other."""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest

import flockenv
from flockenv.cli import output
from flockenv.comparison import case
from flockenv.comparison.figure import policy_colors
from flockenv.errors import ParameterError

TINY = ["-q", "--minutes", "0.02", "--set", "n_boats=3"]
SHORT = ["-q", "--episodes", "2", "--minutes", "0.1", "--out", "c"]
EPISODES = [*SHORT, "--pool", "narrow", "--set", "n_boats=5"]


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_checking_a_folder_leaves_alone_what_another_command_makes_meanwhile(monkeypatch):
    folder = Path("results", "new")
    probe = output.TemporaryFile

    def with_another_command(dir):  # noqa: A002 - the name of the argument that is passed
        folder.mkdir(parents=True, exist_ok=True)
        return probe(dir=dir)

    monkeypatch.setattr(output, "TemporaryFile", with_another_command)
    output.check_folder(folder)
    assert folder.is_dir()


def test_commands_at_once_write_into_one_new_folder():
    folder, together = Path("a", "b", "c"), Barrier(8)

    def command(number: int) -> None:
        path = folder / f"{number}.txt"
        together.wait()
        output.check_file(path)
        output.keep(path, lambda path: path.write_text("done"))

    for _ in range(20):
        with ThreadPoolExecutor(8) as pool:
            list(pool.map(command, range(8)))
        assert len(list(folder.iterdir())) == 8
        for each in folder.iterdir():
            each.unlink()
        os.removedirs(folder)


def test_a_folder_whose_name_is_too_long_is_refused_before_work():
    with pytest.raises(ParameterError, match=r"cannot be written: File name too long"):
        output.check_folder(Path("a" * 300))


def test_a_run_whose_folder_was_taken_away_is_kept_elsewhere(cli, tmp_path, monkeypatch):
    simulate = sys.modules["flockenv.cli.run"].simulate

    def meanwhile(*arguments, **options):
        Path("results").write_text("a file by now")
        return simulate(*arguments, **options)

    monkeypatch.setattr(sys.modules["flockenv.cli.run"], "simulate", meanwhile)
    done = cli("run", *TINY)
    assert done.returncode == 2
    (stored,) = tmp_path.glob("flockenv-*/run.npz")
    assert str(stored) in done.stderr
    assert "results/run.npz cannot be written" in done.stderr
    assert len(flockenv.Recording.load(stored)) == 13
    assert stored.with_suffix(".toml").is_file()


def test_a_comparison_whose_folder_was_taken_away_is_kept_elsewhere(cli, tmp_path, monkeypatch):
    compare_leaders = case.compare_leaders

    def meanwhile(*arguments, **options):
        Path("c").write_text("a file by now")
        return compare_leaders(*arguments, **options)

    monkeypatch.setattr(case, "compare_leaders", meanwhile)
    done = cli("compare", *EPISODES, "--leaders", "0-1", "--only", "--policy", "straight ahead")
    assert done.returncode == 2
    (stored,) = tmp_path.glob("flockenv-*/c")
    assert str(stored) in done.stderr.replace("\n", "")
    assert {"runs.csv", "leader_curve.png", "run.toml"} <= {each.name for each in stored.iterdir()}


def test_what_cannot_be_kept_anywhere_says_so(monkeypatch, tmp_path):
    def full(path):
        raise OSError(28, "No space left on device")

    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(output, "gettempdir", lambda: str(tmp_path))
    words = "No space left on device, and no other folder can be written"
    with pytest.raises(ParameterError, match=words):
        output.keep(Path("run.npz"), full)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "given"),
    [
        (["run", *TINY, "--params", "X.toml", "--out", "X.npz"], "--params X.toml"),
        (["run", *TINY, "--params", "X.toml", "--out", "sub/../X.npz"], "--params X.toml"),
        (["run", *TINY, "--params", "link.toml", "--out", "X.npz"], "--params link.toml"),
        (["run", *TINY, "--policy", "p.npz", "--out", "p.npz"], "--policy p.npz"),
        (["compare", *SHORT, "--params", "c/narrow-bw-1.toml"], "--params c/narrow-bw-1.toml"),
    ],
)
def test_what_the_user_gave_is_not_written_over(cli, arguments, given, tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "narrow-bw-1.toml").write_text('n_boats = 5\npool = "narrow"\nbw_s = 1.0\n')
    (tmp_path / "X.toml").write_text("n_boats = 5  # my own words\n")
    (tmp_path / "link.toml").hardlink_to(tmp_path / "X.toml")
    size = len(flockenv.envs.observation.observation_entries())
    flockenv.policies.NetworkPolicy([[[0.0]] * size], [[0.0]]).save(tmp_path / "p.npz")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*")}
    done = cli(*arguments)
    assert done.returncode == 2
    assert f"{given} is where results would be written" in done.stderr.replace("\n", " ")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*")} == before


def test_names_that_are_no_utf_8_replay(cli, tmp_path):
    name = os.fsdecode(b"\xff\xfe run.npz")
    try:
        Path(name).touch()
        Path(name).unlink()
    except OSError:
        pytest.skip("this file system takes UTF-8 names only")
    done = cli("run", *TINY, "--out", name)
    assert done.returncode == 0, done.stderr
    done = cli("replay", name, "-q", "--html", "page.html")
    assert done.returncode == 0, done.stderr
    assert "<title>\ufffd\ufffd run" in Path("page.html").read_text("utf-8")
    for title in (name, "[/b] $x$ <b>"):
        done = cli("replay", name, "-q", "--html", "page.html", "--name", title)
        assert done.returncode == 0, done.stderr


def test_policies_may_have_any_name(cli, tmp_path, colors_in):
    size = len(flockenv.envs.observation.observation_entries())
    policy = flockenv.policies.NetworkPolicy([[[0.1]] * size], [[0.0]])
    names = ["x[/b] $a_{ $.npz", "_under.npz", os.fsdecode(b"\xff.npz")]
    (tmp_path / "x[").mkdir()
    for name in names:
        try:
            policy.save(tmp_path / name)
        except OSError:
            pytest.skip("this file system takes UTF-8 names only")
    wanted = [word for name in names for word in ("--policy", name)]
    done = cli("compare", *EPISODES, "--leaders", "0-1", "--only", *wanted)
    assert done.returncode == 0, done.stderr
    first = "b] $a_{ $"
    assert "a_{" in done.stdout
    (color,) = policy_colors([first]).values()
    assert color in colors_in(tmp_path / "c" / "leader_curve.png")
    assert "\ufffd" in (tmp_path / "c" / "run.toml").read_text("utf-8")
    assert (tmp_path / "c" / "card.md").read_text("utf-8").startswith(f"# {first}\n")
    done = cli("run", *TINY, "--set", "n_leaders=1", "--policy", names[2])
    assert done.returncode == 0, done.stderr
