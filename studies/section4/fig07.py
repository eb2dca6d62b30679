"""Figure 7: three leaders that change their direction every four minutes."""

import numpy as np
import pandas as pd

import flockenv
from studies.claim import Claims, Interval, judging, mean
from studies.picture import COLORS, picture
from studies.section4.section4 import READING
from studies.study import SEEDS, Options, Row, Study, flock, main, seed_of

NOISES_S = (1.8, 1.4)
"""The paper's noise, and one near which the preset loses its order."""
_SWITCHES = [(240.0, {"target": "cw"}), (480.0, {"target": "ccw"}), (720.0, {"target": "cw"})]


def design() -> list[Row]:
    """Return runs of 16 minutes, with alternating leaders and without leaders."""
    return [
        {"preset": "experiment", "n_leaders": k, "bw_s": bw_s, "minutes": 16.0, "seed": seed}
        for seed in range(SEEDS)
        for bw_s in NOISES_S
        for k in (3, 0)
    ]


def run_of(row: Row) -> flockenv.Recording:
    """Return the run of a row: CCW, CW, CCW, CW."""
    parameters, duration_s = flock(row, target="ccw"), 60.0 * row["minutes"]
    switches = [switch for switch in _SWITCHES if switch[0] < duration_s]  # A trial is short.
    options = {"dtype": np.float32, "schedule": switches}
    return flockenv.simulate(parameters, seed_of(row), duration_s, 5.0, **options)


def measure(row: Row) -> Row:
    """Return mean Ψ_o, and how the second half of each stretch goes."""
    run = run_of(row)
    used = run.analyzed(0.0)
    stretch, late = (used.time_s // 240.0).astype(int), used.time_s % 240.0 >= 120.0
    towards = used.order.rotation() * np.where(stretch % 2 == 0, -1.0, 1.0)
    chosen = [late & (stretch == i) for i in range(4)]
    found = {f"stretch_{i}": towards[c].mean() if c.any() else 0.0 for i, c in enumerate(chosen)}
    return {"psi_o": used.order.psi_o.mean(), **found}


STUDY = Study("section4/alternating", design, measure)


def followed(led: pd.DataFrame) -> Interval:
    """Return the share of stretches whose second half goes the leaders' way."""
    return mean((led[[f"stretch_{i}" for i in range(4)]] > 0.0).mean(axis=1))


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the paper says of figure 7."""
    claims = Claims("4.2", f"{READING}, 3 leaders")
    for bw_s in NOISES_S:
        at = table[np.isclose(table["bw_s"], bw_s)].set_index("seed")
        led, free = at[at["n_leaders"] == 3], at[at["n_leaders"] == 0]
        where = f"bw = {bw_s:g} s"
        claims.add(
            "The flock follows its leaders' direction in every 4-minute interval with high "
            "efficiency",
            f"share of stretches whose second half goes the leaders' way, {where}; "
            "read as at least 0.9",
            followed(led),
            least=0.9,
            ours=bw_s != NOISES_S[0],
        )
        claims.add(
            "Correlations are higher with alternating leaders than without at the same noise",
            f"mean Ψ_o with leaders minus without, same seeds, {where}",
            mean((led["psi_o"] - free["psi_o"]).dropna()),
            least=0.0,
            ours=bw_s != NOISES_S[0],
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw m of the median run at the paper's noise, and every run thinly."""
    led = table[(table["n_leaders"] == 3) & np.isclose(table["bw_s"], NOISES_S[0])]
    # Made again, so that all of the picture is of this code's version.
    runs = [run_of(row | {"n_leaders": 3}).analyzed(0.0) for row in led.to_dict("records")]
    runs.sort(key=lambda run: run.order.psi_o.mean())
    share, *_ = followed(led)
    with picture(options, "fig07", height_cm=6.2) as figure:
        axes = figure.subplots()
        for place, used in enumerate(runs):
            cycle = np.cumsum(np.diff(used.time_s, prepend=-10.0) > 1.0)
            means = pd.DataFrame({"t": used.time_s / 60, "m": used.order.rotation()})
            found = means.groupby(cycle).mean()
            is_median = place == len(runs) // 2
            style = {"color": COLORS[1], "zorder": 3} if is_median else {"color": "0.85"}
            axes.plot(found["t"], found["m"], **style)
        minutes = np.array([0, 4, 4, 8, 8, 12, 12, 16])
        axes.plot(minutes, [-1, -1, 1, 1, -1, -1, 1, 1], "--", color=COLORS[0], label="leaders")
        axes.set(xlabel="time (min)", ylabel="m of the normal boats", ylim=(-1.05, 1.05))
        about = f"bw = {NOISES_S[0]:g} s, 24 boats and 3 leaders, {len(runs)} runs, the median red"
        paper = f"the paper's flock follows in 4 of 4 stretches, these in {100 * share:.0f} %"
        axes.set_title(f"{about}\n{paper} of them")
        axes.legend(loc="upper left")


script = judging("fig07", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
