"""Analyze and replay your own tracks: `python examples/own_tracks.py`.

The tracks are arrays: times (t,) in s and poses (t, n, 3), x and y in cm from the pool's center and
the heading in rad. Rows of NaN are boats that were not seen. Here 12 points circle with some noise.
"""

from pathlib import Path

import numpy as np

import flockenv
from flockenv.replay import write_replay
from flockenv.tracks import recording_of

out = Path("results/own_tracks")
out.mkdir(parents=True, exist_ok=True)

random = np.random.default_rng(7)
time_s = np.arange(0.0, 60.0, 0.2)
angle = -0.1 * time_s[:, None] + np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
x_cm, y_cm = 70.0 * np.cos(angle), 70.0 * np.sin(angle)
heading = angle - np.pi / 2 + random.normal(0.0, 0.3, angle.shape)
pose = np.stack([x_cm, y_cm, heading], axis=-1)
pose[random.random(angle.shape) < 0.01] = np.nan  # a camera loses a boat now and then

robots = recording_of(time_s, pose, pool="narrow")
print(f"mean Ψ_o {robots.order.psi_o.mean():.2f}, rotation {robots.order.rotation().mean():+.2f}")
robots.save(out / "robots.npz")
robots.to_dataframe().to_csv(out / "order.csv", index=False)

model = flockenv.simulate(
    flockenv.FlockParameters(n_boats=12, pool="narrow", bw_s=0.3), seed=7, duration_s=60.0
)
write_replay(out / "beside.html", {"robots": robots, "model": model})
print(f"Written to {out / 'beside.html'}")
