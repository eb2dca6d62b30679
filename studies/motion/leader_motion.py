"""How leaders move: ``python -m studies.motion.leader_motion`` (a minute of one core).

It writes motion.csv, means with 95 % intervals, and draws tracks-wide.png, from flocks with three
leaders over 64 episodes of 8 minutes, seeds 0 to 63, without the first tenth of each.
"""

from collections.abc import Hashable
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import flockenv
from docs.scripts.plots import page_style, write_png
from flockenv import FlockParameters
from flockenv.comparison.figure import policy_colors
from flockenv.statistics import mean_interval
from studies.store import resumed, write_table
from studies.study import run

FOLDER = Path(__file__).parent
POOLS = ("wide", "narrow")
POLICIES = ("paper's law", "tuned law", "learned")
LEADERS, EPISODES, EPISODE_S, SAMPLE_HZ = 3, 64, 480.0, 2.0


def flock(pool: str) -> flockenv.FlockParameters:
    """Return a flock at the pool's critical noise, with leaders that head clockwise."""
    bw_s = flockenv.FlockParameters.critical_bw_s("simulation", pool)
    return flockenv.FlockParameters(n_boats=27, n_leaders=LEADERS, pool=pool, bw_s=bw_s)


def leaders(pool: str, policy: str, seed: int) -> flockenv.Recording:
    """Return an episode."""
    return flockenv.simulate(flock(pool), seed, EPISODE_S, sample_hz=SAMPLE_HZ, policy=policy)


def motion(run: flockenv.Recording, outer_cm: float) -> dict[str, float]:
    """Return means over the leaders and the samples of an episode."""
    after = round(0.1 * EPISODE_S * SAMPLE_HZ)
    (x, y, heading), (vx, vy, _) = (
        np.moveaxis(each[after:, :LEADERS], -1, 0) for each in (run.pose, run.velocity)
    )
    radius = np.hypot(x, y)
    off_wall = outer_cm - radius
    apart = np.hypot(x[:, :, None] - x[:, None], y[:, :, None] - y[:, None])
    next_leader = (apart + np.diag([np.inf] * LEADERS)).min(axis=-1)
    found = {
        "alignment": np.sin(np.arctan2(y, x) - heading),
        "velocity_cm_s": (y * vx - x * vy) / radius,
        "radius_cm": radius,
        "apart_cm": next_leader,
        "at_wall": off_wall < 8.0,
        "beside_wall": (off_wall >= 8.0) & (off_wall < 22.0),
        "beside_leader": next_leader < 20.0,
    }
    return {name: float(values.mean()) for name, values in found.items()}


def draw() -> None:
    """Draw the tracks of leaders over the same two minutes of one seed in `wide`."""
    with mpl.rc_context(page_style()):
        figure = Figure((9.0, 3.4), layout="constrained")
        _draw_tracks(figure)
        write_png(figure, FOLDER / "pictures" / "tracks-wide.png", 110)


def _draw_tracks(figure: Figure) -> None:
    for axes, policy in zip(figure.subplots(1, 3), POLICIES, strict=True):
        pose = leaders("wide", policy, 7).pose[-round(120 * SAMPLE_HZ) :, :LEADERS]
        for radius_cm in FlockParameters(pool="wide").pool_radii_cm:
            axes.add_patch(Circle((0, 0), radius_cm, fill=False, color="0.6"))
        for leader, line in enumerate(("-", "--", ":")):
            axes.plot(*pose[:, leader, :2].T, line, color=policy_colors([policy])[policy])
        axes.plot(pose[0, :, 0], pose[0, :, 1], "k.")
        axes.set(title=policy, aspect="equal", xlim=(-185, 185), ylim=(-185, 185))
        axes.axis("off")


def main() -> None:
    """Write the rows of the table that are missing, and draw the tracks."""
    path = FOLDER / "results" / "motion.csv"
    rows: list[dict[Hashable, object]] = resumed(path).to_dict("records")
    done = {(row["pool"], row["policy"]) for row in rows}
    for pool in POOLS:
        outer_cm = FlockParameters(pool=pool).pool_radii_cm[0]
        for policy in POLICIES if pool == "wide" else POLICIES[:2]:
            if (pool, policy) in done:
                continue
            runs = (leaders(pool, policy, seed) for seed in range(EPISODES))
            found = pd.DataFrame([motion(run, outer_cm) for run in runs])
            row: dict[Hashable, object] = {"pool": pool, "policy": policy}
            for name, values in found.items():
                ends = (str(name), f"{name}_low", f"{name}_high")
                row |= zip(ends, mean_interval(values), strict=True)
            rows.append(row)
            write_table(path, pd.DataFrame(rows))
    draw()


if __name__ == "__main__":
    run(main)
