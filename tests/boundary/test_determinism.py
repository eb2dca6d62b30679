"""Law: the same seed gives the same bits, in any process, on any number of threads."""

import hashlib
import os
import subprocess
import sys

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
