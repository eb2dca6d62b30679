"""The signs of a first-order transition, on series whose answer is known.

On paper: with a share p of |m| = 1 and the rest 0, Binder's cumulant is 1 - 1/(3p): negative for
p < 1/3. It is 2/3 in one ordered state and 0 for a Gaussian m.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import flockenv
from flockenv.reproduce.reproduction import Results, Settings
from flockenv.reproduce.transition.design import (
    DESIGNS,
    FULL,
    LOOPS,
    STARTED,
    Growth,
    TransitionDesign,
    within,
)
from flockenv.reproduce.transition.jam_map import JamMap
from flockenv.reproduce.transition.measured import (
    M_EDGES,
    MANY_BOATS,
    Jams,
    Loops,
    Measured,
    Stationary,
    binder,
    hysteresis,
)
from flockenv.reproduce.transition.order import (
    CHANNEL_SIZE,
    FORGOTTEN,
    ONE_PHASE,
    conclusion,
    judge,
    judge_jams,
    transition_order,
)
from flockenv.runs.spec import ORDER_NAMES
from flockenv.runs.store import RunStore, run_missing
from flockenv.statistics.intervals import student_interval


def test_binder() -> None:
    mixture = np.r_[np.ones(100), np.zeros(400)]
    gauss = np.random.default_rng(1).normal(size=200_000)
    moments = np.array([[np.mean(x**k) for x in (mixture, -mixture, gauss)] for k in (2, 4)])
    assert binder(*moments) == pytest.approx([1 - 5 / 3, 1 - 5 / 3, 0.0], abs=0.02)
    assert binder(np.ones(1), np.ones(1)) == pytest.approx(2 / 3)
    assert np.isnan(binder(np.zeros(1), np.zeros(1))).all()


def _boats(angles: NDArray[np.float64], turned: object = np.pi / 2) -> NDArray[np.float64]:
    """Poses at polar angles, 160 cm from the center, turned from the way outward."""
    return np.stack([160 * np.cos(angles), 160 * np.sin(angles), angles + turned], axis=1)


def with_poses(poses: NDArray[np.float64]) -> flockenv.Recording:
    run = recorded(np.zeros(1000), np.zeros(1000))
    parameters = run.parameters.replace(n_boats=poses.shape[1])
    return replace(run, pose=poses, velocity=np.zeros_like(poses), parameters=parameters)


def recorded(outward: NDArray[np.float64], m: NDArray[np.float64]) -> flockenv.Recording:
    """A run of 1000 samples whose Ψ_o cos φ_o and m are these."""
    parameters = flockenv.FlockParameters.preset("simulation")
    samples = 1000
    orders = {name: np.zeros(samples) for name in ORDER_NAMES}
    orders["psi_o"] = np.hypot(outward, m)
    orders["phi_o"] = np.arctan2(m, outward)
    orders["c_v"] = np.full(samples, 100.0)
    return flockenv.Recording(
        time_s=np.arange(samples) / 10,
        phase=np.full(samples, "fw", "<U4"),
        in_analysis_window=np.ones(samples, np.bool_),
        pose=np.tile(_boats(np.linspace(0.0, 6.0, parameters.n_boats)), (samples, 1, 1)),
        velocity=np.zeros((samples, parameters.n_boats, 3)),
        order=flockenv.OrderSeries(**orders),
        parameters=parameters,
        seed=0,
        version=flockenv.__version__,
        duration_s=100.0,
    )


def test_an_open_loop() -> None:
    there = np.arange(1000) < 500
    run = recorded(np.where(there, 0.1, 0.7), np.where(there, -0.9, 0.0))
    up, down = hysteresis(run)
    assert up == pytest.approx(0.1)
    assert down == pytest.approx(0.7)
    assert Loops([run, run]).openings == pytest.approx([0.6, 0.6])


def test_runs_at_one_density_count_in_their_second_half() -> None:
    late = np.arange(1000) > 500
    jam = Stationary([recorded(np.where(late, 0.8, 0.0), np.where(late, 0.1, 1.0))] * 2, 7)
    assert jam.outward == pytest.approx([0.8, 0.8])
    # |m| is the same in all that counts, as is C_v.
    assert jam.binder_m == pytest.approx(2 / 3, abs=1e-6)
    assert jam.binder_c_v == pytest.approx(2 / 3, abs=1e-6)
    assert (jam.m_density * np.diff(M_EDGES)).sum() == pytest.approx(1.0)


def test_student() -> None:
    # On paper: s = sqrt(2), t(0.975, 1) = 12.706, so ± 12.706.
    assert student_interval(np.array([1.0, 3.0])) == pytest.approx((2.0, -10.706, 14.706), abs=1e-3)
    assert np.isnan(student_interval(np.array([1.0]))[1:]).all()


def test_how_the_time_to_dissolve_grows() -> None:
    measured = grown(0.5)
    for (growth, _, _), point in measured.stationary.items():
        point.jams.dissolved_s = np.array([0.9, 1.1]) * growth.n_boats**1.5
    assert measured.dissolution_growth("whole pool", 8)[0] == pytest.approx(1.5)
    last = measured.stationary[Growth("whole pool", 800), 8, "one-jam"]
    last.jams.dissolved_s = np.array([100.0, np.nan])
    assert np.isnan(measured.dissolution_growth("whole pool", 8)[0])


def test_growing_keeps_the_density() -> None:
    areas = {}
    for way in ("whole pool", "circumference"):
        pools = [Growth(way, n).parameters(32).pool for n in (50, 800)]
        areas[way] = [np.subtract(*np.square(pool)) for pool in pools]
        assert areas[way][1] / areas[way][0] == pytest.approx(16)
        widths = [np.subtract(*pool) for pool in pools]
        ratio = widths[1] / widths[0]
        assert ratio == pytest.approx(1.0 if way == "circumference" else 4.0)
    assert areas["whole pool"] == pytest.approx(areas["circumference"])
    # As dense as 32 boats in the pool of 500.
    assert areas["whole pool"][0] / 50 == pytest.approx(np.pi * (180**2 - 97**2) / np.pi / 32)


def jams(*mean_sizes: float) -> Jams:
    found = object.__new__(Jams)
    found.mean_size = np.array(mean_sizes)
    found.share = found.largest = np.full(len(mean_sizes), 0.5)
    found.first_s = np.full(len(mean_sizes), 60.0)
    return found


_SIZES = (100, 200, 400, 800)
_SLOWER = "inconclusive, though jams grow more slowly than the flock at every density"


def grown(power: float, memory: float = 1.0) -> Measured:
    """Jams of 20 n^power boats, `memory` times as many from rotation, at one density."""
    design = TransitionDesign(
        sizes=_SIZES,
        densities={"whole pool": (8,), "circumference": (8,)},
        largest_loop=0,
        runs=2,
        stationary_minutes=1.0,
        loop_minutes=1.0,
    )
    stationary = {}
    for growth, density, start in design.points():
        # Without room for several jams, small flocks do not count.
        size = 20.0 * growth.n_boats**power if growth.n_boats >= 200 else 7.0
        size *= memory if start == "rotating" else 1.0
        point = object.__new__(Stationary)
        point.jams = jams(0.99 * size, 1.01 * size)
        stationary[growth, density, start] = point
    return Measured(design, stationary, {}, {})


@pytest.mark.parametrize(
    ("way", "power", "memory", "found"),
    [
        ("whole pool", 1.0, 1.0, "of first order"),
        ("whole pool", 1.0, 0.3, "of first order"),
        ("circumference", 0.8, 0.3, "of first order"),
        ("whole pool", 0.5, 1.0, "not of first order"),
        ("circumference", 0.0, 1.0, "not of first order"),
        ("circumference", 0.0, 0.3, f"{_SLOWER}. It is not shown that flocks forget"),
        ("circumference", 0.0, 0.0, f"{_SLOWER}. It is not shown that flocks forget"),
        ("circumference", 0.5, 1.0, f"{_SLOWER}. It is not shown that jams grow with the width"),
        ("whole pool", 0.0, 1.0, f"{_SLOWER}. It is not shown that jams grow with the width"),
    ],
)
def test_the_size_of_jams_decides(way: str, power: float, memory: float, found: str) -> None:
    growth, forgotten = judge_jams(grown(power, memory), way)
    assert [claim.claim for claim in growth] == [ONE_PHASE, CHANNEL_SIZE]
    assert [claim.claim for claim in forgotten] == [FORGOTTEN]
    assert growth[0].measured == pytest.approx(power)
    assert growth[1].measured == pytest.approx(power - (0.5 if way == "whole pool" else 0.0))
    assert forgotten[0].measured == pytest.approx(memory)
    assert conclusion(growth, forgotten).startswith(found)


def test_the_size_of_jams_is_that_of_boats_and_not_of_runs() -> None:
    measured = grown(0.0)
    growth = Growth("circumference", 200)
    for start, share, size in (("rotating", 0.1, 10.0), ("one-jam", 0.3, 50.0)):
        found = measured.stationary[growth, 8, start].jams
        found.share, found.mean_size = np.full(2, share), np.full(2, size)
    # On paper: 10 boats of 100 in jams of 10 and 30 in jams of 50 are in jams of 40 on average.
    # The others are in jams of 20; the slope at x = -ln 2, 0, ln 2 is half of ln(20/40)/ln 2.
    slope = measured.jam_growth("circumference", 8)
    assert slope[0] == pytest.approx(-0.5, abs=1e-3)
    assert measured.memory(growth, 8)[0] == pytest.approx(0.2)


def test_jams_of_runs() -> None:
    apart = _boats(np.arange(6) * 2.0 * np.pi / 6)
    six = _boats(np.arange(6) * 10.3 / 160.0, 0.0)
    four = _boats(np.arange(6) * 10.3 / 160.0, np.array([0.0] * 4 + [np.pi] * 2))
    frames = np.array([apart, apart, four, six])
    found = Jams([with_poses(frames[np.repeat([0, 1, 2, 3], 250)])])
    # The second half counts, but for the sample at its very start.
    assert found.share == pytest.approx(5 / 6, abs=1e-3)
    # On paper: half of the frames hold 4² + 6² over 4 + 6.
    assert found.mean_size == pytest.approx(5.2, abs=0.01)
    assert found.largest == pytest.approx(5.0, abs=0.01)
    # None of these jams has `NUCLEUS` boats.
    assert np.isnan(found.first_s).all()
    assert found.dissolved_s == pytest.approx(0.0)
    twelve = np.arange(12) * 10.3 / 160.0
    frames = np.array([_boats(twelve, np.pi), _boats(twelve, 0.0)])
    found = Jams([with_poses(frames[np.repeat([0, 1], 500)])])
    assert found.first_s.tolist() == [50.0]
    found = Jams([with_poses(frames[np.repeat(places, 500)]) for places in ([1, 0], [1, 1])])
    assert found.dissolved_s[0] == 50.0
    assert np.isnan(found.dissolved_s[1])


def test_a_map_of_jams() -> None:
    # Two boats at 1° facing outward, one at 181° facing along the wall.
    pose = _boats(np.radians([1.0, 1.0, 181.0]), np.array([0.0, 0.5, np.pi / 2]))
    found = JamMap([with_poses(np.tile(pose, (1000, 1, 1)))])
    assert found.share.shape == (1000, 180)
    assert (found.n_boats, found.minutes) == (3, pytest.approx(100 / 60))
    assert found.share[7, 0] == pytest.approx(2 * 180 / 3)
    assert found.share[7, 1:].max() == 0.0


def test_a_small_design_from_runs_to_tables(tmp_path: object) -> None:
    densities = {"whole pool": (5, 10), "circumference": (5, 10)}
    design = TransitionDesign(
        sizes=(20, 40),
        densities=densities,
        largest_loop=20,
        runs=2,
        stationary_minutes=1.0,
        loop_minutes=1.0,
    )
    settings = Settings(minutes=1.0)
    reproduction = transition_order(design)
    specs = reproduction.runs(settings)
    # In two ways, for two seeds: two sizes at two densities, and one at the fine substep, from two
    # starts each, and one size in each kind of loop.
    runs = 2 * 2 * ((2 * 2 + 1) * 2 + len(LOOPS))
    assert len(specs) == len(set(specs)) == runs
    minutes = {kind: design.loop(settings, Growth("whole pool", 20), kind)[0] for kind in LOOPS}
    assert [spec.duration_s / 60 for spec in minutes.values()] == [1.0, 3.0, 9.0, 1.0]
    store = RunStore(tmp_path)  # type: ignore[arg-type]
    assert run_missing(specs, store) == {}
    outcome = reproduction.analyze(settings, Results(store, specs))
    assert len(outcome.tables["transition"]) == len(outcome.tables["jams"]) == 2 * 4 * 2
    assert len(outcome.tables["substeps"]) == 2 * 2 * 2
    nucleation = outcome.tables["nucleation"]
    assert len(nucleation) == 2 * 4
    assert (nucleation["with one later"] == 0).all()
    assert (nucleation["with a jam before 10 min"] <= nucleation["runs"]).all()
    dissolution = outcome.tables["dissolution"]
    assert len(dissolution) == 2 * 4
    assert (dissolution["dissolved"] <= dissolution["runs"]).all()
    # In each way: three claims at each density, one for each size, two for the loops, lifetimes.
    assert len(outcome.claims) == 2 * (2 * 3 + 2 + 2 + 1)
    lifetimes = outcome.tables["lifetimes"]
    minutes_in = lifetimes["rotating, min"].astype(float) + lifetimes["jammed, min"].astype(float)
    # Two runs of a minute from each of two starts, of samples 10 s apart.
    assert minutes_in.between(4 * 0.9, 4 * 1.2).all()
    assert outcome.tables["loops"]["there"].between(-1, 1).any()
    histograms = outcome.tables["histograms"]
    m = histograms[histograms["quantity"] == "m"]
    width = m["bin_high"] - m["bin_low"]
    total = (m["probability_density"] * width).sum()
    assert total == pytest.approx(16)
    assert set(outcome.pictures) == {
        "jams",
        "jam-maps",
        "transition-order",
        "loops",
        "cumulants",
        "histograms_m",
        "histograms_c_v",
    }
    verdicts = [note for note in outcome.notes if note.startswith("Where the ")]
    assert all("conclus" in note or "first order" in note for note in verdicts)
    assert len(verdicts) == 2


def test_large_flocks_get_time_to_forget_their_start() -> None:
    settings = Settings()
    minutes = {
        n: FULL.stationary(settings, Growth("whole pool", n), 6, "one-jam")[0].duration_s / 60
        for n in (200, 400, 800)
    }
    assert minutes == {200: 40.0, 400: 40.0, 800: 80.0}


def test_the_budget_chooses_the_design() -> None:
    costs = [design.core_minutes(Settings()) for design in DESIGNS]
    assert costs == sorted(costs)
    for design, cost in zip(DESIGNS, costs, strict=True):
        assert within(Settings(budget_core_min=cost + 0.1)) is design
    assert within(Settings(budget_core_min=1e6)) is FULL
    assert within(Settings(minutes=1.0, budget_core_min=8.0)) is FULL
    with pytest.raises(flockenv.ParameterError, match="budget = 1 core-minutes is not enough"):
        within(Settings(budget_core_min=1.0))
    with pytest.raises(flockenv.ParameterError, match="budget = nan"):
        Settings(budget_core_min=float("nan"))


@pytest.mark.parametrize("design", DESIGNS)
def test_every_design_has_three_sizes_with_room_for_jams(design: TransitionDesign) -> None:
    specs = transition_order(design).runs(Settings())
    assert sum(size >= MANY_BOATS for size in design.sizes) >= 3
    loops = {spec.protocol for spec in specs} - {*STARTED}
    assert loops == {"rotating-density-loop", "rotating-length-loop", "rotating-noise-loop"}


@pytest.mark.parametrize(
    ("back", "verdict", "note"),
    [(0.1, "inconclusive", "the loop never left rotation"), (0.7, "holds", "")],
)
def test_a_loop_that_never_jams_is_no_closed_loop(back: float, verdict: str, note: str) -> None:
    growth = Growth("circumference", 400)
    design = TransitionDesign(
        sizes=(400,),
        densities={growth.way: (20,)},
        largest_loop=400,
        runs=2,
        stationary_minutes=1.0,
        loop_minutes=1.0,
    )
    steady = np.full(1000, 0.1)
    stationary = Stationary([recorded(steady, steady)] * 2, 7)
    there = np.arange(1000) < 450
    loop = Loops([recorded(np.where(there, 0.1, back), steady)] * 2)
    measured = Measured(
        design,
        {(growth, 20, start): stationary for start in STARTED},
        {(growth, kind): loop for kind in LOOPS},
        {},
    )
    _, hysteresis_claim, lag = judge(measured, growth)
    assert (hysteresis_claim.verdict, hysteresis_claim.note) == (verdict, note)
    # As open when slower: 0.3 of the opening is left.
    assert lag.verdict == verdict
