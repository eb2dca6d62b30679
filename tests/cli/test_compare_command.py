"""`flockenv compare` prints and writes what it measured, and refuses nonsense in words."""

import json
from pathlib import Path

from flockenv.comparison.figure import policy_colors

BRIEF = ["--episodes", "3", "--minutes", "0.5", "--most-leaders", "1"]
SHORT = [*BRIEF, "--set", "n_boats=8"]


def test_the_table_and_the_files(cli, tmp_path: Path, colors_in) -> None:
    done = cli("compare", *SHORT, "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    colors = {*policy_colors(["steering law", "tuned damped law", "learned"]).values()}
    for pool in ("wide", "narrow"):
        assert f"pool {pool}" in done.stdout
        assert colors_in(tmp_path / pool / "leader_curve.png") == colors
    assert "F = " in done.stdout
    assert "steering law" in done.stdout


def test_json_is_all_that_is_printed(cli, tmp_path: Path) -> None:
    arguments = ["--pool", "narrow", "--json", "--out", str(tmp_path)]
    done = cli("compare", *SHORT, *arguments)
    means = json.loads(done.stdout)["narrow"]
    assert [row["leaders"] for row in means] == [0, 1, 1, 1]
    policies = [row["policy"] for row in means]
    assert policies == ["no leaders", "steering law", "tuned damped law", "learned"]
    assert all(row["psi_o_low"] <= row["psi_o"] <= row["psi_o_high"] for row in means)
    assert done.stderr == ""


def test_a_pool_that_nothing_was_made_for(cli, tmp_path: Path) -> None:
    arguments = ["--set", "pool=[90.0, 30.0]", "--set", "bw_s=0.3", "--out", str(tmp_path)]
    done = cli("compare", *SHORT, *arguments, "--quiet")
    assert done.returncode == 0, done.stderr
    assert "Left out, learned: pool = (90.0, 30.0)" in done.stderr
    assert "steering law" in done.stdout
    assert "tuned" not in done.stdout


def test_errors_are_one_line_with_exit_code_2(cli, tmp_path: Path) -> None:
    for arguments, words in (
        (["--set", "n_boats=2000"], "do not fit"),
        (["--preset", "simulaton"], "simulation"),
        (["--set", "target=left"], "ccw"),
        (["--set", "target=cw,ccw"], "one target"),
        (["--set", "bw_s=-1"], "bw_s"),
    ):
        done = cli("compare", *BRIEF, *arguments, "--out", str(tmp_path))
        assert done.returncode == 2
        assert words in done.stderr
        assert "Traceback" not in done.stderr
    assert not any(tmp_path.iterdir())


def test_presets_lists_every_field(cli) -> None:
    done = cli("presets")
    assert done.returncode == 0
    assert "gyration_radius_cm" in done.stdout
