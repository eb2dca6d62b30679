"""The signs of a first-order transition, on series whose answer is known.

On paper: with a share p of |m| = 1 and the rest 0, Binder's cumulant is 1 - 1/(3p): negative for
p < 1/3. It is 2/3 in one ordered state and 0 for a Gaussian m.
"""

import numpy as np
import pytest

import flockenv
from flockenv.reproduce.reproduction import Results, Settings
from flockenv.reproduce.transition_design import (
    DESIGNS,
    FULL,
    Growth,
    TransitionDesign,
    within,
)
from flockenv.reproduce.transition_order import (
    COEXISTENCE,
    HYSTERESIS,
    binder,
    conclusion,
    hysteresis,
    transition_order,
)
from flockenv.run_store import RunStore, run_missing
from flockenv.runs import ORDER_NAMES, RunResult, RunSpec


def test_binder() -> None:
    mixture = np.r_[np.ones(100), np.zeros(400)]
    gauss = np.random.default_rng(1).normal(size=200_000)
    moments = np.array([[np.mean(x**k) for x in (mixture, -mixture, gauss)] for k in (2, 4)])
    assert binder(*moments) == pytest.approx([1 - 5 / 3, 1 - 5 / 3, 0.0], abs=0.02)
    assert binder(np.ones(1), np.ones(1)) == pytest.approx(2 / 3)
    assert np.isnan(binder(np.zeros(1), np.zeros(1))).all()


def test_an_open_loop() -> None:
    samples = 1000
    scene = flockenv.FlockParameters.preset("simulation")
    spec = RunSpec(parameters=scene, seed=0, duration_s=100.0, protocol="noise-loop", keep="order")
    time_s = np.arange(samples) / 10
    there = time_s < 50
    orders = {name: np.zeros(samples, np.float32) for name in ORDER_NAMES}
    orders["psi_o"] = np.where(there, 0.9, 0.4).astype(np.float32)
    orders["phi_o"] = np.full(samples, -np.pi / 2, np.float32)
    run = RunResult(
        spec=spec,
        time_s=time_s,
        phase=np.zeros(samples, np.uint8),
        in_analysis_window=np.ones(samples, np.bool_),
        orders=orders,
    )
    up, down = hysteresis(run)
    assert up == pytest.approx(0.9)
    assert down == pytest.approx(0.4)


def test_growing_keeps_the_density() -> None:
    areas = {}
    for way in ("whole pool", "circumference"):
        pools = [Growth(way, n).scene(32).pool for n in (50, 800)]
        areas[way] = [np.subtract(*np.square(pool)) for pool in pools]
        assert areas[way][1] / areas[way][0] == pytest.approx(16)
        widths = [np.subtract(*pool) for pool in pools]
        ratio = widths[1] / widths[0]
        assert ratio == pytest.approx(1.0 if way == "circumference" else 4.0)
    assert areas["whole pool"] == pytest.approx(areas["circumference"])
    # As dense as 32 boats in the pool of 500.
    assert areas["whole pool"][0] / 50 == pytest.approx(np.pi * (180**2 - 97**2) / np.pi / 32)


def test_the_conclusion_follows_its_rule() -> None:
    first = [COEXISTENCE.check(-1, -2, -0.5, "a"), HYSTERESIS.check(0.3, 0.2, 0.4, "a")]
    assert conclusion(first).startswith("first order")
    smooth = [COEXISTENCE.check(0.3, 0.2, 0.4, "a"), HYSTERESIS.check(0.02, 0.01, 0.03, "a")]
    assert conclusion(smooth).startswith("not first order")
    mixed = conclusion([first[0], smooth[1]])
    assert mixed.startswith("inconclusive")
    assert "loops in density stay open does not hold for a" in mixed


def test_a_small_design_from_runs_to_tables(tmp_path: object) -> None:
    design = TransitionDesign(sizes=(20, 40), densities=(20, 40), runs=2)
    settings = Settings(minutes=1.0)
    reproduction = transition_order(design)
    specs = reproduction.runs(settings)
    assert len(specs) == 2 * 2 * (2 + 2) * 2
    store = RunStore(tmp_path)  # type: ignore[arg-type]
    assert run_missing(specs, store) == {}
    outcome = reproduction.analyse(settings, Results(store, specs))
    assert len(outcome.tables["transition"]) == 2 * 2 * 2
    assert len(outcome.claims) == 2 * 2 * 2
    assert outcome.tables["loops"]["there"].between(0, 1).any()
    histograms = outcome.tables["histograms"]
    m = histograms[histograms["quantity"] == "m"]
    width = m["bin_high"] - m["bin_low"]
    total = (m["probability_density"] * width).sum()
    assert total == pytest.approx(8)
    assert sum("conclus" in note or "first order" in note for note in outcome.notes) == 2


def test_the_budget_chooses_the_design() -> None:
    costs = [design.core_minutes(Settings()) for design in DESIGNS]
    assert costs == sorted(costs)
    for design, cost in zip(DESIGNS, costs, strict=True):
        assert within(Settings(budget_core_min=cost + 0.1)) is design
    assert within(Settings(budget_core_min=1e6)) is FULL
    assert within(Settings(minutes=1.0, budget_core_min=5.0)) is FULL
    with pytest.raises(flockenv.ParameterError, match="budget = 1 core-minutes is not enough"):
        within(Settings(budget_core_min=1.0))
    with pytest.raises(flockenv.ParameterError, match="budget = nan"):
        Settings(budget_core_min=float("nan"))


@pytest.mark.parametrize("design", DESIGNS)
def test_every_design_reaches_1600_boats(design: TransitionDesign) -> None:
    specs = transition_order(design).runs(Settings())
    assert max(spec.parameters.n_boats for spec in specs) == 1600
    assert {spec.protocol for spec in specs} == {
        "law",
        "noise-loop",
        "density-loop",
        "length-loop",
    }
