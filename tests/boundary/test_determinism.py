"""Law: the same seed gives the same bits, in any process, on any number of threads."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

import flockenv

SCRIPT = """
import hashlib, flockenv
p = flockenv.FlockParameters(n_boats=20, n_leaders=2, pool="narrow")
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
    p = flockenv.FlockParameters(n_boats=20, n_leaders=2, pool="narrow")
    here = flockenv.simulate(p, seed=5, duration_s=30.0)
    hashes.add(hashlib.sha256(here.pose.tobytes() + here.velocity.tobytes()).hexdigest())
    assert len(hashes) == 1


def test_a_large_flock_moves_alike_on_any_number_of_threads():
    # Four threads where there are fewer cores, too.
    script = """
import hashlib, flockenv
p = flockenv.FlockParameters(n_boats=240, pool=(219.0, 66.0), nop1_s=0.0, bw_s=0.0, nop2_s=0.0)
for threads in (1, 2, 3, 4):
    run = flockenv.simulate(p, seed=5, duration_s=4.0, threads=threads)
    print(hashlib.sha256(run.pose.tobytes() + run.velocity.tobytes()).hexdigest())
"""
    environment = {**os.environ, "RAYON_NUM_THREADS": "4"}
    command = [sys.executable, "-c", script]
    run = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    hashes = run.stdout.split()
    assert len(hashes) == 4
    assert len(set(hashes)) == 1


def test_a_flock_keeps_its_threads(parameters):
    flock = flockenv.Flock(parameters, 0)
    assert flock.threads == 1
    flock.threads = 3
    flock.restore(flockenv.Flock(parameters, 1).snapshot())
    assert flock.threads == 3
    flock.reset(2)
    assert flock.threads == 3
    for wrong in (0, 1025, -1, 2**70):
        with pytest.raises(flockenv.ParameterError, match="threads"):
            flock.threads = wrong
    for wrong in (True, "2", None):
        with pytest.raises(TypeError, match="threads"):
            flock.threads = wrong
    assert flock.threads == 3


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
