"""`flockenv sweep` writes one table, goes on where it was, and refuses mistakes in one line."""

import json
from pathlib import Path

from flockenv.runs.sweep import load_sweep

SPEC = "minutes = 0.5\nseeds = 2\n[[grid]]\nn_boats = [5, 6]\nbw_s = [0.0, 0.4]\n"


def test_the_table_and_the_files(cli, tmp_path: Path) -> None:
    spec = tmp_path / "noise.toml"
    spec.write_text(SPEC)
    out = tmp_path / "out"
    done = cli("sweep", str(spec), "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert "8 runs" in done.stdout
    table = load_sweep(out)
    assert table[["n_boats", "bw_s", "seed"]].drop_duplicates().shape == (8, 3)
    before = (out / "sweep.csv").read_bytes()
    again = cli("sweep", str(spec), "--out", str(out), "--engine", "joblib", "--json")
    assert again.stderr == ""
    assert len(json.loads(again.stdout)) == 8
    assert (out / "sweep.csv").read_bytes() == before


def test_errors_are_one_line_with_exit_code_2(cli, tmp_path: Path) -> None:
    spec = tmp_path / "noise.toml"
    for text, words in ((SPEC.replace("bw_s", "bws"), "bw_s"), ("", "grid")):
        spec.write_text(text)
        done = cli("sweep", str(spec), "--out", str(tmp_path / "out"))
        assert done.returncode == 2
        assert words in done.stderr
        assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()
