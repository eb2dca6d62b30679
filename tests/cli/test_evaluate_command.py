"""`flockenv evaluate` compares one policy with others on the same seeds, and writes its card."""

import json
from pathlib import Path

import numpy as np

from flockenv.comparison.figure import policy_colors
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy

SHORT = ["--episodes", "3", "--minutes", "0.5", "--set", "n_boats=8", "--pool", "narrow"]


def learned(folder: Path) -> str:
    size = len(observation_entries())
    policy = NetworkPolicy(
        [np.zeros((size, 1))], [[0.25]], provenance={"command": "by hand", "seed": "7"}
    )
    policy.save(folder / "leaning.npz")
    return str(folder / "leaning.npz")


def test_the_card_reports_what_made_it_and_how_it_compares(cli, tmp_path: Path, colors_in) -> None:
    out = tmp_path / "out"
    arguments = ["--leaders", "2", "--bw-s", "0.2", "--bw-s", "0.4", "--out", str(out)]
    done = cli("evaluate", learned(tmp_path), *SHORT, *arguments)
    assert done.returncode == 0, done.stderr
    card = (out / "card.md").read_text("utf-8")
    assert card.startswith("# leaning\n")
    for text in (
        "by hand",
        "narrow-bw-0.2",
        "narrow-bw-0.4",
        "| tuned damped law | 2 |",
        "seeds 0 to 2",
    ):
        assert text in card
    colors = policy_colors(["leaning.npz", "steering law", "tuned damped law"])
    assert colors_in(out / "narrow-bw-0.4" / "leader_curve.png") == {*colors.values()}


def test_alternating_targets_and_drop_outs(cli, tmp_path: Path) -> None:
    arguments = ["--leaders", "1", "--alternate", "--dropout-rate", "0.01", "--json"]
    out = ["--against", "straight ahead", "--out", str(tmp_path)]
    done = cli("evaluate", "damped law", *SHORT, *arguments, *out)
    assert done.returncode == 0, done.stderr
    assert "alternating targets, 1 % of positions dropped" in (tmp_path / "card.md").read_text()
    (row,) = json.loads(done.stdout)["narrow-bw-0.45"]
    assert (row["policy"], row["reference"], row["n"]) == ("damped law", "straight ahead", 3)
    assert row["low"] <= row["mean"] <= row["high"]


def test_a_policy_that_is_a_default_reference_is_left_out_there(cli, tmp_path: Path) -> None:
    arguments = ["--leaders", "1", "--json", "--out", str(tmp_path)]
    done = cli("evaluate", "steering law", *SHORT, *arguments)
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["narrow-bw-0.45"]
    assert (row["policy"], row["reference"]) == ("steering law", "tuned damped law")


def test_a_file_called_like_a_reference_is_not_it(cli, tmp_path: Path) -> None:
    file = Path(learned(tmp_path)).rename(tmp_path / "learned.npz")
    arguments = ["--against", "learned", "--leaders", "1", "--json", "--out", str(tmp_path)]
    done = cli("evaluate", str(file), *SHORT, *arguments)
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["narrow-bw-0.45"]
    assert (row["policy"], row["reference"]) == (str(file), "learned")


def test_the_card_of_the_law_at_every_substep(cli, tmp_path: Path) -> None:
    arguments = ["--against", "straight ahead", "--leaders", "1", "--out", str(tmp_path)]
    done = cli("evaluate", "steering law at every substep", *SHORT, *arguments)
    assert done.returncode == 0, done.stderr
    card = (tmp_path / "card.md").read_text("utf-8")
    assert "The policy is the paper's law, eq. (10), from the pose at every substep." in card


def test_errors_are_named(cli, tmp_path: Path) -> None:
    (tmp_path / "broken.npz").write_bytes(b"PK nothing")
    for arguments, words in (
        (["dampd law"], "did you mean 'damped law'"),
        (["damped law", "--against", "damped law"], "both the policy"),
        (["damped law", "--bw-s", "0.31", "--bw-s", "0.3100000001"], "beside 0.31"),
        ([str(tmp_path / "broken.npz")], "broken.npz"),
        ([str(tmp_path / "missing.npz")], "missing.npz"),
        (
            ["straight ahead", "--against", "steering law at every substep", "--alternate"],
            "options",
        ),
    ):
        done = cli("evaluate", *arguments, *SHORT, "--out", str(tmp_path / "out"))
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
        assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_what_ships_for_a_pool(cli, tmp_path: Path) -> None:
    out = ["--out", str(tmp_path / "out")]
    done = cli("evaluate", "learned", *out)
    assert done.returncode == 2
    assert "another policy in each pool" in done.stderr
    assert not (tmp_path / "out").exists()
    done = cli("evaluate", "learned", *SHORT, "--leaders", "1", *out)
    assert done.returncode == 0, done.stderr
    assert "baselines/" in (tmp_path / "out" / "card.md").read_text("utf-8")
    done = cli("evaluate", "learned", "--set", "pool=[90.0, 20.0]", "--bw-s", "0.3", *out)
    assert done.returncode == 2
    assert "tuned and learned leaders are for wide, narrow" in done.stderr
