"""Law: options that contradict each other, or name other files, end a command before it starts."""

import pytest

import flockenv

FILES = [
    (["run", "--out", "run.txt"], "--out run.txt is not accepted: a name that ends in .npz"),
    (["demo", "--out", "page.htm"], "--out page.htm is not accepted: a name that ends in .html"),
    (["analyze", "a.npz", "--out", "a.xls"], "--out a.xls is not accepted: a name that ends in .n"),
    (["analyze", "a.npz", "--plot", "a.xyz"], "--plot a.xyz is not accepted: a name that ends in"),
    (["replay", "a.npz", "--html", "a.gif"], "--html a.gif is not accepted: a name that ends in"),
    (["replay", "a.npz", "--gif", "a.mp4"], "--gif a.mp4 is not accepted: a name that ends in .g"),
    (["replay", "a.npz", "--mp4", "a"], "--mp4 a is not accepted: a name that ends in .mp4"),
]
TOGETHER = [
    (
        ["replay", "a.npz", "--html", "a.html", "--gif", "a.gif"],
        "--html is not accepted with --gif",
    ),
    (["replay", "a.npz", "--gif", "a.gif", "--open"], "--open is not accepted with --gif and"),
    (["replay", "a.npz", "--speed", "2"], "--speed is not accepted with a page"),
    (["replay", "a.npz", "b.npz", "--name", "one"], "1 --name for 2 recordings: name all or none"),
    (["train", "--resume", "--pool", "wide"], "--resume takes settings from the folder"),
    (["train", "--n-boats", "9", "--set", "n_boats=8"], "--n-boats and --set n_boats are both"),
    (["compare", "--only"], "--only is not accepted without --policy"),
    (["compare", "--task", "reversal"], "--task is not accepted without --suite"),
    (["compare", "--policy", "mine:leaders"], "mine:leaders names code"),
    (
        ["compare", "--suite", "v2", "--policy", "mine:leaders", "--trust"],
        "0 --flock-hours for 1 --policy of a file",
    ),
]


@pytest.mark.parametrize(("words", "refusal"), [*FILES, *TOGETHER])
def test_what_contradicts_is_refused_before_anything_is_read(
    cli, tmp_path, monkeypatch, words, refusal
) -> None:
    """None of the recordings is there."""
    monkeypatch.chdir(tmp_path)
    done = cli(*words)
    assert done.returncode == 2
    assert refusal in done.stderr.replace("\n", " ")
    assert list(tmp_path.iterdir()) == []


def test_a_policy_of_ones_own_module_is_run_and_compared(cli, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own_leaders.py").write_text(
        "from flockenv.policies import DampedLaw\n\n\ndef leaders():\n    return DampedLaw(2.0)\n"
    )
    small = ["--n-boats", "6", "--minutes", "0.1", "--policy", "own_leaders:leaders", "--trust"]
    cli.succeeds("run", *small, "--n-leaders", "1", "--out", "run.npz")

    assert flockenv.Recording.load("run.npz").policy.startswith("DampedLaw(gain=2,")
    few = ["--episodes", "2", "--n-leaders", "1", "--only", "--name", "mine", "--out", "out"]
    cli.succeeds("compare", *small, *few)
    assert "DampedLaw(gain=2," in (tmp_path / "out" / "card.md").read_text("utf-8")
