"""Measure the error of a boat that hits the wall, which comes from the time of the impact.

`python benches/impact.py [FOLDER]` writes impact.csv, by default to docs/speed_vs_error. Forty
boats, each alone, start 4 to 12 cm from the outer wall of `narrow` at full speed, and slide along
it after the impact. The run lasts 2 s. The error is the distance from the end of a run with steps
of 1e-4 s.
"""

import csv
import math
import sys
from pathlib import Path

import numpy as np

import flockenv

STEPS_S = (0.02, 0.01, 0.005, 0.0025)
REFERENCE_S = 1e-4
TIME_S, STARTS = 2.0, 40
OUT = Path(__file__).parents[1] / "docs" / "speed_vs_error"


def parameters(scheme: str, dt_s: float, tolerance_cm: float) -> flockenv.FlockParameters:
    """Return one boat without noise whose motor runs forward."""
    return flockenv.FlockParameters.preset("simulation").replace(
        n_boats=1,
        pool="narrow",
        c4=0.0,
        nop1_s=0.0,
        bw_s=0.0,
        nop2_s=0.0,
        scheme=scheme,
        dt_s=dt_s,
        tolerance_cm=tolerance_cm,
    )


def ends(p: flockenv.FlockParameters) -> np.ndarray:
    """Return the final poses of the boats, shape (starts, 3)."""
    poses = []
    for start in range(STARTS):
        outward, away_cm = 0.45 + 0.1 * (start % 8), 4.0 + 8.0 * start / STARTS
        heading = math.pi / 2.0 - outward  # At the polar angle 0, where the tangent is pi/2.
        half_cm = p.boat_radius_cm * p.boat_shape
        bow_cm = 90.0 - p.boat_radius_cm - away_cm
        pose = [
            bow_cm - half_cm * math.cos(heading),
            -half_cm * math.sin(heading),
            heading,
        ]
        velocity = [p.speed_cm_s * math.cos(heading), p.speed_cm_s * math.sin(heading), 0.0]
        boat = flockenv.Flock(p, 1)
        boat.set_state(np.array([pose]), np.array([velocity]))
        boat.advance(TIME_S)
        poses.append(boat.pose[0])
    return np.array(poses)


def main() -> None:
    """Measure and write."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else OUT
    reference = ends(parameters("leapfrog", REFERENCE_S, 1e-9))
    lines = []
    for scheme, gaps in (("leapfrog", "linear"), ("leapfrog", "1e-9 cm"), ("moreau", "linear")):
        tolerance_cm = math.inf if gaps == "linear" else float(gaps.removesuffix(" cm"))
        line: dict[str, object] = {"scheme": f"{scheme} / {gaps}"}
        for dt_s in STEPS_S:
            p = parameters(scheme, dt_s, tolerance_cm)
            differences = ends(p) - reference
            differences[:, 2] *= p.gyration_radius_cm
            errors_cm = np.linalg.norm(differences, axis=1)
            line[f"dt = {dt_s:g} s"] = f"{np.median(errors_cm):.2g}"
        lines.append(line)
    with (folder / "impact.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(lines[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(lines)


if __name__ == "__main__":
    main()
