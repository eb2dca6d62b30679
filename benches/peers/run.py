"""Lets Drake, pymunk and MuJoCo work off the tasks: ``run.py FILES YARDSTICK``.

FILES is the folder of ``tasks.json``; ``results.json`` and the recorded states go there too.
YARDSTICK is the program that times rapier2d-f64 after every timed run, so that ratios are taken
close in time. Only the engines' step calls are timed, not the forces, which Python works out.
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
# Twelve seeds of twenty minutes are 1.4 million steps of a millisecond: longer than all the rest.
LEAVES_ORDER_OUT = {drake_engine.NAME}


def run(files: Path, job: tuple[str, str, int], task: dict) -> dict:
    """One task by one engine: where its records are, how long steps took, what the wall carried."""
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
            called_s = time.perf_counter()
            engine.step()
            spent += time.perf_counter() - called_s
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
    """Default settings work off everything, others those of the middle step."""
    jobs = []
    for name, module in ENGINES.items():
        for place, setting in enumerate(module.SETTINGS):
            for number, task in enumerate(tasks):
                if task["measure"] == "order" and name in LEAVES_ORDER_OUT:
                    continue
                is_short = task["measure"] != "order" and task["dt_s"] == STEP_S
                if place == 0 or is_short:
                    jobs.append((name, setting, number))
    return jobs


def main() -> None:
    """Timed tasks one after another, then the others on all cores."""
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
        rest = [job for job in reversed(jobs) if not tasks[job[2]]["block_steps"]]
        rest.sort(key=lambda job: tasks[job[2]]["measure"] != "order")
        waiting = [pool.submit(run, arguments.files, job, tasks[job[2]]) for job in rest]
        results.extend(future.result() for future in waiting)
    (arguments.files / "results.json").write_text(json.dumps(results))
    versions = {name: version(name) for name in ("pymunk", "mujoco", "drake", "numpy")}
    (arguments.files / "versions.json").write_text(json.dumps(versions))


if __name__ == "__main__":
    main()
