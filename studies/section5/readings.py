"""Readings of Section 5 as a family: where each claim holds, over scheme, noise and tolerance."""

from typing import Any

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, mean, write_claims
from studies.picture import COLORS, picture
from studies.section5 import fig14, fig15, fig16, fig17
from studies.section5.section5 import (
    LOST_S,
    PRESETS,
    READINGS,
    SERIES,
    STUDY,
    Evidence,
    in_words,
)
from studies.store import write
from studies.study import Options, main


def judge(e: Evidence) -> Claims:
    """Judge every claim of Section 5 for a reading."""
    claims = Claims("5.2", e.name)
    for figure in (fig14, fig15, fig16, fig17):
        claims += figure.judge(e)
    return claims


def write_table(options: Options, found: dict[str, Claims]) -> None:
    """Write statements against readings: h holds, f fails, o open, with the number of boats."""
    rows: dict[str, dict[str, str]] = {}
    for name, claims in found.items():
        for claim in claims:
            n = claim.reading.partition("n = ")[2]
            key = claim.claim if "at one n" in claim.claim else f"{claim.claim} (n = {n})"
            rows.setdefault(key, {})[name] = claim.verdict
    lines = [{"statement": key} | row for key, row in sorted(rows.items())]
    text = pd.DataFrame(lines, columns=["statement", *found]).to_csv(index=False)
    write(options.folder / "readings.csv", text.encode())


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the bw at which each reading loses its order, if it has any, and the jam of 50 boats."""
    names = sorted(READINGS, key=in_words)
    evidence = [Evidence(table, name) for name in names]
    with picture(options, "readings", height_cm=12.0) as figure:
        left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2, 1))
        for place, (color, (n, k)) in enumerate(zip(COLORS, SERIES, strict=False)):
            lost = [e.critical(n, k) for e in evidence]
            _bars(left, lost, 0.18 * (place - 1.5), color, f"{n} boats, {k} of them lead")
        jams = [fig17.densities(e).query("n_boats == 50")["jammed"] for e in evidence]
        _bars(right, [mean(each) for each in jams], 0.0, COLORS[2], "")
        left.axvspan(*LOST_S, color="0.9", zorder=0)
        left.set_yticks(range(len(names)), map(in_words, names))
        left.set(xlabel="bw at which order is lost (s)\nshaded: in the paper", ylim=(15.6, -0.6))
        right.set(xlabel="jammed share of\n50 boats at bw = 0", xlim=(0, 1.02))
        figure.legend(loc="outside upper center", ncols=2)


def _bars(axes: Any, found: list[Interval], shift: float, color: str, label: str) -> None:
    value, low, high = np.array(found).T
    at = np.arange(len(value)) + shift
    axes.errorbar(value, at, xerr=[value - low, high - value], fmt="o", color=color, label=label)


def script(options: Options) -> None:
    """Make the runs of every reading, judge and draw them."""
    table = STUDY.results(options)
    evidence = [Evidence(table, name) for name in READINGS]
    found = {e.name: judge(e) for e in evidence if len(e.runs)}
    others = [claim for name, each in found.items() if name not in PRESETS for claim in each]
    write_claims(options, "readings", others)
    write_table(options, found)
    draw(options, table)


if __name__ == "__main__":
    main(script)
