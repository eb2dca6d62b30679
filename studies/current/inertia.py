"""What does a current with the inertia of water do to a flock's order, and to what leaders add?

Written before the runs, after a pilot of four other seeds. The preset `experiment`, whose current
is weak and without inertia, is compared with a strong current that follows the flock within 45 s,
and with the same gain without inertia. Order counts as lost where mean Ψ_o falls through 0.3, the
one definition of every line on this page. 24 seeds of 8 minutes at each of twelve noises, without
leaders and with three; all currents share the seeds. They are judged once all have been made.

How fast the inert water flows is measured apart, at the gain of this comparison and at the largest:
eight flocks without leaders, at times with Ψ_o of at least 0.8 after the first tenth of a run. The
paper's net current reached 3 to 5 cm/s; in the pilot this one had 1.5 to 2.1 cm/s.

- The current moves the loss of order if the interval of the difference from the preset excludes 0,
  and inertia matters if that of the difference between both strong currents does.
- It explains what leaders add in the paper if it raises the shift of the loss by three leaders.
- Section 4.5 says that the current lowers velocity correlations of ordered flocks: mean C_v / v0²
  at bw of 0.8 to 1.2 s, less than with the preset's.
"""

from typing import Any

import numpy as np
import pandas as pd

import flockenv
from studies.claim import Claims, bca, disorder, mean, write_claims
from studies.current.water import add_speeds
from studies.order import order_row
from studies.picture import COLORS, curve, picture
from studies.section4.section4 import at, over
from studies.study import SEEDS, Options, Row, Study, flock, main, seed_of, simulated

GAIN, RELAXATION_S = 0.6, 45.0
WEAK, INSTANT, INERT = "as in the preset", "strong, without inertia", "strong, with inertia"
CURRENTS: dict[str, Row] = {
    WEAK: {"current_gain": 0.04248, "current_relaxation_s": 0.0},
    INSTANT: {"current_gain": GAIN, "current_relaxation_s": 0.0},
    INERT: {"current_gain": GAIN, "current_relaxation_s": RELAXATION_S},
}
NOISES_S = tuple(round(0.2 * place, 1) for place in range(2, 14))
LEADERS = (0, 3)
FIRST, FIRST_WATER = 650, 680  # Seeds that no other study of this folder has.
WATER_SEEDS, EVERY_S = 8, 0.5
ORDERED_S = (0.75, 1.25)


def design() -> list[Row]:
    """Return the runs, seed by seed."""
    return [
        {"preset": "experiment", **current, "n_leaders": leaders}
        | {"bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for seed in range(FIRST, FIRST + SEEDS)
        for bw_s in NOISES_S
        for leaders in LEADERS
        for current in CURRENTS.values()
    ]


def measure(row: Row) -> Row:
    """Return order, rotation, jams and velocity correlation of a run."""
    found = order_row(simulated(row))
    return {name: found[name] for name in ("psi_o", "abs_m", "m", "jammed", "c_v")}


STUDY = Study("current/inertia", design, measure)


def water_design() -> list[Row]:
    """Return the runs in which the speed of the inert water is measured."""
    return [
        {"preset": "experiment", "current_gain": gain, "current_relaxation_s": RELAXATION_S}
        | {"n_leaders": 0, "bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for seed in range(FIRST_WATER, FIRST_WATER + WATER_SEEDS)
        for gain in (GAIN, 1.0)
        for bw_s in (0.8, 1.2)
    ]


def measure_water(row: Row) -> Row:
    """Return mean and 99th percentile of the water's speed at times with order."""
    boats = flockenv.Flock(flock(row), seed_of(row))
    boats.advance(6.0 * row["minutes"])
    found = []
    while boats.time_s < 60.0 * row["minutes"]:
        found.append((boats.order_parameters().psi_o, abs(boats.current_cm_s)))
        boats.advance(EVERY_S)
    psi_o, water_cm_s = np.array(found).T
    used = psi_o >= 0.8
    chosen = water_cm_s[used] if used.any() else np.array([np.nan])
    return {
        "ordered": used.mean(),
        "mean_cm_s": chosen.mean(),
        "most_cm_s": np.quantile(chosen, 0.99),
    }


WATER = Study("current/inert_water", water_design, measure_water)


def judge_water(table: pd.DataFrame) -> Claims:
    """Compare the speed of the inert water with that of the paper."""
    claims = Claims("4.5", "", ours=True)
    for (gain, bw_s), runs in table.groupby(["current_gain", "bw_s"]):
        claims.reading = (
            f"experiment (leapfrog, white) with current_gain {gain:g} and "
            f"current_relaxation_s {RELAXATION_S:g}, narrow, n = 27"
        )
        claim = "Water with inertia flows as fast as in the paper, 3 to 5 cm/s"
        add_speeds(claims, claim, bw_s, runs)
    return claims


def arm(table: pd.DataFrame, words: str, leaders: int) -> pd.DataFrame:
    """Return the runs with a current and a number of leaders."""
    current = pd.Series(CURRENTS[words] | {"n_leaders": leaders})
    return table[(table[[*current.index]] == current).all(axis=1)]


def judge(table: pd.DataFrame) -> Claims:
    """Judge the rule."""
    claims = Claims("4.5", "experiment (leapfrog, white), narrow, n = 27", ours=True)
    levels = sorted(table["bw_s"].unique())

    def loss(*signed: tuple[float, str, int]) -> Any:
        arms = [at(arm(table, words, leaders), "psi_o", "abs_m") for _, words, leaders in signed]
        return disorder(levels, arms, [sign for sign, _, _ in signed])

    lost = "bw (s) at which mean Ψ_o falls through 0.3"
    for words in (INSTANT, INERT):
        for leaders in LEADERS:
            claims.add(
                "A strong current moves the loss of order down",
                f"{lost}, {words} minus {WEAK}, k = {leaders}",
                loss((1.0, words, leaders), (-1.0, WEAK, leaders)),
                most=0.0,
            )
    for leaders in LEADERS:
        claims.add(
            "Inertia of the current moves the loss of order up",
            f"{lost}, {INERT} minus {INSTANT}, k = {leaders}",
            loss((1.0, INERT, leaders), (-1.0, INSTANT, leaders)),
            least=0.0,
        )
    for words in CURRENTS:
        claims.add(
            "Leaders raise the noise at which order is lost",
            f"{lost}, 3 leaders minus none, {words}",
            loss((1.0, words, 3), (-1.0, words, 0)),
            least=0.0,
        )
    claims.add(
        "A current with inertia raises what leaders add",
        f"{lost}, 3 leaders minus none, {INERT} minus {WEAK}",
        loss((1.0, INERT, 3), (-1.0, INERT, 0), (-1.0, WEAK, 3), (1.0, WEAK, 0)),
        least=0.0,
    )
    claims.ours = False
    v0 = flockenv.FlockParameters.preset("experiment").speed_cm_s
    claims.add(
        "The current lowers velocity correlations in the ordered state",
        f"mean C_v / v0², bw = 0.8 to 1.2 s, k = 0, {INERT} minus {WEAK}",
        bca(
            [
                over(arm(table, words, 0), "c_v", *ORDERED_S)[:, None] / v0**2
                for words in (INERT, WEAK)
            ],
            lambda strong, weak: strong[..., 0].mean(-1) - weak[..., 0].mean(-1),
        ),
        most=0.0,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw Ψ_o against noise, a panel for each number of leaders."""
    levels = sorted(table["bw_s"].unique())
    with picture(options, "inertia", height_cm=7.0) as figure:
        panels = figure.subplots(1, len(LEADERS), sharey=True)
        for axes, leaders in zip(panels, LEADERS, strict=True):
            for color, marker, words in zip(COLORS, "os^", CURRENTS, strict=False):
                runs = at(arm(table, words, leaders), "psi_o", "abs_m")
                style = {"color": color, "marker": marker, "label": words}
                curve(axes, levels, [mean(each[:, 0]) for each in runs], **style)
                _, low, high = disorder(levels, [runs])
                axes.axvspan(low, high, color=color, alpha=0.25, lw=0)
            axes.axhline(0.3, color="0.6", linestyle="--", zorder=0)
            axes.set(title=f"{leaders} leaders", xlabel="bw (s)")
        panels[0].set_ylabel("mean Ψ_o")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
        figure.supxlabel("shaded: Ψ_o falls through 0.3", fontsize=8)


def script(options: Options) -> None:
    """Make, judge and draw the runs."""
    claims = judge_water(WATER.results(options))
    table = STUDY.results(options, optional=True)
    if options.trial or len(table) == len(design()):
        claims += judge(table)
        draw(options, table)
    write_claims(options, "inertia", claims)


if __name__ == "__main__":
    main(script)
