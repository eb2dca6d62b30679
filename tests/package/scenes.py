"""Print a digest of each of 200 random scenes, for two builds of the core to agree on.

Pools, obstacles, hulls, schemes and noises are drawn, and what does not fit is drawn again. Leaders
follow the law or a rudder.
"""

import hashlib
import math
import sys

import numpy as np

import flockenv
from flockenv import FlockError, FlockParameters
from flockenv.envs.observation import observe

SCENES = 200


def parameters_of(random: np.random.Generator) -> FlockParameters:
    """Draw the parameters of a scene; a ParameterError refuses some combinations."""
    outer = random.uniform(90.0, 200.0)
    pools = ["wide", "narrow", (outer, random.uniform(0.0, 0.5) * outer), (outer, 0.0)]
    n_boats = int(random.integers(2, 40))
    fields = {
        "n_boats": n_boats,
        "n_leaders": int(random.integers(0, min(n_boats, 5))),
        "pool": pools[random.integers(len(pools))],
        "bw_s": random.uniform(0.0, 1.5),
        "dt_s": random.choice([0.01, 0.02, 0.05]),
        "scheme": str(random.choice(["leapfrog", "moreau", "paper"])),
        "noise_scheme": str(random.choice(["white", "per-step"])),
        "speed_cm_s": random.uniform(10.0, 30.0),
        "boat_shape": random.choice([0.0, 1.0, 2.0]),
        "turning_bias": random.choice([0.0, 0.1]),
        "tolerance_cm": float([math.inf, 1e-6, 1e-9][random.integers(0, 3)]),
    }
    if random.random() < 0.3:
        fields["discs"] = [(*random.uniform(-60.0, 60.0, 2), random.uniform(3.0, 10.0))]
    if random.random() < 0.3:
        fields["walls"] = [tuple(random.uniform(-70.0, 70.0, 4))]
    return FlockParameters(**fields)


def digest(seed: int) -> str:
    """Return the hash of a scene's numbers after some seconds."""
    random = np.random.default_rng(seed)
    while True:
        try:
            flock = flockenv.Flock(parameters_of(random), seed)
        except FlockError:
            continue
        break
    hashed = hashlib.sha256()
    leaders = flock.parameters.n_leaders
    for _ in range(6):
        rudder = random.uniform(-1.0, 1.0, leaders) if random.random() < 0.5 else None
        try:
            flock.advance(0.5, rudder)
        except FlockError as error:
            hashed.update(str(error).encode())
        order = flock.order_parameters()
        hashed.update(flock.pose.tobytes() + flock.velocity.tobytes() + flock.snapshot())
        hashed.update(repr(order).encode())
        if leaders:
            hashed.update(observe(flock).tobytes())
    return hashed.hexdigest()


if __name__ == "__main__":
    for scene in range(int(sys.argv[1]) if len(sys.argv) > 1 else SCENES):
        sys.stdout.write(f"{scene} {digest(scene)}\n")
