"""What must a leader see? The learned leaders without groups of their features, and camera faults.

A feature that is left out has its usual value. A constant lean, as large as theirs is in the mean,
tests whether the lean as such makes them better, or what they see. Written before the runs: a group
is needed where leaders without it lead worse, by the whole interval of the difference paired by
flock; the constant lean explains the learned leaders where it leads within 0.02 of them.
"""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from flockenv.comparison import compare_leaders, run_episodes
from flockenv.policies import LeaningLaw
from flockenv.policies.laws import LARGEST_LEAN, LEAN_FEATURES
from studies.claim import Claims, Interval, judging, mean
from studies.picture import COLORS, picture
from studies.study import FIRST_SEED, Options, Row, Study, flock, main

CELL: Row = {"pool": "wide", "n_boats": 27, "n_leaders": 3, "bw_s": 0.31}
BLOCKS, FLOCKS = 16, 32
"""Blocks of flocks; a run is a block with one policy."""
FIRST = 100_000
"""Seeds that no other study of this folder has."""
GROUPS: dict[str, tuple[str, ...]] = {
    "its place": ("radial_position", "near_outer_wall"),
    "its velocity": ("outward_velocity", "clockwise_velocity", "forward_velocity"),
    "the flock's headings": ("mean_cos_orientation", "mean_sin_orientation"),
    "the flock's velocity": ("mean_outward_velocity", "mean_clockwise_velocity"),
    "where neighbors are": ("near", "near_outward", "near_ahead"),
    "neighbors' headings": ("near_opposed", "near_turned"),
    "neighbors' velocity": ("near_outward_velocity", "near_clockwise_velocity"),
    "headings by place": ("opposed_outward", "opposed_ahead", "turned_outward", "turned_ahead"),
    "the other leaders": ("leaders", "leaders_outward", "leaders_ahead"),
}
_OF_NEIGHBORS = ("where neighbors are", "neighbors' headings", "neighbors' velocity")
GROUPS["all of the neighbors"] = tuple(
    name for group in (*_OF_NEIGHBORS, "headings by place") for name in GROUPS[group]
)
"""Features that are left out together."""
FAULTS = {
    "0.3 % of boats lost": {"dropout_rate": 0.003},
    "10 % of boats lost": {"dropout_rate": 0.1},
    "half of the boats lost": {"dropout_rate": 0.5},
    "a picture that is late": {"delay_frames": 1},
}
ALL, CONSTANT, TUNED = "everything", "constant lean", "tuned law"
CASES = (ALL, CONSTANT, *GROUPS, TUNED, *FAULTS)


def policy(case: str, minutes: float) -> LeaningLaw | str:
    """Return the leaders of a case; a constant lean is the mean over episodes of this length."""
    learned = LeaningLaw.learned("wide")
    if case == TUNED:
        return TUNED
    left_out = tuple(learned.weights) if case == CONSTANT else GROUPS.get(case, ())
    bias = mean_lean_rad(minutes) if case == CONSTANT else learned.bias
    weights = {name: w for name, w in learned.weights.items() if name not in left_out}
    bound = "clip" if case == CONSTANT else "tanh"
    return LeaningLaw("wide", bias, weights, gains=learned.gains, bound=bound)


@cache
def mean_lean_rad(minutes: float) -> float:
    """Return the learned leaders' mean lean in 256 flocks that no case has."""
    law, leans = LeaningLaw.learned("wide"), list[float]()
    weights = np.array([law.weights[name] for name in LEAN_FEATURES])

    def noted(seen: Any, state: Any = None) -> Any:
        features = np.reshape(seen, (len(seen) * CELL["n_leaders"], -1))[:, -len(LEAN_FEATURES) :]
        leans.extend(LARGEST_LEAN * np.tanh((law.bias + features @ weights) / LARGEST_LEAN))
        return law.predict(seen, state)

    steers = SimpleNamespace(observation=law.observation, mirror_to_target=True, predict=noted)
    last = FIRST_SEED + FIRST * FLOCKS
    run_episodes(flock(CELL), steers, range(last - 256, last), 60.0 * minutes)
    return float(np.mean(leans))


def design() -> list[Row]:
    """Return blocks of 32 episodes, every case before the next block."""
    return [
        CELL | {"case": case, "flocks": FLOCKS, "minutes": 8.0, "seed": FIRST + block}
        for block in range(BLOCKS)
        for case in CASES
    ]


def measure(row: Row) -> Row:
    """Return the mean signed order of a block's flocks."""
    first = FIRST_SEED + row["seed"] * FLOCKS
    runs = compare_leaders(
        flock(row),
        [row["n_leaders"]],
        {row["case"]: policy(row["case"], row["minutes"])},
        range(first, first + row["flocks"]),
        60.0 * row["minutes"],
        environment=FAULTS.get(row["case"]),
    )
    return {"signed_order": runs["signed_order"].mean()}


STUDY = Study("what_leaders_see/what_leaders_see", design, measure)


def loss(table: pd.DataFrame, case: str) -> Interval:
    """Return how much worse leaders of a case lead, over blocks of the same flocks."""
    by = table.pivot_table(index="seed", columns="case", values="signed_order")
    return mean((by[ALL] - by[case]).dropna())


def judge(table: pd.DataFrame) -> Claims:
    """Judge what leaders need, over blocks of 32 flocks."""
    claims = Claims(
        "beyond the paper", "simulation (leapfrog, white), wide, 3 of 27, bw = 0.31 s", ours=True
    )
    for case in (each for each in CASES[1:] if each in set(table["case"])):
        least, most, words = 0.0, np.inf, f"Leaders need to see {case}"
        if case == CONSTANT:
            least, most, words = -0.02, 0.02, "A constant lean leads as well as the learned ones"
        elif case == TUNED:
            words = "Learned leaders lead better than the tuned law"
        elif case in FAULTS:
            least, most, words = -0.02, 0.02, f"Learned leaders bear {case}"
        quantity = f"signed order lost with {case}; blocks of {FLOCKS} flocks"
        claims.add(words, quantity, loss(table, case), least=least, most=most)
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the loss of each case with its interval."""
    cases = [each for each in CASES[1:] if each in set(table["case"])]
    with picture(options, "what_leaders_see", width_cm=12.0, height_cm=9.0) as figure:
        axes = figure.subplots()
        found = [loss(table, case) for case in cases]
        for place, (case, each) in enumerate(zip(cases, found, strict=True)):
            kind = 1 if case in GROUPS else 2 if case in FAULTS else 0
            error = [[each[0] - each[1]], [each[2] - each[0]]]
            axes.errorbar([each[0]], [place], xerr=error, marker="o", color=COLORS[kind])
        axes.axvline(0.0, color="0.6", linewidth=0.6, zorder=0)
        axes.set_yticks(range(len(cases)), cases)
        axes.invert_yaxis()
        axes.set_xlabel("signed order lost (0.02 is a constant lean's allowance)")
        blocks = table.groupby("case").size().min()
        flocks = f"{blocks * FLOCKS} flocks for each row"
        axes.set_title(f"{flocks}\n3 learned leaders of 27 boats in wide, bw = 0.31 s")


script = judging("what_leaders_see", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
