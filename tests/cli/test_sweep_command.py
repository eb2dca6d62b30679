"""`flockenv sweep` writes one table, continues where it was, and refuses mistakes in one line."""

import fcntl
import json
import os
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path

import pandas as pd
import pytest

from flockenv.cli.sweep import _in_units, _show_critical_noises
from flockenv.runs.sweep import load_sweep

SPEC = "minutes = 0.5\nseeds = 2\n[[grid]]\nn_boats = [5, 6]\nbw_s = [0.0, 0.4]\n"


def test_the_table_and_the_files(cli, tmp_path: Path) -> None:
    spec = tmp_path / "noise.toml"
    spec.write_text(SPEC)
    out = tmp_path / "out"
    done = cli.succeeds("sweep", spec, "--out", out)
    assert "8 runs" in done.stdout
    assert "n_boats 5: the noise at which order is lost is unknown" in done.stdout
    table = load_sweep(out)
    assert table[["n_boats", "bw_s", "seed"]].drop_duplicates().shape == (8, 3)
    before = (out / "sweep.csv").read_bytes()
    again = cli("sweep", spec, "--out", out, "--workers", "1", "--json")
    assert again.stderr == ""
    assert len(json.loads(again.stdout)) == 8
    assert (out / "sweep.csv").read_bytes() == before


def test_why_no_critical_noise_is_named(capsys) -> None:
    """Too little rotation, or with enough of it too few runs: one of them, not both."""
    table = pd.DataFrame(
        {"bw_s": [0.0, 0.4], "seed": 0, "psi_o_mean": [0.9, 0.2], "rotation_size": [0.9, 0.1]}
    ).assign(failure="")
    _show_critical_noises(table)
    unknown = "The noise at which order is lost is unknown: it takes three runs"
    assert capsys.readouterr().out.startswith(unknown)
    _show_critical_noises(table.assign(rotation_size=0.45))
    assert capsys.readouterr().out == "No order to lose: mean |m| is 0.45 at most, below 0.5\n"


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.1, "1 s"), (99.4, "99 s"), (100, "2 min"), (6000, "1.7 h")]
)
def test_how_long_a_sweep_takes_is_said_in_units_of_a_clock(seconds, words) -> None:
    assert _in_units(seconds) == words


def test_shards_make_the_table_of_one_command(cli, tmp_path: Path) -> None:
    spec = tmp_path / "noise.toml"
    spec.write_text(SPEC)
    sweep = ["sweep", str(spec), "--quiet", "--workers", "1", "--out"]
    looked = cli(*sweep, tmp_path / "out", "--dry-run", "--shard", "1/2", "--json")
    workload = json.loads(looked.stdout)
    assert 0 < workload["runs"] < 8
    assert workload["stored"] == 0
    assert not (tmp_path / "out").exists()
    for shard in ("1/2", "2/2"):
        done = cli.succeeds(*sweep, tmp_path / "out", "--shard", shard)
        assert f"Shard {shard}" in done.stdout
        assert not (tmp_path / "out" / "sweep.csv").exists()
        stored = len(list((tmp_path / "out").rglob("*.npz")))
        assert stored == (workload["runs"] if shard == "1/2" else 8)
    again = cli(*sweep, tmp_path / "out", "--shard", "1/2", "--json")
    assert json.loads(again.stdout) == {"shard": "1/2", "runs": workload["runs"], "failed": 0}
    for out in ("out", "alone"):
        cli.succeeds(*sweep, str(tmp_path / out))
    for name in ("sweep.csv", "sweep.parquet"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()


def test_runs_that_fail_are_counted_and_end_in_exit_code_1(cli, tmp_path: Path) -> None:
    spec = tmp_path / "crowd.toml"
    spec.write_text('minutes = 0.1\nseeds = 2\n[[grid]]\nn_boats = [6, 400]\npool = ["narrow"]\n')
    sweep = ["sweep", str(spec), "--quiet", "--out", str(tmp_path / "out")]
    done = cli(*sweep)
    assert done.returncode == 1
    assert "2 of 4 runs failed: see the column failure" in done.stderr
    assert "4 runs, written to" in done.stdout
    failure = load_sweep(tmp_path / "out").set_index("n_boats")["failure"]
    assert (failure.loc[6] == "").all()
    assert failure.loc[400].str.contains("do not fit the pool").all()
    printed = cli(*sweep, "--json")
    assert (printed.returncode, len(json.loads(printed.stdout))) == (1, 4)
    shard = cli(*sweep, "--shard", "1/1", "--json")
    assert shard.returncode == 1
    assert json.loads(shard.stdout) == {"shard": "1/1", "runs": 4, "failed": 2}
    assert "2 of 4 runs failed" in shard.stderr


def test_a_folder_holds_one_sweep(cli, tmp_path: Path) -> None:
    """Another design is refused, before anything changes; the same one may be written anew."""
    spec, other, out = tmp_path / "a.toml", tmp_path / "other.toml", tmp_path / "out"
    spec.write_text(SPEC.replace("seeds = 2", "seeds = 1"))
    other.write_text(SPEC.replace("0.4", "0.6"))
    cli.succeeds("sweep", spec, "--out", out)
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    for more in ([], ["--shard", "1/2"], ["--json"]):
        refused = cli("sweep", other, "--out", out, *more)
        assert refused.returncode == 2
        assert "sweep.toml already exists and belongs to another sweep" in refused.stderr.replace(
            "\n", " "
        )
        assert before == {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    # Looking at it changes nothing, and the same design may have another layout.
    cli.succeeds("sweep", other, "--out", out, "--dry-run")
    spec.write_text("# The same.\n" + SPEC.replace("seeds = 2", "seeds = [0]"))
    cli.succeeds("sweep", spec, "--out", out)
    assert (out / "sweep.toml").read_text().startswith("# The same.")
    cli.succeeds("sweep", other, "--out", out, "--force")
    assert (out / "sweep.toml").read_text() == other.read_text()
    (out / "sweep.toml").write_text("no sweep")
    assert cli("sweep", other, "--out", out).returncode == 2


def _with_a_terminal() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # Also under nohup.
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def test_the_end_of_the_terminal_keeps_the_runs_under_way(cli, tmp_path: Path) -> None:
    """Like SIGTERM: the run under way is stored, no other one is started."""
    spec, out = tmp_path / "noise.toml", tmp_path / "out"
    spec.write_text("minutes = 20\nseeds = 40\n[[grid]]\nn_boats = [20]\n")
    master, terminal = os.openpty()
    call = [sys.executable, "-c", cli.CALL, "sweep", str(spec), "--workers", "1", "--out", str(out)]
    process = subprocess.Popen(
        call, stdin=terminal, stdout=terminal, stderr=terminal, start_new_session=True,
        preexec_fn=_with_a_terminal,
    )  # fmt: skip
    os.close(terminal)
    deadline = time.monotonic() + 60

    def stored() -> int:
        return len(list(out.rglob("*.npz")))

    while stored() < 1:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.close(master)
    before = stored()
    process.wait(timeout=60)
    assert process.returncode != -signal.SIGHUP
    assert before < stored() <= before + 2
    assert not list(out.rglob(".*.tmp"))
