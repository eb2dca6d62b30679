"""Readings of Section 5 as a family: where each claim holds, over scheme, noise and tolerance."""

import fig14
import fig15
import fig16
import fig17
import numpy as np
import pandas as pd
from claim import Claims, write_claims
from section5 import PRESETS, READINGS, STUDY, Evidence
from study import COLORS, Options, curve, main, picture, write


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
    write(options.out / "readings.csv", text.encode())


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the critical bw and the jam of 50 boats against the tolerance, for both noises."""
    with picture(options, "readings", height_cm=6.0) as figure:
        left, right = figure.subplots(1, 2)
        for color, marker, noise in zip(COLORS, "os", ("per-step", "white"), strict=False):
            names = [
                name
                for name, row in READINGS.items()
                if (row["scheme"], row["noise_scheme"]) == ("paper", noise)
                and (row["pool"], row["dt_s"]) == ("wide", 0.02)
            ]
            names.sort(key=lambda name: READINGS[name]["overlap_tolerance_cm"])
            x = [READINGS[name]["overlap_tolerance_cm"] for name in names]
            evidence = [Evidence(table, name) for name in names]
            lost = [e.critical(20, 0) for e in evidence]
            style = {"color": color, "marker": marker, "label": f"{noise} noise"}
            curve(left, x, lost, **style)
            jams = [fig17.mean(_jammed(e)) for e in evidence]
            curve(right, x, jams, **style)
        left.axhspan(0.6, 0.8, color="0.9", zorder=0)
        left.set(ylabel="critical bw (s), n = 20, k = 0")
        right.set(ylabel="jammed share, n = 50, bw = 0", ylim=(0, 1))
        for axes in (left, right):
            axes.set(xscale="log", xlabel="overlap tolerance (cm), scheme paper, dt = 0.02 s")
        left.legend()


def _jammed(e: Evidence) -> np.ndarray:
    runs = fig17.densities(e)
    return runs.loc[runs["n_boats"] == 50, "jammed"].to_numpy()


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
