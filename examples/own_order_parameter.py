"""Measure your own quantity: `python examples/own_order_parameter.py MINUTES`.

A quantity is a function of the recording that returns one number per sample. The recording, its
file and its tables hold these numbers.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import flockenv

minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 4.0
out = Path("results/own_order_parameter")
out.mkdir(parents=True, exist_ok=True)


def neighbor_alignment(run):
    """Return the mean cosine between the headings of each boat and its nearest neighbor."""
    position, heading = run.pose[..., :2], run.pose[..., 2]
    distance = np.linalg.norm(position[:, :, None] - position[:, None], axis=-1)
    distance[:, *np.diag_indices(distance.shape[1])] = np.inf
    neighbor_heading = np.take_along_axis(heading, distance.argmin(axis=2), axis=1)
    return np.cos(heading - neighbor_heading).mean(axis=1)


for bw_s in (0.1, 0.3, 0.6):
    run = flockenv.simulate(
        flockenv.FlockParameters(n_boats=27, pool="wide", bw_s=bw_s),
        seed=7,
        duration_s=60.0 * minutes,
        sample_hz=2.0,
        quantities={"neighbor_alignment": neighbor_alignment},
    )
    run.save(out / f"bw_{bw_s}.npz")
    late = run.analyzed()
    print(f"bw = {bw_s} s: alignment = {late.quantities['neighbor_alignment'].mean():.2f}, "
          f"Ψ_o = {late.order.psi_o.mean():.2f}")  # fmt: skip
    plt.plot(run.time_s, run.quantities["neighbor_alignment"], label=f"bw = {bw_s} s")
plt.xlabel("time (s)")
plt.ylabel("alignment with the nearest neighbor")
plt.legend()
plt.savefig(out / "neighbor_alignment.png")
