"""How fast is the water that `current_gain` makes? The current at each instant, in ordered flocks.

The field sets the water to `current_gain` times the mean tangential velocity of the flock at that
instant, the other way round, at every radius and without inertia. The paper's net current reached
3 to 5 cm/s. Fixed before the runs: 24 flocks of 27 boats without leaders, preset `experiment` with
`current_gain` 0.32 and a limit of 5 cm/s, at noises at which most of them rotate; of each run the
frames with Ψ_o of at least 0.8, of the whole cycle, after the first tenth.
"""

from typing import Any

import numpy as np
import pandas as pd

import flockenv
from studies.claim import Claims, judging, mean
from studies.picture import COLORS, curve, picture
from studies.study import SEEDS, Options, Row, Study, flock, main, simulated

FIRST = 530  # Seeds that no other study of this folder has.
NOISES_S = (0.8, 1.0, 1.2)


def design() -> list[Row]:
    """Return runs of 8 minutes."""
    return [
        {"preset": "experiment", "current_gain": 0.32, "current_cap_cm_s": 5.0, "n_leaders": 0}
        | {"bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for seed in range(FIRST, FIRST + SEEDS)
        for bw_s in NOISES_S
    ]


def measure(row: Row) -> Row:
    """Return the mean and the 99th percentile of the water's speed in the frames with order."""
    run = simulated(row)
    water_cm_s = speed_of_water(flock(row), run.pose, run.velocity)
    used = (run.order.psi_o >= 0.8) & (run.time_s >= 6.0 * row["minutes"])
    chosen = water_cm_s[used] if used.any() else np.array([np.nan])
    return {
        "ordered": used.mean() / 0.9,
        "mean_cm_s": chosen.mean(),
        "most_cm_s": np.quantile(chosen, 0.99),
    }


def speed_of_water(
    parameters: flockenv.FlockParameters, pose: np.ndarray, velocity: np.ndarray
) -> np.ndarray:
    """Return the speed of the water at each time, of poses and velocities (times, boats, 3)."""
    radius = np.hypot(pose[..., 0], pose[..., 1])
    along = (pose[..., 0] * velocity[..., 1] - pose[..., 1] * velocity[..., 0]) / radius
    speed = parameters.current_gain * abs(along.mean(axis=-1))
    return np.asarray(np.minimum(speed, parameters.current_cap_cm_s))


STUDY = Study("current/water", design, measure)


def judge(table: pd.DataFrame) -> Claims:
    """Compare the water's speed with that of the paper."""
    claims = Claims(
        "4.5", "experiment (leapfrog, white) with current_gain 0.32, narrow, n = 27", ours=True
    )
    for bw_s, runs in table.groupby("bw_s"):
        add_speeds(claims, "The water flows as fast as in the paper, 3 to 5 cm/s", bw_s, runs)
    return claims


def add_speeds(claims: Claims, claim: str, bw_s: Any, runs: pd.DataFrame) -> None:
    """Add a claim on the water's speed at a noise, by its mean and by its 99th percentile."""
    ordered = runs[runs["ordered"] > 0.0]
    for name, column in (("mean", "mean_cm_s"), ("99th percentile", "most_cm_s")):
        claims.add(
            claim,
            f"{name} of the speed of the water at Ψ_o of at least 0.8 (cm/s), bw = {bw_s:g} s",
            mean(ordered[column]),
            least=3.0,
            most=5.0,
        )


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw both speeds against noise, beside the range of the paper."""
    with picture(options, "water", width_cm=12.0, height_cm=7.0) as figure:
        axes = figure.subplots()
        axes.axhspan(3.0, 5.0, color="0.9", label="paper, largest net current")
        for color, column, label in (
            (COLORS[0], "mean_cm_s", "mean"),
            (COLORS[1], "most_cm_s", "99th percentile"),
        ):
            groups = table.dropna().groupby("bw_s")[column]
            if groups.ngroups:
                found = [mean(each) for _, each in groups]
                curve(axes, groups.groups, found, color=color, label=label)
        axes.set(xlabel="bw (s)", ylabel="speed of the water (cm/s)", ylim=(0.0, 5.5))
        figure.legend(loc="outside lower center", ncols=3)


script = judging("water", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
