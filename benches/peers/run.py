"""Run the tasks in Drake, pymunk and MuJoCo: ``run.py FILES YARDSTICK``.

FILES is the folder of ``tasks.json``; ``results.json`` and the recorded states go there too.
YARDSTICK is the program that times rapier2d-f64 after every timed run, so that ratios compare times
close to each other. Only the engines' step calls are timed, not the forces, which Python computes.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import time
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from pathlib import Path

import drake_engine
import mujoco_engine
import numpy as np
import pymunk_engine

ENGINES = {module.NAME: module for module in (pymunk_engine, mujoco_engine, drake_engine)}
STEP_S = 0.01
# In Drake the order tasks take 1.4 million steps of about 1 ms, longer than all other tasks.
SKIPS_ORDER = {drake_engine.NAME}


def run(files: Path, job: tuple[str, str, int], task: dict) -> dict:
    """Run a task in an engine; return its file of records, times of steps and mean wall force."""
    name, setting, number = job
    records, blocks, forces = [], [], []
    for start in task["starts"]:
        engine = ENGINES[name].Engine(task, start, setting)
        for _ in range(task["warm_up_steps"]):
            engine.push()
            engine.step()
        spent = 0.0
        for step in range(1, task["steps"] + 1):
            engine.push()
            start_s = time.perf_counter()
            engine.step()
            spent += time.perf_counter() - start_s
            if task["measure"] == "wall_push":
                forces.append(engine.wall_force())
            if step % task["record_every"] == 0:
                records.append(np.array(engine.state()))
            if task["block_steps"] and step % task["block_steps"] == 0:
                blocks.append(1e6 * spent / task["block_steps"])
                spent = 0.0
    file = f"{name}-{setting}-{number}.f64".replace(" ", "-")
    np.array(records, dtype="<f8").tofile(files / file)
    return {
        "engine": name,
        "setting": setting,
        "task": number,
        "file": file,
        "block_us": blocks,
        "yardstick_us": None,
        "wall_force": float(np.mean(forces)) if forces else 0.0,
    }


def jobs_of(tasks: list[dict]) -> list[tuple[str, str, int]]:
    """Return the jobs: all tasks for default settings, short ones at `STEP_S` for others."""
    jobs = []
    for name, module in ENGINES.items():
        for index, setting in enumerate(module.SETTINGS):
            for number, task in enumerate(tasks):
                if task["measure"] == "order" and name in SKIPS_ORDER:
                    continue
                is_short = task["measure"] != "order" and task["dt_s"] == STEP_S
                if index == 0 or is_short:
                    jobs.append((name, setting, number))
    return jobs


def main() -> None:
    """Run the timed tasks one after another, then the others on all cores."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", type=Path)
    parser.add_argument("yardstick", type=Path)
    arguments = parser.parse_args()
    tasks = json.loads((arguments.files / "tasks.json").read_text())
    results = []
    jobs = jobs_of(tasks)
    for job in jobs:
        task = tasks[job[2]]
        if task["block_steps"]:
            result = run(arguments.files, job, task)
            command = [arguments.yardstick, "yardstick", task["scene"]]
            printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            result["yardstick_us"] = float(printed.split()[1])
            results.append(result)
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        # The longest first, so that no core waits at the end.
        untimed = [job for job in reversed(jobs) if not tasks[job[2]]["block_steps"]]
        untimed.sort(key=lambda job: tasks[job[2]]["measure"] != "order")
        futures = [pool.submit(run, arguments.files, job, tasks[job[2]]) for job in untimed]
        results.extend(future.result() for future in futures)
    (arguments.files / "results.json").write_text(json.dumps(results))
    versions = {name: version(name) for name in ("pymunk", "mujoco", "drake", "numpy")}
    (arguments.files / "versions.json").write_text(json.dumps(versions))


if __name__ == "__main__":
    main()
