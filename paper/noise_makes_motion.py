"""Some noise is needed for long-term motion: rotation and jams of leaderless flocks against bw."""

import numpy as np
import pandas as pd
from claim import Claims, bca, judging, mean
from section4 import FREE, READING, STUDY, VERY_LOW_S, over, setup, words
from study import COLORS, Options, curve, main, picture


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the summary says of noise."""
    claims = Claims("6, 4.3", READING)
    free = setup(table, FREE)
    none, some = over(free, "abs_m", 0.0, 0.0), over(free, "abs_m", 1.0, 1.0)
    claims.add(
        "Some noise is needed for long-term ordered motion",
        "mean |m| at bw = 1.0 s minus that at bw = 0, no leaders; read as at least 0.3",
        mean(some - none),
        least=0.3,
    )
    claims.add(
        "Jamming dominates at very low noise",
        f"share of jammed frames, {words(VERY_LOW_S)}, no leaders",
        mean(over(free, "jammed", *VERY_LOW_S)),
        least=0.5,
    )
    claims.add(
        "Too much noise turns ordered motion into disordered motion",
        "mean |m| at bw ≥ 2.0 s over that at 1.0 s, no leaders; read as at most a quarter",
        bca(
            [np.stack([over(free, "abs_m", 2.0), some], 1)],
            lambda drawn: drawn[..., 0].mean(-1) / drawn[..., 1].mean(-1),
        ),
        most=0.25,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw |m| and the share of jammed frames against noise."""
    free = setup(table, FREE)
    with picture(options, "noise_makes_motion", width_cm=12.0, height_cm=6.5) as figure:
        axes = figure.subplots()
        shown = (("abs_m", "o", "rotation, mean |m|"), ("jammed", "s", "share of jammed frames"))
        for color, (column, marker, label) in zip(COLORS, shown, strict=False):
            groups = free.groupby("bw_s")[column]
            found = [mean(each) for _, each in groups]
            curve(axes, groups.groups, found, color=color, marker=marker, label=label)
        axes.set(xlabel="backward duration bw (s)", ylim=(-0.03, 1.0))
        axes.set_title(f"27 boats, no leaders, {free['seed'].nunique()} runs of 8 min per level")
        axes.legend()


script = judging("noise_makes_motion", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
