"""Which of two sides a flock follows, on series whose answer is known.

On paper: minutes that are all at 0.6 or -0.6 have the cumulant 2/3, evenly spread ones 0.4, normal
ones 0; a flock that
turns after 10 and 20 of 30 minutes went one way for 30 minutes and left it twice, so that a way
lasts 15.
"""

import math
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import flockenv
from flockenv.reproduce.conflicting_targets import conflict
from flockenv.reproduce.conflicting_targets.conflict import conflicting_targets, judge
from flockenv.reproduce.conflicting_targets.design import (
    AGAINST,
    DESIGNS,
    FULL,
    LEADERLESS,
    POLICIES,
    POOLS,
    ConflictDesign,
    Setup,
    within,
)
from flockenv.reproduce.conflicting_targets.measured import (
    Measured,
    cumulant,
    decision_min,
    lifetime_min,
    minute_means,
    slope,
    time_ratio,
)
from flockenv.reproduce.reproduction import Results, Settings
from flockenv.runs.spec import RunSpec, execute
from flockenv.runs.store import RunStore, run_missing
from flockenv.statistics.intervals import RESAMPLES

Series = NDArray[np.float64]


def test_a_side_has_the_flock_from_the_minute_that_lasts() -> None:
    series = np.array([0.1, 0.6, -0.1, 0.5, 0.1, 0.2, 0.3, 0.2, 0.1, -0.4])
    assert decision_min(series) == 3.0
    assert decision_min(-series) == 10.0
    # Five minutes have to follow.
    assert decision_min(series[:8]) == 8.0
    assert decision_min(series[:9]) == 3.0


def of_minutes(*series: Series, signed: float = 0.0) -> Measured:
    # First halves do not count.
    whole = tuple(np.concatenate([np.zeros(len(each)), each]) for each in series)
    return Measured.of_series(np.full(len(series), signed), whole, 7)


def test_cumulant_and_lifetime() -> None:
    rng = np.random.default_rng(0)
    two = of_minutes(np.repeat([0.6, -0.6, 0.6], 10), np.repeat([-0.6, 0.6, -0.6], 10))
    assert cumulant(two)[0] == pytest.approx(2 / 3)
    assert lifetime_min(two)[0] == pytest.approx(15.0)
    assert two.means["still"][0] == 0.0
    even = of_minutes(np.linspace(-0.6, 0.6, 1000))
    assert cumulant(even)[0] == pytest.approx(0.4, abs=0.01)
    normal = of_minutes(*rng.normal(0.0, 0.2, (40, 200)))
    assert cumulant(normal)[0] == pytest.approx(0.0, abs=0.05)
    assert math.isnan(lifetime_min(of_minutes(np.full(30, 0.6)))[0])
    assert len(cumulant(two)) == RESAMPLES + 1


def test_the_slope_of_a_line() -> None:
    found = [np.full(RESAMPLES + 1, 0.3 + 0.5 * x) for x in (0.0, 0.2, 1.0)]
    assert slope([0.0, 0.2, 1.0], found) == pytest.approx(0.5)


def test_times_are_compared_where_both_sides_get_the_flock() -> None:
    def after(*minutes: int) -> Measured:
        runs = tuple(np.where(np.arange(40) >= first, 0.7, -0.1) for first in minutes)
        return Measured.of_series(np.zeros(len(runs)), runs, 5)

    assert time_ratio(after(5, 15), after(20, 20))[0] == pytest.approx(0.5)
    assert time_ratio(after(5, 99), after(20, 20))[0] == pytest.approx(22.5 / 20)
    assert np.isnan(time_ratio(after(5, 99, 99), after(20, 20, 20))).all()


def test_minutes_are_means_over_whole_minutes() -> None:
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=2, target=["cw", "ccw"])
    spec = RunSpec(parameters=parameters, seed=1, duration_s=150.0, sample_hz=0.5, keep="order")
    run = execute(spec)
    found = minute_means(run)
    rotation = run.order.rotation()
    assert found == pytest.approx([rotation[:30].mean(), rotation[30:60].mean()])


def judged(order: dict[int, float], tie: Series, alone: Series) -> dict[str, set[str]]:
    """Verdicts by claim, where flocks with k1 - k2 = d have the signed order `order[d]`."""
    design = ConflictDesign(runs={"steering law": 4}, sizes=(27,), minutes=60.0)
    found = {}
    for setup in design.setups():
        for match in (LEADERLESS, *design.matches(setup)):
            signed = np.full(4, order[match[0] - match[1]]) + 0.01 * np.arange(4)
            late = alone if match == LEADERLESS else tie if match[0] == match[1] else np.zeros(30)
            early = np.where(np.arange(30) < 40 - 10 * (match[0] - match[1]), 0.0, 0.7)
            minutes = tuple(np.concatenate([early, late]) for _ in range(4))
            found[setup, match] = Measured.of_series(signed, minutes, 3)
    verdicts: dict[str, set[str]] = {}
    for checked in judge(design, found):
        verdicts.setdefault(checked.claim.text, set()).add(checked.verdict)
    return verdicts


def test_claims_follow_their_rule() -> None:
    two_ways = np.repeat([0.6, -0.6, 0.6], 10)
    stalled = np.tile([0.2, 0.0, 0.0, 0.0, -0.2], 6)
    by_difference = {0: 0.0, 1: 0.2, 2: 0.4, 4: 0.6, 6: 0.7}
    found = judged(by_difference, tie=two_ways, alone=two_ways)
    assert found[conflict.LARGER.text] == {"holds"}
    assert found[conflict.DIFFERENCE.text] == {"holds"}
    assert found[conflict.NUMBER.text] == {"holds"}
    assert found[conflict.PROPORTION.text] == {"does not hold"}
    assert found[conflict.SOONER.text] == {"holds"}
    assert found[conflict.CHOOSES.text] == {"holds"}
    assert found[conflict.STALLS.text] == {"inconclusive"}  # As much as without leaders.
    assert found[conflict.KEEPS.text] == {"holds"}
    opposite = {difference: -value for difference, value in by_difference.items()}
    found = judged(opposite, tie=stalled, alone=two_ways)
    assert found[conflict.LARGER.text] == found[conflict.DIFFERENCE.text] == {"does not hold"}
    assert found[conflict.CHOOSES.text] == {"does not hold"}
    assert found[conflict.STALLS.text] == {"holds"}
    # A flock that goes neither way has no way to keep.
    assert found[conflict.KEEPS.text] == {"inconclusive"}


def test_an_open_claim_says_what_it_needs() -> None:
    found = conflict._judged(conflict.LARGER, (0.1, -0.1, 0.3), "scope", 12)
    assert found.note == "inconclusive: needs about 48 runs for each match, where it has 12"
    found = conflict._judged(conflict.LARGER, (0.001, -0.1, 0.3), "scope", 12)
    assert found.note == "inconclusive: needs more than 100 times as many runs for each match"
    assert conflict._judged(conflict.LARGER, (0.2, 0.1, 0.3), "scope", 12).note == ""
    undefined = (math.nan, math.nan, math.nan)
    assert "longer runs" in conflict._judged(conflict.LARGER, undefined, "scope", 12).note


def test_every_run_is_of_leaders_that_head_both_ways() -> None:
    setup = Setup("steering law", "table-1", 100)
    parameters = setup.parameters((8, 4))
    assert parameters.target == ("cw",) * 8 + ("ccw",) * 4
    assert (parameters.n_boats, parameters.n_leaders, parameters.bw_s) == (100, 12, 0.45)
    assert setup.parameters(LEADERLESS).n_leaders == 0
    assert FULL.matches(setup)[1] == (4, 4)
    protocols = {spec.protocol for spec in FULL.all_runs(Settings())}
    expected = {form.format(pool=pool) for form in POLICIES.values() for pool in POOLS}
    assert protocols == expected


def test_opponents_follow_their_own_policies() -> None:
    parameters = Setup(AGAINST, "table-1", 27).parameters((1, 1))

    def rudders(protocol: str, target: object) -> Series:
        from flockenv.policies.registry import POOL_POLICIES
        from flockenv.runs.protocols import opponents

        policy = POOL_POLICIES["learned"]("table-1")
        chosen = parameters.replace(target=target)
        if protocol == "against":
            run = opponents.simulate_against_the_law(chosen, 1, 0.2, 10.0, policy)
        elif protocol == "law":
            law = flockenv.policies.SteeringLaw(
                observation=policy.observation, mirror_to_target=policy.mirror_to_target
            )
            run = flockenv.simulate(chosen, 1, 0.2, policy=law)
        else:
            run = flockenv.simulate(chosen, 1, 0.2, policy=policy)
        assert run.rudder is not None
        return np.asarray(run.rudder[1], np.float64)

    both = rudders("against", ("cw", "ccw"))
    assert both[0] == rudders("learned", ("cw", "ccw"))[0]
    assert both[1] == rudders("law", ("cw", "ccw"))[1]
    with pytest.raises(flockenv.ParameterError, match="both directions"):
        rudders("against", "cw")


SMALL = ConflictDesign(runs=dict.fromkeys(POLICIES, 2), sizes=(27,), minutes=2.0)


def test_a_small_design_from_runs_to_tables(tmp_path: Path) -> None:
    settings = Settings()
    reproduction = conflicting_targets(SMALL)
    specs = reproduction.runs(settings)
    assert len(specs) == len(set(specs)) == 2 * 2 * (1 + 3 * 8 + 3)
    store = RunStore(tmp_path)
    assert run_missing(specs, store) == {}
    outcome = reproduction.analyze(settings, Results(store, specs))
    table = outcome.tables["matches"]
    assert len(table) == 2 * (1 + 3 * 8 + 3)
    assert set(outcome.pictures) == {"conflicting-targets", "rotation"}
    alike, against = 4 + 4 + 2 * 3, 3
    assert len(outcome.claims) == 2 * (3 * alike + against)
    open_claims = [each for each in outcome.claims if each.verdict == "inconclusive"]
    assert open_claims
    assert all("inconclusive: needs" in each.note for each in open_claims)


def test_the_budget_chooses_the_design() -> None:
    costs = [design.core_minutes(Settings()) for design in DESIGNS]
    assert costs == sorted(costs)
    for design, cost in zip(DESIGNS, costs, strict=True):
        assert within(Settings(budget_core_min=cost + 0.1)) is design
    with pytest.raises(flockenv.ParameterError, match="not enough for conflicting-targets"):
        within(Settings(budget_core_min=0.5))


def test_larger_designs_contain_the_runs_of_smaller_ones() -> None:
    runs = [set(conflicting_targets(design).runs(Settings())) for design in DESIGNS]
    assert all(fewer < more for fewer, more in pairwise(runs))


SHORT = ("conflicting-targets", "--budget", "0.05", "--minutes", "1", "--quiet")


def written(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / SHORT[0]).iterdir()}


def test_killed_and_resumed_it_writes_the_same_bytes(cli, tmp_path: Path) -> None:
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    done = cli("reproduce", *SHORT, "--out", str(whole), "--summary", str(whole / "page.md"))
    assert done.returncode == 0, done.stderr
    assert "conflicting-targets" in (whole / "page.md").read_text()
    for name in ("claims", "matches"):
        data = (whole / "page" / f"{name}.csv").read_bytes()
        assert data == (whole / "conflicting-targets" / f"{name}.csv").read_bytes()
    with cli.start("reproduce", *SHORT, "--out", killed) as process:
        deadline = time.monotonic() + 120
        while len(list(killed.rglob("*.npz"))) < 10:
            assert process.poll() is None, "it ended before it could be stopped"
            assert time.monotonic() < deadline
            time.sleep(0.002)
        process.kill()
        process.communicate(timeout=60)
    assert not (killed / SHORT[0]).exists()
    done = cli("reproduce", *SHORT, "--out", str(killed))
    assert done.returncode == 0, done.stderr
    assert written(killed) == written(whole)


def test_a_budget_too_small_is_refused(cli, tmp_path: Path) -> None:
    done = cli("reproduce", SHORT[0], "--budget", "0.5", "--out", str(tmp_path / "none"))
    assert done.returncode == 2
    assert "is not enough for conflicting-targets" in " ".join(done.stderr.split())
    assert not (tmp_path / "none").exists()
