"""Statistics of runs whose order is known: made by hand, not simulated."""

from collections.abc import Mapping

import numpy as np
import pytest

import flockenv
from flockenv.reproduce.order_statistics import PHI_EDGES, PSI_EDGES, OrderStatistics
from flockenv.reproduce.reproduction import Results
from flockenv.reproduce.simulation.claims import critical_noise
from flockenv.runs.spec import ORDER_NAMES, RunSpec
from flockenv.runs.store import RunStore

PARAMETERS = flockenv.FlockParameters.preset("simulation")


def made(seed: int, order: Mapping[str, object], samples: int = 1000) -> flockenv.Recording:
    """A run of which every second sample is in the analysis window."""
    time_s = np.arange(samples) / 10
    # What must not count: everything outside the window and the first tenth.
    counts = (np.arange(samples) % 2 == 0) & (time_s > samples / 100)
    orders = {
        name: np.where(counts, order.get(name, 0.0), 0.777)  # type: ignore[arg-type]
        for name in ORDER_NAMES
    }
    return flockenv.Recording(
        time_s=time_s,
        phase=np.full(samples, "fw", "<U4"),
        in_analysis_window=np.arange(samples) % 2 == 0,
        pose=np.zeros((samples, 0, 3)),
        velocity=np.zeros((samples, 0, 3)),
        order=flockenv.OrderSeries(**orders),
        parameters=PARAMETERS,
        seed=seed,
        version=flockenv.__version__,
        duration_s=samples / 10,
    )


def spec_of(run: flockenv.Recording) -> RunSpec:
    return RunSpec(parameters=PARAMETERS, seed=run.seed, duration_s=run.duration_s)


class Made(Results):
    def __init__(self, runs: tuple[flockenv.Recording, ...]) -> None:
        self._runs = {spec_of(run): run for run in runs}
        super().__init__(RunStore("nowhere"), self._runs)

    def __getitem__(self, spec: RunSpec) -> flockenv.Recording:
        return self._runs[spec]


def statistics(*runs: flockenv.Recording) -> OrderStatistics:
    return OrderStatistics.of(Made(runs), [0.0], [[spec_of(run) for run in runs]])


def test_means_shares_and_directions() -> None:
    clockwise = made(1, {"psi_o": 1.0, "phi_o": 1.5, "psi_v": 10.0, "c_v": 100.0})
    counter = made(2, {"psi_o": 0.9, "phi_o": -1.5, "psi_v": 10.0, "c_v": 80.0})
    jam = made(3, {"psi_o": 0.9, "phi_o": 0.0, "psi_v": 1.0, "c_v": 0.0})
    found = statistics(clockwise, counter, jam)
    assert found.mean("psi_o")[0, 0] == pytest.approx(2.8 / 3)
    assert found.deviation("c_v")[0, 0] == pytest.approx(np.std([100, 80, 0]))
    assert found.mean("rotating")[0, 0] == pytest.approx(2 / 3)
    assert found.mean("jammed")[0, 0] == pytest.approx(1 / 3)
    assert found.mean("near_zero")[0, 0] == pytest.approx(1 / 3)
    assert found.share("cw", "rotating", np.array([True]))[0] == pytest.approx(0.5)
    assert found.runs_by_direction() == (1, 2)


def test_densities_integrate_to_one_and_keep_the_ends() -> None:
    found = statistics(made(1, {"psi_o": np.linspace(0, 1, 1000), "phi_o": np.pi}))
    for name, edges in (("phi_o", PHI_EDGES), ("psi_o", PSI_EDGES)):
        density = found.density(name)
        assert (density @ np.diff(edges)) == pytest.approx(1.0)
    assert found.density("phi_o")[0, 0, -1] == pytest.approx(36 / (2 * np.pi))


def test_runs_in_different_states_have_wide_intervals() -> None:
    order = {"psi_o": 0.9, "psi_v": 10.0}
    runs = [made(seed, {**order, "phi_o": 1.5 * (-1) ** seed}) for seed in range(3)]
    shares = statistics(*runs).share("cw", "rotating", np.array([True]))
    assert shares[0] == pytest.approx(2 / 3)
    assert shares[1:].min() == 0.0
    assert shares[1:].max() == 1.0


def test_critical_noise_of_a_straight_fall() -> None:
    x = np.linspace(0, 1.2, 13)
    fall = np.interp(x, [0.4, 0.8], [1.0, 0.2])
    rise_first = fall * np.where(x == 0, 0.1, 1.0)
    flat = np.full(13, 0.5)
    never = np.linspace(0.2, 1.0, 13)
    found = critical_noise(x, np.stack([fall, rise_first, flat, never], axis=1))
    assert found[:2] == pytest.approx([0.6, 0.6])
    assert np.isnan(found[2:]).all()
