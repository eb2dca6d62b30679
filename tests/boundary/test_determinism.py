"""Law: the same seed gives the same bits, in any process, on any number of threads."""

import hashlib
import os
import subprocess
import sys

import numpy as np

import flockenv

SCRIPT = """
import hashlib, flockenv
p = flockenv.FlockParameters(n_boats=20, n_leaders=2, pool="table-1")
run = flockenv.simulate(p, seed=5, duration_s=30.0)
print(hashlib.sha256(run.pose.tobytes() + run.velocity.tobytes()).hexdigest())
"""


def test_processes_and_thread_counts_agree():
    hashes = set()
    for threads in ("1", "2", "7"):
        environment = {**os.environ, "RAYON_NUM_THREADS": threads}
        command = [sys.executable, "-c", SCRIPT]
        run = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
        hashes.add(run.stdout.strip())
    p = flockenv.FlockParameters(n_boats=20, n_leaders=2, pool="table-1")
    here = flockenv.simulate(p, seed=5, duration_s=30.0)
    hashes.add(hashlib.sha256(here.pose.tobytes() + here.velocity.tobytes()).hexdigest())
    assert len(hashes) == 1


def test_seeds_differ(parameters):
    starts = [flockenv.Flock(parameters, seed).pose for seed in (0, 1, 2**64 - 1)]
    assert not np.array_equal(starts[0], starts[1])
    assert not np.array_equal(starts[0], starts[2])


def test_a_recording_without_noise_differs_by_placement_only(parameters):
    quiet = parameters.replace(c4=0.0)
    pose = flockenv.Flock(quiet, 1).pose
    ends = []
    for seed in (1, 2):
        flock = flockenv.Flock(quiet, seed)
        flock.set_state(pose, 0 * pose)
        flock.advance(10.0)
        ends.append(flock.pose)
    assert np.array_equal(*ends)
