"""Compare fixed steps with steps that follow their error: substeps against error.

`python benches/step_control.py [FOLDER]` writes step_control.csv, by default to
docs/speed_vs_error. A boat slides along the wall, a boat hits it, and 27 boats with noise move for
half a second in a jam and in a cycle: 40 starts each, in `narrow`. Runs of a start have the same
noise for all steps. The error is the median distance from runs with steps of 1e-4 s, and the work
is the mean number of substeps.

A controlled step is compared with its two halves. If they differ by more than is accepted, the
first half is tried as a step, and so on. Accepted halves are kept. If they differ by less than a
tenth of the accepted error, the next step is twice as long, at most 0.1 s.
"""

import copy
import csv
import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import numpy as np
from numpy.typing import NDArray

import flockenv

LONGEST_S, EXACT_S, STARTS = 0.1, 1e-4, 40
HALVINGS = range(8)
ACCEPTED_CM = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
GROWS_BELOW = 0.1
#: Number of shortest half steps in the longest step; all times are whole nanoseconds.
PARTS = 2**8
OUT = Path(__file__).parents[1] / "docs" / "speed_vs_error"

Start = tuple[flockenv.Flock, float]


def started(p: flockenv.FlockParameters, flock: flockenv.Flock) -> flockenv.Flock:
    """Return a flock with these parameters in the state of another."""
    state = {"pose": flock.pose, "velocity": flock.velocity, "time_s": flock.time_s}
    return flockenv.Flock.from_state(p, 5, state)


def alone(away_cm: float, outward: float, spin: float) -> flockenv.Flock:
    """Return one boat whose bow is this far from the outer wall, heading outward of the tangent.

    Its bow circles the pool at a rate `spin`, or it moves ahead at its full speed if that is 0.
    """
    p = parameters(n_boats=1, c4=0.0, nop1_s=0.0, bw_s=0.0, nop2_s=0.0)
    heading = math.pi / 2.0 - outward  # At the polar angle 0, where the tangent is pi/2.
    ahead = np.array([math.cos(heading), math.sin(heading)])
    position = [85.0 - away_cm, 0.0] - 2.5 * ahead
    linear = spin * np.array([-position[1], position[0]]) if spin else p.speed_cm_s * ahead
    state = {"pose": [[*position, heading]], "velocity": [[*linear, spin]]}
    return flockenv.Flock.from_state(p, 5, state)


def parameters(**fields: object) -> flockenv.FlockParameters:
    """Return the default parameters in `narrow` with the longest step and these fields."""
    common = {"pool": "narrow", "dt_s": LONGEST_S, "tolerance_cm": 1e-6}
    return flockenv.FlockParameters.preset("simulation").replace(**common | fields)


def crowd(seed: int, drift_s: float) -> flockenv.Flock:
    """Return 27 boats after 18 s and a fraction of the cycle, without overlap."""
    p = parameters(n_boats=27, nop1_s=drift_s, bw_s=2.0 * drift_s, nop2_s=drift_s)
    flock = flockenv.Flock(p.replace(dt_s=0.01, tolerance_cm=1e-9), seed)
    flock.advance(18.0 + round(0.3 * drift_s * (seed % 20), 1))
    return started(p, flock)


def scenes() -> Iterator[tuple[str, list[Start]]]:
    """Yield each scene's name with its starts and their durations in s."""
    ks = range(STARTS)
    yield "slide", [(alone(0.0, 0.45 + 0.0175 * k, 0.12), 2.0) for k in ks]
    yield "impact", [(alone(4.0 + 0.2 * k, 0.45 + 0.1 * (k % 8), 0.0), 2.0) for k in ks]
    yield "jam", [(crowd(1 + k, 0.0), 0.5) for k in ks]
    yield "cycle", [(crowd(1 + k, 1.0), 0.5) for k in ks]


def distance_cm(flock: flockenv.Flock, pose: NDArray[np.float64]) -> float:
    """Return the root mean square over boats of |Δx|² + ρ²Δα²."""
    differences = flock.pose - pose
    differences[:, 2] *= flock.parameters.gyration_radius_cm
    return math.sqrt((differences**2).sum() / len(differences))


def fixed(flock: flockenv.Flock, seconds: float, dt_s: float) -> tuple[flockenv.Flock, int]:
    """Return a copy after some time with a fixed step, and its number of substeps."""
    moved = copy.copy(flock)
    moved.set_step(dt_s)
    moved.advance(seconds)
    return moved, moved.statistics.substeps - flock.statistics.substeps


def controlled(
    flock: flockenv.Flock, seconds: float, accepted_cm: float
) -> tuple[flockenv.Flock, int]:
    """Return a copy after some time with steps that follow their error, and all substeps taken."""
    least_s = LONGEST_S / PARTS
    end, time, length, work = round(seconds / least_s), 0, PARTS, 0
    while time < end:
        whole, substeps = fixed(flock, length * least_s, length * least_s)
        pose = whole.pose
        work += substeps
        while True:
            half_s = length / 2 * least_s
            middle, first = fixed(flock, half_s, half_s)
            halves, second = fixed(middle, half_s, half_s)
            work += first + second
            error_cm = distance_cm(halves, pose)
            if error_cm <= accepted_cm or length == 2:
                break
            length, pose = length // 2, middle.pose
        flock, time = halves, time + length
        if error_cm < GROWS_BELOW * accepted_cm and length < PARTS and time % (2 * length) == 0:
            length *= 2
    return flock, work


def main() -> None:
    """Measure and write."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else OUT
    lines: list[dict[str, object]] = []
    for scene, starts in scenes():
        exact = [fixed(flock, seconds, EXACT_S)[0].pose for flock, seconds in starts]
        for step, advance, settings, unit in (
            ("fixed", fixed, [LONGEST_S / 2**halvings for halvings in HALVINGS], "s"),
            ("controlled", controlled, ACCEPTED_CM, "cm"),
        ):
            for setting in settings:
                error_cm, substeps = measured(starts, exact, advance, setting)
                lines.append(
                    {
                        "scene": scene,
                        "step": step,
                        "setting": f"{setting:g} {unit}",
                        "error_cm": f"{error_cm:.3g}",
                        "substeps": f"{substeps:.4g}",
                    }
                )
                print(*lines[-1].values(), flush=True)
    with (folder / "step_control.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(lines[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(lines)


def measured(
    starts: list[Start],
    exact: list[NDArray[np.float64]],
    advance: Callable[[flockenv.Flock, float, float], tuple[flockenv.Flock, int]],
    setting: float,
) -> tuple[float, float]:
    """Return the median error in cm and the mean number of substeps."""
    ends = [advance(flock, seconds, setting) for flock, seconds in starts]
    errors = [distance_cm(end, pose) for (end, _), pose in zip(ends, exact, strict=True)]
    return median(errors), sum(substeps for _, substeps in ends) / len(ends)


if __name__ == "__main__":
    main()
