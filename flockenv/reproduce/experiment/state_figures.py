"""Figure 4 and Table 2: states found and measured in recorded poses."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv._core import Flock
from flockenv.flock import STATES
from flockenv.recording import Recording
from flockenv.rendering.frames import frame
from flockenv.reproduce.claim import CheckedClaim, Claim
from flockenv.reproduce.experiment.design import flock_parameters
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.runs.spec import RunSpec
from flockenv.statistics import structure
from flockenv.statistics.block_bootstrap import block_sums_resampled
from flockenv.statistics.dwell_times import DwellTimes, dwell_times
from flockenv.statistics.intervals import (
    CONFIDENCE,
    interval,
    mean_replicates,
)

__all__ = ["LEVELS_S", "REPRODUCTIONS", "pose_points", "pose_runs"]

LEVELS_S = (0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.8)
_MINUTES = 16.0
_SEEDS = 4
_SAMPLE_HZ = 5.0
_SCOPE = "experiment, table-1, no leaders"
_LOW_S, _HIGH_S = 0.8, 2.4
_ORDERED = ("ordered cw", "ordered ccw")


def pose_points(settings: Settings) -> dict[float, list[RunSpec]]:
    """Return the runs whose poses are stored, by backward duration."""
    return {
        bw_s: [
            RunSpec(
                parameters=flock_parameters(0, bw_s),
                seed=seed,
                duration_s=settings.duration_s(_MINUTES),
                sample_hz=_SAMPLE_HZ,
                keep="poses",
            )
            for seed in range(settings.seed, settings.seed + _SEEDS)
        ]
        for bw_s in LEVELS_S
    }


def pose_runs(settings: Settings) -> list[RunSpec]:
    """Return the runs whose poses are stored, of all backward durations."""
    return [spec for specs in pose_points(settings).values() for spec in specs]


def _frame_states(run: Recording) -> tuple[NDArray[np.intp], NDArray[np.str_], NDArray[np.float64]]:
    """Return the samples in the analysis window, their states, and their largest clusters."""
    samples = np.flatnonzero(run.in_analysis_window)
    clusters = np.zeros(len(run.time_s))
    clusters[samples] = structure.largest_cluster(run.parameters, run.pose[samples])
    states = run.order.states(run.parameters.speed_cm_s, clusters)
    return samples, states[samples], clusters[samples]


def _cycle_states(run: Recording) -> NDArray[np.str_]:
    """Return the most frequent state of each analysis window."""
    samples, states, _ = _frame_states(run)
    window = np.cumsum(np.diff(run.time_s[samples], prepend=-10.0) > 1.0) - 1
    counts = (states[:, None] == STATES).astype(np.int64)
    summed = np.zeros((window[-1] + 1, len(STATES)), np.int64)
    np.add.at(summed, window, counts)
    return np.asarray(STATES[summed.argmax(axis=1)])


def _cycle_s(bw_s: float) -> float:
    p = flock_parameters(0, bw_s)
    return p.fw_s + p.nop1_s + p.bw_s + p.nop2_s


# --- Table 2 -------------------------------------------------------------------------------------


def _table2(settings: Settings, results: Results) -> Outcome:
    shares: dict[float, NDArray[np.float64]] = {}
    rows, rates = [], []
    leaving: dict[float, NDArray[np.float64]] = {}
    for bw_s, specs in pose_points(settings).items():
        series = [_cycle_states(results[spec]) for spec in specs]
        stays = dwell_times(series, STATES.tolist(), _cycle_s(bw_s))
        leaving[bw_s] = _leaving(series, bw_s)
        shares[bw_s] = np.array([(each[:, None] == STATES).mean(axis=0) for each in series])
        rows += _state_rows(bw_s, stays, shares[bw_s], leaving[bw_s])
        rates += _rate_rows(bw_s, stays)
    with paper_style():
        picture = column_figure(7.0)
        axes = picture.subplots()
        for place, (state, mark) in enumerate(zip(STATES, "^vosDx", strict=True)):
            ends = np.array(
                [interval(mean_replicates(shares[bw_s][:, place])) for bw_s in LEVELS_S]
            )
            bars = np.maximum([ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]], 0.0)
            color = COLORS[place] if state != "between" else "0.6"
            # Side by side, or the bars would hide each other.
            aside = np.array(LEVELS_S) + 0.03 * (place - (len(STATES) - 1) / 2)
            axes.errorbar(
                aside, ends[:, 0], bars, fmt=f"{mark}-", color=color, elinewidth=0.7, label=state
            )
        axes.set(xlabel="backward motion time bw (s)", ylabel="share of cycles", ylim=(-0.03, 1.03))
        picture.legend(loc="outside upper center", ncols=3)
    notes = [
        "The state of a control cycle is the most frequent one in its analysis window. There are "
        f"{_SEEDS} runs of 16 minutes at each backward duration. A dwell time is the time in a "
        "state divided by the changes out of it, so that stays that a run's end cuts off count "
        "too.",
        f"Bars and intervals ({CONFIDENCE:.0%}) are of a bootstrap over runs.",
    ]
    tables = {"table2": pd.DataFrame(rows), "table2_rates": pd.DataFrame(rates)}
    return Outcome(tables, {"table2": picture}, _state_claims(shares, leaving), notes)


def _leaving(series: Sequence[NDArray[np.str_]], bw_s: float) -> NDArray[np.float64]:
    """Time in each state in s, then changes out of each, over runs: as they are, and resampled.

    Shape (resamples + 1, 2, states).
    """
    each = [dwell_times([states], STATES.tolist(), _cycle_s(bw_s)) for states in series]
    runs = [np.r_[one.time_s, one.changes.sum(axis=1)][None] for one in each]
    return block_sums_resampled(runs, round(1000 * bw_s)).reshape(-1, 2, len(STATES))


def _state_rows(
    bw_s: float, stays: DwellTimes, shares: NDArray[np.float64], leaving: NDArray[np.float64]
) -> list[dict[str, object]]:
    rows = []
    for place, state in enumerate(STATES.tolist()):
        share, low, high = interval(mean_replicates(shares[:, place]))
        with np.errstate(invalid="ignore", divide="ignore"):
            # The interval is that of the rate: a state that no draw leaves has no longest stay.
            _, slowest, fastest = interval(leaving[:, 1, place] / leaving[:, 0, place])
            dwell_low, dwell_high = 1 / np.array([fastest, slowest])
        rows.append(
            {
                "bw_s": bw_s,
                "state": state,
                "share": share,
                "share_low": low,
                "share_high": high,
                "dwell_s": stays.dwell_s[place],
                "dwell_s_low": dwell_low,
                "dwell_s_high": dwell_high,
                "stays": stays.stays[place],
            }
        )
    return rows


def _rate_rows(bw_s: float, stays: DwellTimes) -> list[dict[str, object]]:
    return [
        {
            "bw_s": bw_s,
            "from": stays.states[a],
            "to": stays.states[b],
            "changes": stays.changes[a, b],
            "per_min": stays.rates_per_min[a, b],
        }
        for a, b in zip(*np.nonzero(stays.changes), strict=True)
    ]


def _state_claims(
    shares: dict[float, NDArray[np.float64]], leaving: dict[float, NDArray[np.float64]]
) -> list[CheckedClaim]:
    def share(names: Sequence[str], low_s: float, high_s: float) -> NDArray[np.float64]:
        columns = np.isin(STATES, names)
        levels = [each for bw_s, each in shares.items() if low_s <= bw_s <= high_s]
        return mean_replicates(np.concatenate(levels)[:, columns].sum(axis=1))

    def claim(
        text: str, quantity: str, values: NDArray[np.float64], low: float, high: float = np.inf
    ) -> CheckedClaim:
        claim = Claim(text=text, section="4.1, Table 2", quantity=quantity, low=low, high=high)
        return claim.check(*interval(values), scope=_SCOPE)

    return [
        claim(
            "Jamming occurs sometimes at low noise",
            f"share of jammed cycles, bw ≤ {_LOW_S} s, read as 0.5 % to 50 %",
            share(["jamming"], 0, _LOW_S),
            0.005,
            0.5,
        ),
        claim(
            "Ordered motion is regular at low to medium noise",
            "share of cycles in ordered motion, bw 0.8 to 1.2 s",
            share(_ORDERED, 0.8, 1.2),
            0.5,
        ),
        claim(
            "Disordered motion is regular at high noise",
            f"share of disordered cycles, bw ≥ {_HIGH_S} s",
            share(["disordered"], _HIGH_S, 9),
            0.9,
        ),
        claim(
            "Clustering is rare",
            "share of clustering cycles, all levels",
            share(["clustering"], 0, 9),
            0.0,
            0.02,
        ),
        claim(
            "Ordered motion is more stable at low than at high noise",
            "rate of leaving ordered motion at bw ≤ 1.2 s over that at bw ≥ 1.6 s",
            _rate(_ORDERED, leaving, 0, 1.2) / _rate(_ORDERED, leaving, 1.6, 9),
            -np.inf,
            1.0,
        ),
    ]


def _rate(
    names: Sequence[str], leaving: dict[float, NDArray[np.float64]], low_s: float, high_s: float
) -> NDArray[np.float64]:
    """Return changes out of some states for each second in them, shape (resamples + 1,)."""
    chosen = np.isin(STATES, names)
    levels = [each for bw_s, each in leaving.items() if low_s <= bw_s <= high_s]
    time, left = np.sum(levels, axis=0)[:, :, chosen].sum(axis=2).T
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(left / time)


# --- figure 4 ------------------------------------------------------------------------------------

_PANELS = (
    ("a", "jamming", ("jamming",)),
    ("b", "clustering", ("clustering",)),
    ("c", "ordered motion", _ORDERED),
    ("d", "disordered motion", ("disordered",)),
)


def _figure4(settings: Settings, results: Results) -> Outcome:
    found = _snapshots(settings, results)
    notes = [
        "A rule selects each snapshot among all frames in the analysis window that are in the "
        "state: the highest Ψ_o for jamming and ordered motion, the lowest Ψ_o for disorder, and "
        "the largest cluster for clustering."
    ]
    rows, claims = [], []
    with paper_style():
        picture = column_figure(9.5)
        panels = picture.subplots(2, 2).ravel()
        for axes, (letter, title, names) in zip(panels, _PANELS, strict=True):
            axes.set_axis_off()
            best = found.get(names)
            axes.set_title(f"({letter}) {title}" + ("" if best else ": not found"))
            if best is None:
                axes.set_aspect("equal")
                axes.text(0.5, 0.5, "no frame", ha="center", va="center", color="0.4")
                notes.append(f"No frame of {title} was found.")
            else:
                run, sample, frames = best
                axes.imshow(_image(run, sample))
                order = f"$\\Psi_o$ = {run.order.psi_o[sample]:.2f}"
                axes.text(
                    0.5,
                    0.5,
                    f"bw = {run.parameters.bw_s} s\n{order}",
                    transform=axes.transAxes,
                    ha="center",
                    va="center",
                )
                rows.append(_snapshot_row(title, run, sample, frames))
            here = float(best[2] if best else 0)
            claims.append(
                Claim(
                    text=f"{title.capitalize()} is observed",
                    section="4.1",
                    quantity="frames in this state, of all",
                    low=1.0,
                ).check(here, here, here, scope=_SCOPE)
            )
    return Outcome({"fig4": pd.DataFrame(rows)}, {"fig4": picture}, claims, notes)


_PIXELS = 600
Snapshot = tuple[Recording, int, int]


def _snapshots(settings: Settings, results: Results) -> dict[tuple[str, ...], Snapshot]:
    best: dict[tuple[str, ...], tuple[float, RunSpec, int]] = {}
    frames: dict[tuple[str, ...], int] = {}
    for spec in pose_runs(settings):
        run = results[spec]
        samples, states, clusters = _frame_states(run)
        psi_o = run.order.psi_o[samples]
        for _, title, names in _PANELS:
            inside = np.isin(states, names)
            if not inside.any():
                continue
            worth = {"clustering": clusters, "disordered motion": -psi_o}.get(title, psi_o)
            place = int(np.where(inside, worth, -np.inf).argmax())
            frames[names] = frames.get(names, 0) + int(inside.sum())
            if names not in best or worth[place] > best[names][0]:
                best[names] = float(worth[place]), spec, int(samples[place])
    return {
        names: (results[spec], sample, frames[names]) for names, (_, spec, sample) in best.items()
    }


def _image(run: Recording, sample: int) -> NDArray[np.uint8]:
    flock = Flock(run.parameters, run.seed)
    pose = run.pose[sample].astype(np.float64)
    velocity = run.velocity[sample].astype(np.float64)
    # Single precision leaves overlaps of a rounding.
    flock.set_state(pose, velocity, float(run.time_s[sample]), allow_overlap=True)
    picture = frame(flock, _PIXELS, _PIXELS)
    x = np.arange(_PIXELS) - (_PIXELS - 1) / 2
    from_center = np.hypot(x, x[:, None]) / _PIXELS
    # The captions in the corners are too small at a column's width, and there is nobody to have the
    # target in the middle.
    picture[(from_center > 0.485) | (from_center < 0.22)] = 255
    return picture


def _snapshot_row(title: str, run: Recording, sample: int, frames: int) -> dict[str, object]:
    order = run.order[sample]
    return {
        "state": title,
        "frames": frames,
        "bw_s": run.parameters.bw_s,
        "seed": run.seed,
        "time_s": run.time_s[sample],
        "psi_o": order.psi_o,
        "phi_o": order.phi_o,
        "psi_v": order.psi_v,
    }


REPRODUCTIONS = tuple(
    Reproduction(name=name, title=title, section="4.1", runs=pose_runs, analyze=analyze)
    for name, title, analyze in (
        ("fig4", "Snapshots of the four states", _figure4),
        ("table2", "States, how long they last and what they change to", _table2),
    )
)
