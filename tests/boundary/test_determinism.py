"""Law: the same seed gives the same bits, in any process, on any number of threads."""

import hashlib
import os
import subprocess
import sys

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
