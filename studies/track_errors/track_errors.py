"""How well a camera's tracks give back the order parameters of a flock whose truth is known.

    python -m studies.track_errors.track_errors    # into results/track_errors.csv
    python -m studies.track_errors.track_errors --out studies/track_errors/results/track_errors.csv

With pixels, headings, missing boats and swaps together, Ψ_o is off by 0.04 and milling by 0.10, in
eight runs of 8 minutes, seeds 0 to 7. All runs take 25 s of one core (results version 5).

Runs of the simulator are seen by a camera: positions in whole pixels, headings with an error,
detections that fail, and names that are exchanged between boats that are close to each other. The
tracks are read as anybody's would be (`flockenv.tracks`), and the quantities of the normal boats
are compared with those of the run.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

import flockenv
from flockenv.statistics.structure import structure_series
from flockenv.tracks import TrackLayout, read_tracks
from studies.store import check_version, write_table
from studies.study import run

QUANTITIES = ("psi_o", "nematic", "milling", "psi_v", "largest_cluster")
LAYOUT = TrackLayout(pool="wide", leaders=("0", "1", "2"), fps=25.0, wrapped=False)


@dataclass(frozen=True)
class Camera:
    """What a camera and its tracker do to the truth.

    Attributes
    ----------
    pixel_cm : float
        Positions are whole multiples of it.
    heading_deg : float
        Standard deviation of the error of a heading.
    missing : float
        Share of detections that fail.
    swaps_per_min : float
        How many pairs of neighbors exchange their names.
    """

    pixel_cm: float = 0.25
    heading_deg: float = 0.0
    missing: float = 0.0
    swaps_per_min: float = 0.0


CAMERAS = {
    "pixels of 2.5 mm": Camera(),
    "and headings ± 3°": Camera(heading_deg=3.0),
    "and 0.3 % missing": Camera(heading_deg=3.0, missing=0.003),
    "and 6 swaps per min": Camera(heading_deg=3.0, missing=0.003, swaps_per_min=6.0),
    "10 % missing": Camera(missing=0.1),
}


def seen(run: flockenv.Recording, camera: Camera, random: np.random.Generator) -> pd.DataFrame:
    """Return the table of a tracker: frame, id, x, y, heading; in cm and rad."""
    pose = run.pose.copy()
    pose[..., :2] = np.rint(pose[..., :2] / camera.pixel_cm) * camera.pixel_cm
    pose[..., 2] += np.radians(camera.heading_deg) * random.standard_normal(pose.shape[:2])
    swaps = random.poisson(camera.swaps_per_min * run.duration_s / 60)
    for sample in np.sort(random.integers(0, len(pose), swaps)):
        boat = random.integers(pose.shape[1])
        distance = np.hypot(*(pose[sample, :, :2] - pose[sample, boat, :2]).T)
        other = distance.argsort()[1]
        pose[sample:, [boat, other]] = pose[sample:, [other, boat]]
    frames, boats = np.divmod(np.arange(pose[..., 0].size), pose.shape[1])
    columns = dict(zip(("x", "y", "heading"), pose.reshape(-1, 3).T, strict=True))
    table = pd.DataFrame({"frame": frames, "id": boats, **columns})
    return table[random.random(len(table)) >= camera.missing]


def quantities(run: flockenv.Recording) -> dict[str, np.ndarray]:
    """Return the compared quantities at each time."""
    every = slice(None, None, 5)
    found = {name: getattr(run.order, name)[every] for name in QUANTITIES[:-1]}
    clusters = structure_series("largest_cluster", run.parameters, run.pose[every])
    return found | {"largest_cluster": clusters}


def main() -> None:
    """Measure, print and write the errors."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--minutes", type=float, default=8.0)
    parser.add_argument("--out", type=Path, default=Path("results/track_errors.csv"))
    options = parser.parse_args()
    check_version(options.out)
    bw_s = flockenv.FlockParameters.critical_bw_s("simulation", "wide")
    parameters = flockenv.FlockParameters(n_boats=27, n_leaders=3, pool="wide", bw_s=bw_s)
    rows = []
    for seed in range(options.runs):
        truth = flockenv.simulate(parameters, seed, options.minutes * 60, sample_hz=LAYOUT.fps)
        expected = quantities(truth)
        for name, camera in CAMERAS.items():
            tracks = read_tracks(seen(truth, camera, np.random.default_rng(seed)), LAYOUT)
            found = quantities(tracks)
            errors = {
                each: float(np.abs(found[each] - expected[each]).mean()) for each in QUANTITIES
            }
            rows.append({"camera": name, **errors})
    means = pd.DataFrame(rows).groupby("camera", sort=False).mean().reset_index()
    write_table(options.out, means, "%.2g")
    print(means.to_string(index=False))
    print(f"written to {options.out}")


if __name__ == "__main__":
    run(main, resumes=False)
