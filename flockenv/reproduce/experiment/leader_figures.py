"""Figures 8 and 12: what leaders do to the time and to the degree of ordering, with linear fits."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from flockenv.reproduce.claim import CheckedClaim, Claim
from flockenv.reproduce.experiment.design import (
    CCW,
    CW,
    GUIDED_S,
    LEVELS_S,
    NONE,
    SETUPS,
    leader_series,
    noise_series,
)
from flockenv.reproduce.experiment.runs import line_or_none, resampled, run_rows
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.style import (
    DENSITY_COLORS,
    LED_COLOR,
    NOT_LED_COLOR,
    column_figure,
    paper_style,
)
from flockenv.runs.spec import RunSpec
from flockenv.statistics.intervals import CONFIDENCE, RESAMPLES, Line, interval

__all__ = ["REPRODUCTIONS"]

_SCOPE = "experiment, table-1"
_LATE_S = 1.4
_INTERVALS = (
    f"Intervals ({CONFIDENCE:.0%}) are of a bootstrap over runs within each level, with "
    f"{RESAMPLES} resamples."
)


def _slope(line: Line | None) -> float:
    return float("nan") if line is None else line.slope


def _p_value(line: Line | None) -> tuple[float, float, float]:
    p = float("nan") if line is None else line.p
    return p, p, p


def _span(runs: pd.DataFrame, quantity: str) -> tuple[float, float]:
    """Return the range of noise in which the quantity is finite."""
    known = runs.loc[np.isfinite(runs[quantity]), "bw_s"]
    return float(known.min()), float(known.max())


def _draw_line(axes: Axes, line: Line | None, x: tuple[float, float]) -> None:
    if line is None:
        return
    ends = np.array(x)
    sign = "−" if line.slope < 0 else "+"
    label = (
        f"{line.intercept:.3g} {sign} {abs(line.slope):.3g} x\nF = {line.f:.3g}, p = {line.p:.1g}"
    )
    axes.plot(ends, line.intercept + line.slope * ends, "k--", lw=0.8, label=label)


# --- figure 12 -----------------------------------------------------------------------------------


def _leader_runs(settings: Settings) -> list[RunSpec]:
    return [spec for point in leader_series(settings) for spec in point]


def _figure12(settings: Settings, results: Results) -> Outcome:
    runs = run_rows(results, leader_series(settings), "leaders", range(5), "CCW")
    runs = runs[["setup", "leaders", "seed", "psi_o", "psi_o_std"]]
    line = line_or_none(runs["leaders"], runs["psi_o"])
    slopes = resampled(runs, "leaders", lambda r: _slope(line_or_none(r["leaders"], r["psi_o"])))
    more = "Order increases with the number of leaders"
    claims = [
        Claim(
            text=more,
            section="4.4",
            quantity=f"slope of mean Ψ_o against 0 to 4 leaders, bw = {GUIDED_S} s",
            low=0.0,
        ).check(*interval(slopes), scope=_SCOPE),
        Claim(
            text=f"{more}, beyond chance",
            section="4.4",
            quantity="p of the F-test of that line (the paper: F = 13.5, p = 0.002)",
            high=0.05,
        ).check(*_p_value(line), scope=_SCOPE, note="" if line is None else f"F = {line.f:.3g}"),
    ]
    with paper_style():
        picture = column_figure(6.0)
        axes = picture.subplots()
        aside = runs["leaders"] + 0.3 * (runs.groupby("leaders").cumcount() / len(runs) * 5 - 0.5)
        for led, color in enumerate((NOT_LED_COLOR, LED_COLOR)):
            own = (runs["leaders"] > 0) == bool(led)
            axes.errorbar(
                aside[own],
                runs["psi_o"][own],
                runs["psi_o_std"][own],
                fmt="o",
                color=color,
                elinewidth=0.4,
                ms=2,
            )
        means = runs.groupby("leaders")["psi_o"].mean()
        axes.plot(means.index, means, "k_", ms=14, mew=1.5, label="mean")
        _draw_line(axes, line, (-0.2, 4.2))
        axes.set(xlabel="number of leaders", ylabel=r"$\Psi_o$", ylim=(0, 1), xticks=range(5))
        picture.legend(loc="outside upper center", ncols=2)
    notes = [
        "Each point is one 8-minute run, and its bar is one standard deviation of the frames.",
        _INTERVALS,
    ]
    return Outcome({"fig12": runs}, {"fig12": picture}, claims, notes)


# --- figure 8 ------------------------------------------------------------------------------------


def _noise_runs(settings: Settings) -> list[RunSpec]:
    return [spec for each in SETUPS for point in noise_series(settings, each) for spec in point]


def _figure8(settings: Settings, results: Results) -> Outcome:
    tables = {
        setup.name: run_rows(results, noise_series(settings, setup), "bw_s", LEVELS_S, setup.name)
        for setup in SETUPS
    }
    led = pd.concat([tables[CCW.name], tables[CW.name]], ignore_index=True)
    cases = {"3 leaders": led, "no leaders": tables[NONE.name]}
    claims = [claim for name, runs in cases.items() for claim in _ordering_claims(name, runs)]
    claims += _leaders_help(cases)
    with paper_style():
        picture = column_figure(10.0)
        panels = picture.subplots(2, 2, sharex=True, sharey=True)
        for column, (name, runs) in enumerate(cases.items()):
            for row, (quantity, angle) in enumerate(
                (("ordering_s", "π/20"), ("ordering_wide_s", "π/4"))
            ):
                axes = panels[row, column]
                points = axes.scatter(
                    runs["bw_s"],
                    runs[quantity] / 60,
                    c=runs["psi_o_after"],
                    s=6,
                    vmin=0.6,
                    vmax=1.0,
                    cmap=DENSITY_COLORS,
                )
                line = line_or_none(runs["bw_s"], runs[quantity] / 60)
                _draw_line(axes, line, _span(runs, quantity))
                if line is not None:
                    axes.legend(loc="upper right")
                axes.set_title(f"{name}, within {angle}")
                # Eight minutes, and room for the legend above.
                axes.set_ylim(0.0, 10.5)
        bar = picture.colorbar(points, ax=panels, location="bottom", fraction=0.04, aspect=40)
        bar.set_label(r"mean $\Psi_o$ after ordering")
        for axes in panels[-1]:
            axes.set_xlabel("backward time bw (s)")
        picture.supylabel("ordering time (min)", fontsize=7)
    table = pd.concat([led, tables[NONE.name]], ignore_index=True)
    notes = [
        "Each point is one 8-minute run that orders by eq. (7), with its angle of π/20 as printed "
        "and with π/4.",
        _INTERVALS,
    ]
    return Outcome({"fig8": table}, {"fig8": picture}, claims, notes)


def _ordering_claims(name: str, runs: pd.DataFrame) -> list[CheckedClaim]:
    text = "Order comes sooner at higher noise"
    line = line_or_none(runs["bw_s"], runs["ordering_s"])
    slopes = resampled(runs, "bw_s", lambda r: _slope(line_or_none(r["bw_s"], r["ordering_s"])))
    return [
        Claim(
            text=text,
            section="4.2",
            quantity="slope of the ordering time (eq. 7, π/20) against bw (s per s)",
            high=0.0,
        ).check(*interval(slopes), scope=f"{_SCOPE}, {name}"),
        Claim(
            text=f"{text}, beyond chance",
            section="4.2",
            quantity="p of the F-test of that line (the paper: 0.01 with leaders, 0.003 without)",
            high=0.05,
        ).check(
            *_p_value(line),
            scope=f"{_SCOPE}, {name}",
            note="" if line is None else f"F = {line.f:.3g}, {line.n} runs",
        ),
    ]


def _leaders_help(cases: dict[str, pd.DataFrame]) -> list[CheckedClaim]:
    led, free = cases["3 leaders"], cases["no leaders"]

    def share(runs: pd.DataFrame) -> float:
        late = runs[runs["bw_s"] > _LATE_S]
        return float(np.isfinite(late["ordering_wide_s"]).mean())

    def time(runs: pd.DataFrame) -> float:
        early = runs[(runs["bw_s"] <= _LATE_S) & np.isfinite(runs["ordering_s"])]
        return float(early["ordering_s"].mean())

    shares = resampled(led, "bw_s", share, 1) - resampled(free, "bw_s", share, 2)
    times = resampled(led, "bw_s", time, 1) - resampled(free, "bw_s", time, 2)
    return [
        Claim(
            text="Leaders extend the noise range where ordering is present",
            section="4.2",
            quantity=f"share of ordering runs at bw > {_LATE_S} s (π/4), "
            "with leaders minus without",
            low=0.0,
        ).check(*interval(shares), scope=_SCOPE),
        Claim(
            text="Leaders slightly reduce the time needed for ordering",
            section="4.2",
            quantity=f"mean ordering time at bw ≤ {_LATE_S} s, with leaders minus without (s)",
            high=0.0,
        ).check(*interval(times), scope=_SCOPE),
    ]


REPRODUCTIONS = (
    Reproduction(
        name="fig8",
        title="Ordering time against noise, with and without leaders",
        section="4.2",
        runs=_noise_runs,
        analyze=_figure8,
    ),
    Reproduction(
        name="fig12",
        title="Ψ_o against the number of leaders at bw = 1.8 s",
        section="4.4",
        runs=_leader_runs,
        analyze=_figure12,
    ),
)
