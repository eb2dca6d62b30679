"""Do jams condense on the wall beside a rotating flock? Shares in jams over three hours.

The rule, written before the runs. Flocks at bw = 0 start in one jam, rotating, or half in one jam
and half rotating. All rings have one width, 83 cm as `wide`. The model has no straight channel, so
that the radius grows with the wall that a coverage asks for: 270 cm and more, so that a hull of
15 cm sees a wall that is straight within some 3 %. Nothing is cut when a jam splits. Coverage is
the number of boats over those that fit the outer wall in one row.

If jams condense, what stays *outside* of them is one coverage, the saturation, and all boats beyond
it are in jams. So at a noise, in the last hour, over flocks with jams (a twentieth of the boats):

1. from a coverage of 0.3 to 0.6 less than a tenth of the boats added stay outside (judged as within
   a tenth either way);
2. starts agree: from rotation, and from half and half, as much stays outside as from one jam;
3. sizes agree: in twice as large a flock as much stays outside;
4. it is stationary: as much as in the hour before.

Two values agree if they differ by less than 0.02 in coverage. It is condensation at a noise if all
hold with their whole intervals, and none if one fails. Below the saturation jams melt, and rotation
that lasts above it is supersaturated: the first time at which jams have a twentieth of the boats
for ten minutes, or no longer have it, is a lifetime. Both are shown for every coverage.

The runs come in blocks: one seed of all cells of a size. They are judged after as many blocks as
time allows, whatever they show, and a size of which a block is missing is judged by those it has.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.statistics.structure import jam_sizes
from studies.claim import Claims, bca, mean, write_claims
from studies.flocks import one_jam, rotating
from studies.picture import COLORS, curve, picture
from studies.store import write
from studies.study import FIRST_SEED, Options, Row, Study, flock, main
from studies.transition.outside import JAMS
from studies.transition.transition_runs import STARTED, WHITE, outer_radius_cm

WIDTH_CM = 83.0
C4 = (0.1, 0.03)
COVERAGES = (0.15, 0.2, 0.25, 0.3, 0.6)
DENSE = (0.3, 0.6)
"""Coverages by which the rule judges."""
HALF = "half-and-half"
HOURS, EVERY_S = 3, 20.0
FIRST = 600  # Seeds that no other study of this folder has.
AGREE, ADDED = 0.02, 0.1


def design() -> list[Row]:
    """Return the flocks in blocks of a seed: three of each size, then three more."""
    blocks = [(seed, n) for n in (100, 200, 400) for seed in range(3)]
    blocks += [(seed, n) for n in (100, 200, 400) for seed in range(3, 6)]
    return [
        {**WHITE, "c4": c4, "width_cm": WIDTH_CM, "n_boats": n, "coverage": coverage}
        | {"start": start, "minutes": 60.0 * HOURS, "seed": FIRST + seed}
        for seed, n in blocks
        for c4 in C4
        for coverage in COVERAGES[::-1]
        for start in (*STARTED, HALF)
    ]


def half_and_half(parameters: flockenv.FlockParameters, seed: int) -> flockenv.Flock:
    """Return a flock half of whose boats stand in one jam, and half go round beside it."""
    boats = one_jam(parameters, seed)
    pose, velocity = boats.pose, np.zeros((parameters.n_boats, 3))
    standing = parameters.n_boats // 2
    assert not isinstance(parameters.pool, str)
    angle = np.unwrap(np.arctan2(pose[:standing, 1], pose[:standing, 0]))
    free = np.linspace(angle[-1], angle[0] + 2.0 * math.pi, parameters.n_boats - standing + 2)[1:-1]
    pose[standing:, 0] = np.mean(parameters.pool) * np.cos(free)
    pose[standing:, 1] = np.mean(parameters.pool) * np.sin(free)
    pose[standing:, 2] = free - math.pi / 2.0
    velocity[standing:, 0] = parameters.speed_cm_s * np.cos(pose[standing:, 2])
    velocity[standing:, 1] = parameters.speed_cm_s * np.sin(pose[standing:, 2])
    boats.set_state(pose, velocity)
    return boats


_TURNED = np.array([0.0, 0.0, math.pi])
_STARTS = {"one-jam": one_jam, "rotating": rotating, HALF: half_and_half}


def measure(row: Row) -> Row:
    """Follow a flock, and return the means of each hour: shares in jams, |m|, jams."""
    return hours(follow(row)[:, :5], row["start"] == "rotating")


def follow(row: Row) -> np.ndarray:
    """Return samples of a run, shape (t, 6): `NAMES`."""
    outer = outer_radius_cm(row["n_boats"], row["coverage"])
    parameters = flock(row, bw_s=0.0, pool=(outer, outer - row["width_cm"]))
    boats = _STARTS[row["start"]](parameters, FIRST_SEED + row["seed"])
    boats.advance(1.5)  # Into the analysis window.
    samples = []
    while boats.time_s < 60.0 * row["minutes"]:
        order, pose = boats.order_parameters(), boats.pose
        sizes = jam_sizes(parameters, pose[None])[0]
        # The hull has two equal ends: turned around, a boat that faces inward faces outward.
        inward = jam_sizes(parameters, (pose + _TURNED)[None])[0].sum()
        slow = (np.hypot(*boats.velocity[:, :2].T) < parameters.speed_cm_s / 2.0).sum()
        m = abs(order.psi_o * math.sin(order.phi_o))
        counts = np.array([sizes.sum(), sizes.max(initial=0), inward, slow]) / row["n_boats"]
        samples.append((m, *counts[:3], len(sizes), counts[3]))
        boats.advance(EVERY_S)
    return np.array(samples)


NAMES = ("abs_m", "in_jams", "largest", "inward", "jams", "slow")
"""Columns of the samples: |m|, shares of the boats, the number of jams, and the share of boats
slower than half of their full speed."""


def hours(samples: np.ndarray, rotates: bool) -> Row:
    """Return the means of samples of each hour, and when a flock left or formed its jams."""
    found: Row = {}
    per_hour = round(3600.0 / EVERY_S)
    for hour in range(HOURS):
        own = samples[hour * per_hour : (hour + 1) * per_hour]
        means = own.mean(axis=0) if len(own) else np.full(samples.shape[1], math.nan)
        found |= {f"{name}_{hour + 1}": each for name, each in zip(NAMES, means, strict=False)}
    minutes = round(600.0 / EVERY_S)
    if len(samples) < minutes:
        return found | {"changed_min": math.nan}
    smooth = np.convolve(samples[:, 1], np.full(minutes, 1.0 / minutes), "valid")
    changed = np.flatnonzero((smooth >= JAMS) == rotates)
    first = changed[0] * EVERY_S / 60.0 if len(changed) else math.nan
    return found | {"changed_min": first}


STUDY = Study(
    "transition/condensation",
    design,
    measure,
    lambda row: row["n_boats"] == 100 and row["coverage"] == DENSE[0],
)


def whole_blocks(table: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of blocks that are complete."""
    runs = table.groupby(["n_boats", "seed"])["c4"].transform("size")
    return table[runs == runs.max()]


def outside(table: pd.DataFrame, hour: int = HOURS) -> pd.Series:
    """Return the coverage outside of jams in an hour; NaN for flocks without jams."""
    in_jams = table[f"in_jams_{hour}"]
    return (table["coverage"] * (1.0 - in_jams)).where(table[f"in_jams_{HOURS}"] >= JAMS)


def judge(table: pd.DataFrame) -> Claims:
    """Judge the rule at each noise and size."""
    claims = Claims("5.2, left open", "", ours=True)
    for c4, noise in table.groupby("c4", sort=False):
        claims.reading = f"leapfrog, white c4 = {c4:g}, dt = 0.1 s, bw = 0, ring of {WIDTH_CM:g} cm"
        judge_noise(claims, noise)
    return claims


def judge_noise(claims: Claims, noise: pd.DataFrame) -> None:
    """Judge the rule at each size of a noise."""
    found = noise.assign(outside=outside(noise), before=outside(noise, HOURS - 1))
    found = found[found["coverage"].isin(DENSE)].dropna(subset="outside")
    sizes = dict(iter(found.groupby("n_boats")))
    for n, runs in sizes.items():
        dense = [runs.loc[runs["coverage"] == each, ["outside"]] for each in DENSE]
        if all(map(len, dense)):
            claims.add(
                "Boats that are added join the jams",
                f"boats outside of jams per boat added, coverage {DENSE[0]:g} to {DENSE[1]:g}",
                difference(dense[0], dense[1], 1.0 / (DENSE[1] - DENSE[0])),
                least=-ADDED,
                most=ADDED,
                n=f"{n:g}",
            )
        for coverage, own in runs.groupby("coverage"):
            starts = dict(iter(own.groupby("start")))
            for start in ("rotating", HALF):
                pair = [starts[each][["outside"]] for each in ("one-jam", start) if each in starts]
                _agree(
                    claims,
                    "All starts end with as many boats outside of jams",
                    f"{start} minus one-jam, coverage {coverage:g}",
                    pair,
                    n,
                )
            claims.add(
                "The boats outside of jams do not change any more",
                f"coverage outside, last hour minus the one before, coverage {coverage:g}",
                mean(own["outside"] - own["before"]),
                least=-AGREE,
                most=AGREE,
                n=f"{n:g}",
            )
            twice = sizes.get(2.0 * n, runs.iloc[:0])
            larger = twice[twice["coverage"] == coverage]
            _agree(
                claims,
                "Flocks of twice the size have as many boats outside of jams",
                f"{2 * n:g} minus {n:g} boats, coverage {coverage:g}",
                [own[["outside"]], larger[["outside"]]],
                n,
            )


def _agree(claims: Claims, claim: str, quantity: str, pair: list[pd.DataFrame], n: float) -> None:
    if len(pair) == 2 and min(map(len, pair)):
        quantity = f"coverage outside of jams, {quantity}"
        found = difference(*pair)
        claims.add(claim, quantity, found, least=-AGREE, most=AGREE, n=f"{n:g}")


def difference(first: pd.DataFrame, second: pd.DataFrame, factor: float = 1.0) -> Any:
    """Return the mean of a second group of runs minus that of a first, times a factor."""
    return bca(
        [first.to_numpy(), second.to_numpy()],
        lambda a, b: factor * (b[..., 0].mean(-1) - a[..., 0].mean(-1)),
    )


_KEY = ["c4", "n_boats", "coverage", "start"]


def cells(table: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each cell: what is outside of jams, |m|, how many changed."""
    rows = []
    for key, runs in table.groupby(_KEY, sort=False):
        in_jams = runs[f"in_jams_{HOURS}"]
        row = dict(zip(_KEY, key, strict=True)) | {"runs": len(runs)}
        row |= {"with_jams": int((in_jams >= JAMS).sum()), "changed": runs["changed_min"].count()}
        row["median_changed_min"] = runs["changed_min"].fillna(math.inf).median()
        for name, values in (
            ("outside", runs["coverage"] * (1.0 - in_jams)),
            ("abs_m", runs[f"abs_m_{HOURS}"]),
            ("inward", runs[f"inward_{HOURS}"]),
        ):
            row |= dict(zip((name, f"{name}_low", f"{name}_high"), mean(values), strict=True))
        rows.append(row)
    return pd.DataFrame(rows)


def draw(options: Options, found: pd.DataFrame) -> None:
    """Draw coverage outside of jams and |m| against coverage, a column for noise and size."""
    columns = [(c4, n, own) for (c4, n), own in found.groupby(["c4", "n_boats"])]
    with picture(options, "condensation", height_cm=9.5) as figure:
        panels = figure.subplots(2, len(columns), sharex=True, sharey="row", squeeze=False)
        for (upper, lower), (c4, n, own) in zip(panels.T, columns, strict=True):
            upper.set_title(f"c4 = {c4:g}\n{n:g} boats")
            upper.plot([0.0, 0.65], [0.0, 0.65], color="0.7", zorder=0)  # No boat in a jam.
            for place, (start, points) in enumerate(own.groupby("start", sort=False)):
                style = {"color": COLORS[place], "marker": "os^"[place], "ls": "none"}
                x = points["coverage"] + 0.008 * (place - 1)
                for axes, name in ((upper, "outside"), (lower, "abs_m")):
                    names = [name, f"{name}_low", f"{name}_high"]
                    curve(axes, x, points[names].itertuples(index=False), label=start, **style)
            upper.set_ylim(0.0, 0.65)
            lower.set(ylim=(-0.03, 1.05), xlabel="coverage")
        panels[0, 0].set_ylabel("coverage\noutside of jams")
        panels[1, 0].set_ylabel("|m|")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3, title="started")


def script(options: Options) -> None:
    """Make the runs, judge and draw them."""
    if len(table := whole_blocks(STUDY.results(options, optional=True))):
        if claims := judge(table):  # A trial is too short for jams.
            write_claims(options, "condensation", claims)
        found = cells(table)
        text = found.to_csv(index=False, float_format="%.3g", lineterminator="\n")
        write(options.folder / "condensation.csv", text.encode())
        draw(options, found)


if __name__ == "__main__":
    main(script)
