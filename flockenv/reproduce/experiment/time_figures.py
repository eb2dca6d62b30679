"""Figures 5 to 7: order parameters over time."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.reproduce.claim import CheckedClaim, Claim
from flockenv.reproduce.experiment.design import GUIDED_S, flock_parameters
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.runs.protocols.target_switching import PERIOD_S, TARGETS, second_halves, target_at
from flockenv.runs.spec import RunSpec
from flockenv.statistics.intervals import CONFIDENCE, interval, mean_replicates

__all__ = ["REPRODUCTIONS"]

_MINUTES = 16.0
_SEEDS = 12
_SCOPE = "experiment, table-1"
_SPEED_CM_S = 15.0
_CYCLE = "means over each analysis window, one per control cycle"
_SETTLED = 0.5


def _specs(settings: Settings, bw_s: float, leaders: int = 0) -> list[RunSpec]:
    return [
        RunSpec(
            parameters=flock_parameters(leaders, bw_s),
            seed=seed,
            duration_s=settings.duration_s(_MINUTES),
            protocol="alternating" if leaders else "law",
            keep="order",
        )
        for seed in range(settings.seed, settings.seed + _SEEDS)
    ]


def _cycles(run: Recording) -> pd.DataFrame:
    """Mean order parameters of each analysis window; angles are those of mean vectors."""
    used = run.analyzed(after=0.0)
    window = np.cumsum(np.diff(used.time_s, prepend=-1.0) > 1.0)
    order = used.order
    columns = {"time_s": used.time_s, "psi_o": order.psi_o, "psi_v": order.psi_v, "c_v": order.c_v}
    columns |= {"x": order.outward(), "y": order.rotation()}
    means = pd.DataFrame(columns).groupby(window).mean()
    means["phi_o"] = np.arctan2(means["y"], means["x"])
    return means.drop(columns=["x"]).rename(columns={"y": "rotation"})


def _typical(runs: Sequence[Recording]) -> Recording:
    """Return the run whose mean Ψ_o is the median: what is shown is not picked by eye."""
    means = [_mean_psi_o(run) for run in runs]
    return runs[int(np.argsort(means, kind="stable")[len(means) // 2])]


def _mean_psi_o(run: Recording) -> np.float32:
    # A mean of what is stored, in the precision that it is stored in.
    return np.float32(run.analyzed().order.psi_o.astype(np.float32).mean())


def _over_runs(values: Sequence[float]) -> tuple[float, float, float]:
    """Return the mean over runs and its bootstrap interval; runs without a value are left out."""
    known = np.array([value for value in values if np.isfinite(value)])
    if len(known) < 2:
        return float("nan"), float("nan"), float("nan")
    return interval(mean_replicates(known))


def _picture(name: str, shown: Recording, cycles: pd.DataFrame, led: bool) -> Outcome:
    minutes = cycles["time_s"] / 60
    with paper_style():
        picture = column_figure(9.0)
        panels = picture.subplots(3, 1, sharex=True)
        panels[0].plot(minutes, cycles["psi_o"], color=COLORS[0])
        panels[0].set(ylabel=r"$\Psi_o$", ylim=(0, 1))
        panels[1].plot(minutes, cycles["phi_o"], ".", color=COLORS[0])
        panels[1].set(ylabel=r"$\varphi_o$ (rad)", ylim=(-np.pi, np.pi))
        panels[1].set_yticks([-np.pi / 2, 0, np.pi / 2], ["−π/2\nCCW", "0", "π/2\nCW"])
        panels[2].plot(minutes, cycles["psi_v"], color=COLORS[1])
        panels[2].set(ylabel=r"$\Psi_v$ (cm/s)", ylim=(0, _SPEED_CM_S))
        if led:
            for start in np.arange(0.0, shown.duration_s - 1e-6, PERIOD_S):
                panels[1].axvline(start / 60, color="0.6", lw=0.6)
                end = min(start + PERIOD_S, shown.duration_s)
                word = target_at(start).upper()
                panels[1].text((start + end) / 120, 2.5, word, ha="center", fontsize=6)
        panels[2].set_xlabel("time (min)")
        picture.suptitle(f"bw = {shown.parameters.bw_s} s, seed {shown.seed}", fontsize=7)
    notes = [
        f"Of {_SEEDS} runs, the figure shows the one whose mean Ψ_o is the median, as {_CYCLE}.",
        f"Intervals ({CONFIDENCE:.0%}) are of a bootstrap over runs.",
    ]
    return Outcome({name: cycles}, {name: picture}, [], notes)


def _flips(cycles: pd.DataFrame) -> float:
    """Count changes between clockwise and counter-clockwise order (|Ψ_o sin φ_o| > 0.5)."""
    ordered = cycles["rotation"][abs(cycles["rotation"]) > _SETTLED]
    return float((np.diff(np.sign(ordered)) != 0).sum())


def _longest(cycles: pd.DataFrame) -> float:
    """Return the longest stretch of order one way (|Ψ_o sin φ_o| > 0.5) in min."""
    way = np.sign(cycles["rotation"]) * (abs(cycles["rotation"]) > _SETTLED)
    stretch = (way.diff() != 0).cumsum()
    counts: NDArray[np.float64] = abs(way).groupby(stretch).sum().to_numpy()
    cycle_s = cycles["time_s"].diff().median()
    return float(counts.max() * cycle_s / 60)


def _claim(
    text: str,
    quantity: str,
    values: Sequence[float],
    low: float = -np.inf,
    high: float = np.inf,
    section: str = "4.2",
) -> CheckedClaim:
    claim = Claim(text=text, section=section, quantity=quantity, low=low, high=high)
    return claim.check(*_over_runs(values), scope=_SCOPE)


def _figure5(settings: Settings, results: Results) -> Outcome:
    runs = [results[spec] for spec in _specs(settings, 1.4)]
    cycles = [_cycles(run) for run in runs]
    shown = _typical(runs)
    outcome = _picture("fig5", shown, _cycles(shown), False)
    late = [each[each["time_s"] > each["time_s"].max() / 2] for each in cycles]
    outcome.claims.extend(
        [
            _claim(
                "Stable order lasts at bw = 1.4 s",
                "longest stretch of order one way in 16 min (min); the paper's lasts at least 5",
                [_longest(each) for each in cycles],
                5.0,
            ),
            _claim(
                "Order has a high correlation once it is there",
                "mean Ψ_o of the second half, bw = 1.4 s",
                [float(each["psi_o"].mean()) for each in late],
                0.8,
            ),
        ]
    )
    return outcome


def _figure6(settings: Settings, results: Results) -> Outcome:
    runs = [results[spec] for spec in _specs(settings, 1.9)]
    cycles = [_cycles(run) for run in runs]
    shown = _typical(runs)
    outcome = _picture("fig6", shown, _cycles(shown), False)
    calm = [float(_cycles(results[spec])["psi_o"].mean()) for spec in _specs(settings, 1.4)]
    noisy = [float(each["psi_o"].mean()) for each in cycles]
    outcome.claims.extend(
        [
            _claim(
                "Ordered states exist only for short periods at bw = 1.9 s",
                "longest stretch of order one way in 16 min (min), read as at most 5",
                [_longest(each) for each in cycles],
                high=5.0,
            ),
            _claim(
                "Correlations are much lower than at bw = 1.4 s",
                "mean Ψ_o at bw = 1.9 s less at 1.4 s, same seeds",
                [b - a for a, b in zip(calm, noisy, strict=True)],
                high=0.0,
            ),
            _claim(
                "The direction of a moving flock can change at bw = 1.9 s",
                "changes of direction in 16 min",
                [_flips(each) for each in cycles],
                0.5,
            ),
        ]
    )
    return outcome


def _figure7(settings: Settings, results: Results) -> Outcome:
    runs = [results[spec] for spec in _specs(settings, GUIDED_S, 3)]
    shown = _typical(runs)
    outcome = _picture("fig7", shown, _cycles(shown), True)
    follow, reached = [], []
    for run in runs:
        cycles = _cycles(run)
        late, target = second_halves(cycles["time_s"].to_numpy())
        follow.append(float((cycles["rotation"] * target)[late].mean()))
        stretch = (cycles["time_s"] // PERIOD_S)[late]
        ends = (cycles["rotation"] * target)[late].groupby(stretch).mean()
        reached.append(float((ends > 0).mean()))
    free = [results[spec] for spec in _specs(settings, GUIDED_S)]
    gain = [float(_mean_psi_o(a) - _mean_psi_o(b)) for a, b in zip(runs, free, strict=True)]
    stretches = f"the 4-minute stretches ({'-'.join(TARGETS * 2).upper()})"
    outcome.claims.extend(
        [
            _claim(
                "The flock orders in the leaders' direction in every 4-minute interval",
                f"share of {stretches} whose second half goes the leaders' way",
                reached,
                0.9,
            ),
            _claim(
                "The flock follows its leaders with high efficiency",
                f"mean Ψ_o cos(φ_o − φ_target) in the second halves of {stretches}",
                follow,
                0.5,
            ),
            _claim(
                "Correlations are higher than without leaders at the same noise",
                "mean Ψ_o with alternating leaders minus without, same seeds",
                gain,
                0.0,
            ),
        ]
    )
    return outcome


def _both_noises(settings: Settings) -> list[RunSpec]:
    return _specs(settings, 1.4) + _specs(settings, 1.9)


REPRODUCTIONS = (
    Reproduction(
        name="fig5",
        title="Order parameters over time at bw = 1.4 s",
        section="4.2",
        runs=lambda settings: _specs(settings, 1.4),
        analyze=_figure5,
    ),
    Reproduction(
        name="fig6",
        title="Order parameters over time at bw = 1.9 s",
        section="4.2",
        runs=_both_noises,
        analyze=_figure6,
    ),
    Reproduction(
        name="fig7",
        title="24 boats and 3 leaders that change their direction every 4 minutes",
        section="4.2",
        runs=lambda settings: _specs(settings, GUIDED_S, 3) + _specs(settings, GUIDED_S),
        analyze=_figure7,
    ),
)
