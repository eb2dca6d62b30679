"""Law: docs/sweep.slurm makes shards that never overlap, whatever array and cores Slurm gives.

`flockenv` is a script here that prints its words; test_slurm.py runs the recipe on a real Slurm.
"""

import subprocess
from pathlib import Path

import pytest

RECIPE = Path(__file__).parents[2] / "docs" / "sweep.slurm"


@pytest.fixture
def recipe(tmp_path: Path):
    """Run the recipe with variables as Slurm sets them; return the words that flockenv gets."""
    printing = tmp_path / "flockenv"
    printing.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    printing.chmod(0o755)

    def run(*arguments: str, **variables: object) -> list[str]:
        environment = {name: str(value) for name, value in variables.items()}
        environment["PATH"] = f"{tmp_path}:/usr/bin:/bin"
        words = ["bash", str(RECIPE), "my spec.toml", "out", *arguments]
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    return run


#: Arrays as they are asked for, with the tasks that they have.
ARRAYS = {
    "1-8": range(1, 9),
    "3,5": [3, 5],
    "0-7": range(8),
    "0": [0],
    "7": [7],
    "1-9:2": range(1, 10, 2),
    "2,30,4": [2, 4, 30],
    "0,3": [0, 3],
}


@pytest.mark.parametrize("array", ARRAYS)
def test_each_task_has_a_shard_of_its_own(recipe, array):
    tasks = ARRAYS[array]
    given = {"SLURM_ARRAY_TASK_COUNT": len(tasks), "SLURM_CPUS_PER_TASK": 4}
    given |= {"SLURM_ARRAY_TASK_MIN": min(tasks), "SLURM_ARRAY_TASK_MAX": max(tasks)}
    shards = []
    for task in tasks:
        words = recipe(SLURM_ARRAY_TASK_ID=task, **given)
        assert words[:5] == ["sweep", "my spec.toml", "--out", "out", "--quiet"]
        assert words[-2:] == ["--workers", "4"]
        shards.append(words[words.index("--shard") + 1].split("/"))
    numbers, counts = zip(*(map(int, shard) for shard in shards), strict=True)
    assert len(set(counts)) == 1
    assert len(set(numbers)) == len(tasks)
    assert all(1 <= number <= counts[0] for number in numbers)
    if array in ("1-8", "0-7", "0"):
        assert counts[0] == len(tasks), "whole arrays make all shards"


def test_some_tasks_again_make_the_shards_of_the_whole_array(recipe):
    for task in (3, 5):
        given = {"SLURM_ARRAY_TASK_MIN": 3, "SLURM_ARRAY_TASK_MAX": 5, "SLURM_ARRAY_TASK_COUNT": 2}
        words = recipe("8", SLURM_ARRAY_TASK_ID=task, **given)
        assert words[words.index("--shard") + 1] == f"{task}/8"


@pytest.mark.parametrize(
    ("variables", "workers"),
    [
        ({"SLURM_CPUS_PER_TASK": 2, "SLURM_CPUS_ON_NODE": 64}, ["--workers", "2"]),
        ({"SLURM_CPUS_ON_NODE": 3}, ["--workers", "3"]),
        ({}, []),
    ],
)
def test_without_cores_for_each_task_all_of_the_job_are_used(recipe, variables, workers):
    assert recipe(**variables) == ["sweep", "my spec.toml", "--out", "out", "--quiet", *workers]
