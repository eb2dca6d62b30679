"""Figure 9: the density of φ_o against noise, without leaders and with three of them.

The caption says that leaders raise the critical noise from around 1.4 s to around 2.0 s, so this
density judges it: the mean of the two bins within 10° of a tangent, that of the leaders, or without
leaders of both. It counts as lost where the density falls through 2 or 3 times the uniform one.
Both levels were fixed before these runs were judged by them, though after their histograms had been
looked at. Leaders gather the peaks of both directions in one, so that the density rises without any
more order; the share of frames near either tangent does not rise by that.
"""

from typing import Any

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, bca, crossing, judging, mean
from studies.order import PHI_EDGES, histograms
from studies.picture import PAPERS_LINE, density_map, picture
from studies.section4.section4 import (
    CCW,
    CW,
    FREE,
    LOST_S,
    LOW_S,
    READING,
    SETUPS,
    STUDY,
    over,
    setup,
    within,
    words,
)
from studies.study import Options, main

TIMES_UNIFORM = (2.0, 3.0)
NEAR = 0.65
_CENTERS = (PHI_EDGES[1:] + PHI_EDGES[:-1]) / 2
_AT = {
    way: abs(_CENTERS - angle) < np.pi / 18
    for way, angle in (("cw", np.pi / 2), ("ccw", -np.pi / 2))
}
_NEAR = abs(abs(_CENTERS) - np.pi / 2) < np.pi / 4
_WAYS = {FREE: ("cw", "ccw"), CW: ("cw",), CCW: ("ccw",)}


def words_of(times: float) -> str:
    """Return in words what falls."""
    return f"the density of φ_o within 10° of the tangent falls through {times:g} times uniform"


def _histograms(runs: pd.DataFrame) -> list[Any]:
    """Return the shares of frames in the bins of φ_o, shape (runs, bins), one array per noise."""
    return [
        np.array([text.split() for text in own], float) / 1000.0
        for _, own in runs.groupby("bw_s")["phi_histogram"]
    ]


def _density(name: str, times: float) -> Any:
    bins = [_AT[way] for way in _WAYS[name]]

    def of(levels_s: list[float], groups: Any) -> Any:
        means = np.stack(np.broadcast_arrays(*(each.mean(-2) for each in groups)))
        y = len(_CENTERS) * np.mean([means[..., each].mean(-1) for each in bins], axis=0)
        return crossing(levels_s, y.reshape(len(levels_s), -1), times).reshape(y.shape[1:])

    return of


def _share(levels_s: list[float], groups: Any) -> Any:
    y = np.stack(np.broadcast_arrays(*(each.mean(-2)[..., _NEAR].sum(-1) for each in groups)))
    return crossing(levels_s, y.reshape(len(levels_s), -1), NEAR).reshape(y.shape[1:])


def lost_at(runs: pd.DataFrame, name: str, times: float) -> Interval:
    """Return the bw at which the density at the tangent falls through a multiple of uniform."""
    levels_s, found = sorted(runs["bw_s"].unique()), _density(name, times)
    return bca(_histograms(runs), lambda *drawn: found(levels_s, drawn))


def share_lost_at(runs: pd.DataFrame) -> Interval:
    """Return the bw at which the share of frames near either tangent falls through `NEAR`."""
    levels_s = sorted(runs["bw_s"].unique())
    return bca(_histograms(runs), lambda *drawn: _share(levels_s, drawn))


def later(ours: Any, led: pd.DataFrame, theirs: Any, free: pd.DataFrame) -> Interval:
    """Return by how much later one loss comes than the other."""
    levels_s = sorted(free["bw_s"].unique())
    groups, half = [*_histograms(led), *_histograms(free)], len(levels_s)
    return bca(groups, lambda *d: ours(levels_s, d[:half]) - theirs(levels_s, d[half:]))


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the paper says of figure 9."""
    claims = Claims("4.3", READING)
    by = {name: setup(table, name) for name in SETUPS}
    free = by[FREE]
    for name in SETUPS:
        runs = by[name]
        high = within(runs, 2.1)
        claims.add(
            "φ_o is close to uniform at high noise",
            f"largest over mean density of φ_o in 36 bins, bw > 2 s, {name}; read as at most 1.5",
            bca(
                [np.array([histograms(each["phi_histogram"]) for _, each in high.groupby("seed")])],
                lambda drawn: drawn.mean(-2).max(-1) / drawn.mean(-2).mean(-1),
            ),
            most=1.5,
        )
        lost = ("1.4 s without", 1.2, 1.6) if name == FREE else ("2.0 s with 3", 1.8, 2.2)
        for times in TIMES_UNIFORM:
            claims.add(
                f"Order is lost around bw = {lost[0]} leaders",
                f"bw (s) at which {words_of(times)}, {name}",
                lost_at(runs, name, times),
                least=lost[1],
                most=lost[2],
            )
        claims.add(
            f"Directions are lost around bw = {lost[0]} leaders",
            f"bw (s) at which the share of frames within π/4 of either tangent falls through "
            f"{NEAR:g} (uniform: 0.5), {name}",
            share_lost_at(runs),
            least=lost[1],
            most=lost[2],
            ours=True,
        )
    for name, way in ((CCW, "ccw"), (CW, "cw")):
        ways = by[name].groupby("seed")[["cw", "ccw"]].sum()
        ways = ways[ways.sum(axis=1) > 0]
        claims.add(
            "Leaders order the flock in their direction only",
            f"share of frames in rotation that go {way}, all noises, {name}",
            mean(ways[way] / ways.sum(axis=1)),
            least=0.95,
        )
    middle = within(free, 0.8, 1.4)
    seeds = {way: (middle[way] > 0.5).groupby(middle["seed"]).any() for way in ("cw", "ccw")}
    claims.exists(
        "Without leaders order comes in both directions",
        "seeds with a run that rotates mostly in the rarer direction, bw 0.8 to 1.4 s",
        min(each.sum() for each in seeds.values()),
        middle["seed"].nunique(),
    )
    for times in TIMES_UNIFORM:
        claims.add(
            "Leaders increase the critical noise",
            f"bw (s) at which {words_of(times)}, with 3 clockwise leaders minus without",
            later(_density(CW, times), by[CW], _density(FREE, times), free),
            least=0.0,
        )
    claims.add(
        "Leaders keep directions to more noise",
        f"bw (s) at which the share of frames within π/4 of either tangent falls through {NEAR:g}, "
        "with 3 clockwise leaders minus without",
        later(_share, by[CW], _share, free),
        least=0.0,
        ours=True,
    )
    low = within(free, *LOW_S)
    jammed = (low["jammed"] > 0.05).groupby(low["seed"]).any()
    claims.exists(
        "Jamming is present occasionally at low noise",
        f"seeds with a run jammed in more than 5 % of its frames, {words(LOW_S)}, no leaders",
        jammed.sum(),
        len(jammed),
    )
    claims.add(
        "Jamming comes mainly without leaders",
        f"share of jammed frames at {words(LOW_S)}, without leaders minus with 3",
        mean(over(free, "jammed", *LOW_S) - over(by[CW], "jammed", *LOW_S)),
        least=0.0,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the densities."""
    noises = sorted(table["bw_s"].unique())
    with picture(options, "fig09", height_cm=6.0) as figure:
        panels = figure.subplots(1, 3, sharey=True)
        for axes, name in zip(panels, SETUPS, strict=True):
            runs = setup(table, name)
            found = [histograms(runs.loc[runs["bw_s"] == b, "phi_histogram"]) for b in noises]
            image = density_map(axes, noises, PHI_EDGES, found, 6.0)
            axes.axvline(LOST_S[name], **PAPERS_LINE)
            axes.set(title=name, yticks=[-np.pi / 2, 0, np.pi / 2])
            axes.set_yticklabels(["−π/2", "0", "π/2"])
        panels[0].set_ylabel("φ_o")
        each = f"{len(runs) // len(noises)} runs each"
        figure.supxlabel(f"bw (s), {each}; dashed: lost in the paper")
        figure.colorbar(image, ax=list(panels), label="density over uniform", extend="max")


script = judging("fig09", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
