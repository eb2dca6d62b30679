"""The recipe of docs/sweep.slurm on a real Slurm: an array, one job of it requeued, the table."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.slurm

RECIPE = Path(__file__).parents[2] / "docs" / "sweep.slurm"
SPEC = "minutes = 20\nseeds = 12\nkeep = 'order'\n[[grid]]\nn_boats = [20]\nbw_s = [0.0, 0.4]\n"
BIN = str(Path(sys.executable).parent)


def call(environment: dict[str, str], *command: str) -> str:
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def submit(environment: dict[str, str], folder: Path, *options: str) -> str:
    outputs = ["--cpus-per-task=1", f"--output={folder}/%A-%a.txt", "--chdir", str(folder)]
    arguments = [str(RECIPE), "spec.toml", "out"]
    return call(environment, "sbatch", "--parsable", *outputs, *options, *arguments)


def states(environment: dict[str, str], job: str) -> set[str]:
    lines = call(
        environment, "squeue", "--noheader", "--states=all", f"--jobs={job}", "--format=%T"
    )
    return set(lines.split())


def test_a_requeued_array_makes_the_whole_table(slurm: dict[str, str], tmp_path: Path) -> None:
    environment = slurm | {"PATH": f"{BIN}:{slurm['PATH']}"}
    (tmp_path / "spec.toml").write_text(SPEC)
    array = submit(environment, tmp_path, "--array=1-4")
    table = submit(environment, tmp_path, f"--dependency=afterany:{array}")
    stored = lambda: len(list((tmp_path / "out").rglob("*.npz")))  # noqa: E731
    deadline = time.monotonic() + 300
    while stored() < 2:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    call(environment, "scontrol", "requeue", f"{array}_1")
    assert stored() < 24
    while states(environment, table) != {"COMPLETED"}:
        assert time.monotonic() < deadline, call(environment, "squeue", "--states=all")
        time.sleep(0.5)
    assert states(environment, array) == {"COMPLETED"}
    assert call(environment, "scontrol", "show", "job", f"{array}_1").count("Restarts=1") == 1

    alone = [f"{BIN}/flockenv", "sweep", "spec.toml", "--out", "alone", "--quiet"]
    subprocess.run(alone, cwd=tmp_path, check=True)
    for name in ("sweep.csv", "sweep.parquet"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
