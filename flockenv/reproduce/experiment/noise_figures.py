"""Figures 9 to 11: φ_o, Ψ_o and C_v against noise, without leaders and with leaders each way."""

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv.reproduce.claim import CheckedClaim, Claim
from flockenv.reproduce.experiment.design import (
    CCW,
    CW,
    LEVELS_S,
    NONE,
    SETUPS,
    Setup,
    noise_series,
    statistics,
)
from flockenv.reproduce.order_statistics import OrderStatistics, block_length_s
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.series_panels import (
    density_map,
    density_rows,
    draw_curve,
    series_rows,
)
from flockenv.reproduce.simulation.claims import critical_noise
from flockenv.reproduce.style import column_figure, paper_style
from flockenv.runs.spec import RunSpec
from flockenv.statistics.intervals import CONFIDENCE, RESAMPLES, interval

__all__ = ["REPRODUCTIONS"]

_BW = "backward motion time bw (s)"
_DISORDERED_S = 2.4
Series = dict[Setup, OrderStatistics]


def _runs(settings: Settings) -> list[RunSpec]:
    return [spec for each in SETUPS for point in noise_series(settings, each) for spec in point]


def _series(settings: Settings, results: Results) -> Series:
    return {each: statistics(results, noise_series(settings, each)) for each in SETUPS}


def _between(low_s: float, high_s: float) -> NDArray[np.bool_]:
    levels = np.array(LEVELS_S)
    return np.asarray((levels > low_s - 1e-9) & (levels < high_s + 1e-9))


def _mean(series: OrderStatistics, name: str, low_s: float, high_s: float) -> NDArray[np.float64]:
    return np.asarray(series.mean(name)[_between(low_s, high_s)].mean(axis=0))


def _claim(
    setup: Setup | None,
    section: str,
    text: str,
    quantity: str,
    replicates: NDArray[np.float64],
    low: float = -np.inf,
    high: float = np.inf,
) -> CheckedClaim:
    scope = "experiment, table-1" + (f", {setup.name}" if setup else "")
    claim = Claim(text=text, section=section, quantity=quantity, low=low, high=high)
    return claim.check(*interval(replicates), scope=scope)


def _direction_claims(series: Series) -> list[CheckedClaim]:
    whole = _between(0.0, 3.0)
    middle = _between(0.8, 1.6)
    claims = []
    for setup, low, high in ((CCW, -np.inf, 0.05), (CW, 0.95, np.inf)):
        claims.append(
            _claim(
                setup,
                "4.3",
                "Leaders order the flock in their direction only",
                "share of clockwise frames among those in ordered rotation",
                series[setup].share("cw", "rotating", whole),
                low,
                high,
            )
        )
    claims.append(
        _claim(
            NONE,
            "4.3",
            "Without leaders order comes in both directions",
            "share of clockwise frames among those in ordered rotation, bw 0.8 to 1.6 s",
            series[NONE].share("cw", "rotating", middle),
            0.05,
            0.95,
        )
    )
    for setup, critical_s in ((NONE, 1.4), (CCW, 2.0), (CW, 2.0)):
        psi_o = series[setup].mean("psi_o")
        found = critical_noise(series[setup].x, psi_o, _DISORDERED_S)
        claims.append(
            _claim(
                setup,
                "4.3",
                f"Order is lost around bw = {critical_s} s",
                "bw at which mean Ψ_o falls through the middle of its range (s)",
                found,
                critical_s - 0.2,
                critical_s + 0.2,
            )
        )
    jams = [_mean(series[setup], "jammed", 0.4, 0.8) for setup in (NONE, CCW, CW)]
    quantity = "share of jammed frames, bw ≤ 0.8 s"
    claims.append(_claim(NONE, "4.3", "Jamming is present at low noise", quantity, jams[0], 0.005))
    claims.append(
        _claim(
            None,
            "4.3",
            "Jamming comes mainly without leaders",
            f"{quantity}: without leaders minus with",
            jams[0] - (jams[1] + jams[2]) / 2,
            # No jam at all does not count as one that leaders prevent.
            1e-3,
        )
    )
    return claims


def _order_claims(series: Series) -> list[CheckedClaim]:
    claims = []
    for setup, ordered_s in ((NONE, 1.0), (CCW, 1.4), (CW, 1.4)):
        claims.append(
            _claim(
                setup,
                "4.3",
                "Ψ_o ≈ 1 in the ordered state at low noise, read as at least 0.9",
                f"mean Ψ_o, bw ≤ {ordered_s} s",
                _mean(series[setup], "psi_o", 0.4, ordered_s),
                0.9,
            )
        )
        claims.append(
            _claim(
                setup,
                "4.3",
                "Ψ_o < 0.3 in the disordered state at high noise",
                f"mean Ψ_o, bw ≥ {_DISORDERED_S} s",
                _mean(series[setup], "psi_o", _DISORDERED_S, 2.8),
                high=0.3,
            )
        )
    for setup in (CCW, CW):
        gain = _mean(series[setup], "psi_o", 1.4, 2.0) - _mean(series[NONE], "psi_o", 1.4, 2.0)
        claims.append(
            _claim(
                setup,
                "4.3",
                "Leaders greatly increase coherence at medium noise, read as Ψ_o by 0.2",
                "mean Ψ_o at bw 1.4 to 2 s, with leaders minus without",
                gain,
                0.2,
            )
        )
    spread = series[NONE].deviation("psi_o")
    near = spread[_between(1.2, 1.8)].mean(axis=0)
    away = spread[_between(2.4, 2.8)].mean(axis=0)
    claims.append(
        _claim(
            NONE,
            "4.3",
            "Order comes and goes at the critical noise (bistability)",
            "standard deviation of Ψ_o at bw 1.2 to 1.8 s over that at bw ≥ 2.4 s",
            near / away,
            1.5,
        )
    )
    return claims


def _velocity_claims(series: Series) -> list[CheckedClaim]:
    claims = []
    for setup in SETUPS:
        high = series[setup].mean("c_v")[_between(2.4, 2.8)].mean(axis=0)
        most = series[setup].mean("c_v").max(axis=0)
        claims.append(
            _claim(
                setup,
                "4.3",
                "No velocity correlation in disordered motion, read as a tenth of the maximum",
                "mean C_v at bw ≥ 2.4 s over its maximum",
                high / most,
                high=0.1,
            )
        )
        low = series[setup].mean("c_v")[_between(0.4, 0.4)].mean(axis=0)
        claims.append(
            _claim(
                setup,
                "4.3",
                "Low velocity correlation again at very low noise, read as half of the maximum",
                "mean C_v at bw = 0.4 s over its maximum",
                low / most,
                high=0.5,
            )
        )
    return claims


def _figure9(settings: Settings, results: Results) -> Outcome:
    series = _series(settings, results)
    tables = []
    with paper_style():
        picture = column_figure(6.0)
        panels = picture.subplots(1, 3, sharex=True, sharey=True)
        for axes, (setup, each) in zip(panels, series.items(), strict=True):
            mesh = density_map(axes, each, "phi_o", 2.0)
            axes.set_title(setup.name)
            tables.append(density_rows(each, "phi_o", {"setup": setup.name}, "bw_s"))
        panels[0].set_ylabel(r"$\varphi_o$ (rad)")
        panels[1].set_xlabel(_BW)
        bar = picture.colorbar(
            mesh, ax=panels, extend="max", location="bottom", fraction=0.05, aspect=40
        )
        bar.set_label("probability density (1/rad)")
    claims = _direction_claims(series)
    return Outcome({"fig9": pd.concat(tables)}, {"fig9": picture}, claims, [_note(settings)])


def _curves(
    name: str,
    quantity: str,
    label: str,
    claims: Callable[[Series], list[CheckedClaim]],
    settings: Settings,
    results: Results,
) -> Outcome:
    series = _series(settings, results)
    tables = []
    with paper_style():
        picture = column_figure(11.0)
        panels = picture.subplots(3, 1, sharex=True, sharey=True)
        for axes, (setup, each) in zip(panels, series.items(), strict=True):
            draw_curve(axes, each, quantity, setup.name, setup.n_leaders > 0)
            axes.set_title(setup.name)
            tables.append(series_rows(each, [quantity], {"setup": setup.name}, "bw_s"))
            axes.set_ylabel(label)
        panels[-1].set_xlabel(_BW)
    notes = [
        _note(settings),
        f"Points and bars are means with their {CONFIDENCE:.0%} intervals. The shaded range is the "
        "mean plus and minus one standard deviation of the frames.",
    ]
    return Outcome({name: pd.concat(tables)}, {name: picture}, claims(series), notes)


def _figure10(settings: Settings, results: Results) -> Outcome:
    return _curves("fig10", "psi_o", r"$\Psi_o$", _order_claims, settings, results)


def _figure11(settings: Settings, results: Results) -> Outcome:
    label = r"$C_v$ (cm²/s²)"
    return _curves("fig11", "c_v", label, _velocity_claims, settings, results)


def _note(settings: Settings) -> str:
    length = block_length_s(settings.duration_s(8.0))
    runs = len(noise_series(settings, NONE)[0])
    return (
        f"There are {runs} runs of 8 minutes at each backward duration. Intervals "
        f"({CONFIDENCE:.0%}) are of a bootstrap in two stages, runs and blocks of {length:g} s "
        f"within each, with {RESAMPLES} resamples. The frames are those in the analysis window "
        "after the first tenth of a run."
    )


REPRODUCTIONS = tuple(
    Reproduction(name=name, title=title, section="4.3", runs=_runs, analyze=analyze)
    for name, title, analyze in (
        ("fig9", "Probability density of φ_o against noise, by leaders", _figure9),
        ("fig10", "Ψ_o against noise, by leaders", _figure10),
        ("fig11", "C_v against noise, by leaders", _figure11),
    )
)
