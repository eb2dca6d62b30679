"""Law: a run starts, changes, is steered and is measured as it is told."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

import flockenv
from flockenv import Flock, FlockParameters, ParameterError, Recording, simulate
from flockenv.policies import StraightAhead

PARAMETERS = FlockParameters(n_boats=10, n_leaders=2, pool="narrow")


class Held:
    """The same rudder at all times."""

    def __init__(self, rudder: float, decision_period_s: float = 0.1) -> None:
        self.rudder, self.decision_period_s = rudder, decision_period_s

    def predict(self, observation, state=None, episode_start=None):
        return np.full(len(observation), self.rudder), state


class Returns(Held):
    """Whatever it is told."""

    def predict(self, observation, state=None, episode_start=None):
        return self.rudder


class Says(Held):
    """Attributes that say how it is made."""

    def __init__(self, **attributes) -> None:
        super().__init__(0.0)
        vars(self).update(attributes)


class Masked(Held):
    """The same, but masked."""

    def predict(self, observation, state=None, episode_start=None):
        rudders, state = super().predict(observation, state)
        return np.ma.masked_equal(rudders, self.rudder), state


@pytest.mark.parametrize(
    ("schedule", "words"),
    [
        ([(1.0, {"n_boats": 11})], "n_boats cannot change"),
        ([(1.0, {"bw": 1.0})], "'bw' is not a field.*'bw_s'"),
        ([(1.0, {"bw_s": -1.0})], "bw_s"),
        ([(1.0, {"target": "left"})], "target"),
        ([(1.0, {"pool": (20.0, 15.0)})], "n_boats"),
        ([(1.0, {"pool": (math.inf, 0.0)})], "open water"),
        ([(2.0, {"bw_s": 1.0})], "a change at 2 s.*before the last sample, at 2 s"),
        ([(1.0, {"bw_s": 1.0}), (7, {"bw_s": 2.0})], "a change at 7 s"),
        ([(1.0, {})], "a dictionary of fields"),
        ([(1.0, {"bw_s": 1.0, "c4": 2.0}), (1, {"bw_s": 2.0})], "bw_s changes twice"),
        ([(1.0, {"pool": (60.0, 0.0), "boat_radius_cm": 30.0})], "schedule = .*do not fit"),
        ([(1.0, {1: 2})], "'1' is not a field"),
        ([(True, {"bw_s": 1.0})], "a time in s"),
        ([(np.timedelta64(1, "s"), {"bw_s": 1.0})], "a time in s"),
        ([(7.0, {"bw_s": PARAMETERS.bw_s})], "a change at 7 s"),
        ([("1.0", {"bw_s": 1.0})], "a time in s"),
        ([(-1.0, {"bw_s": 1.0})], "a time in s"),
        ([(float("nan"), {"bw_s": 1.0})], "a time in s"),
        ([{"bw_s": 1.0}], "a time in s"),
        ([(1.0, "ccw")], "a time in s"),
    ],
)
def test_schedules_that_cannot_be_are_refused(schedule, words):
    with pytest.raises(ParameterError, match=words):
        simulate(PARAMETERS, 3, 2.0, schedule=schedule)


def test_a_schedule_leads_no_policy_into_another_pool():
    wide = PARAMETERS.replace(n_leaders=1, pool="wide")
    for policy in ("learned", {"leader_0": flockenv.policies.load("learned", pool="wide")}):
        with pytest.raises(ParameterError, match="made for pool = 'wide'"):
            simulate(wide, 3, 2.0, policy=policy, schedule=[(1.0, {"pool": "narrow"})])


@pytest.mark.parametrize("schedule", [{1.0: {"bw_s": 2.0}}, "bw_s", 7, {(1.0, "bw_s")}])
def test_schedules_are_sequences(schedule):
    with pytest.raises(TypeError, match="schedule must be a sequence"):
        simulate(PARAMETERS, 3, 2.0, schedule=schedule)


def test_a_schedule_without_end_is_refused():
    endless = itertools.repeat((1.0, {"bw_s": 1.0}))
    with pytest.raises(ParameterError, match="more than 1000000 items"):
        simulate(PARAMETERS, 3, 2.0, schedule=endless)


def test_what_is_set_to_what_it_is_changes_nothing():
    """As the first step of a ramp; other parameters restart the random streams."""
    same = [(1.0, {"bw_s": PARAMETERS.bw_s, "pool": "narrow"}), (2.0, {"c4": PARAMETERS.c4})]
    assert simulate(PARAMETERS, 3, 6.0, schedule=same) == simulate(PARAMETERS, 3, 6.0)
    other = simulate(PARAMETERS, 3, 6.0, schedule=[(1.0, {"target": "ccw"})])
    both = [(1.0, {"target": "ccw", "bw_s": PARAMETERS.bw_s})]
    assert simulate(PARAMETERS, 3, 6.0, schedule=both) == other


def test_a_schedule_acts_in_whatever_holds_it():
    times, changes = [1.0, 4], [{"bw_s": 1.5}, {"target": "ccw"}]
    pairs = list(zip(times, changes, strict=True))
    expected = simulate(PARAMETERS, 3, 6.0, 2.0, schedule=pairs)
    assert expected != simulate(PARAMETERS, 3, 6.0, 2.0)
    for schedule in (
        zip(times, changes, strict=True),
        (pair for pair in pairs),
        iter(pairs),
        map(tuple, pairs),
        reversed(pairs),
        dict(enumerate(pairs)).values(),
        dict(pairs).items(),
        np.array([*pairs, None], object)[:2],
        [(np.int64(1), changes[0]), (np.float32(4), changes[1])],
        [(Fraction(1), changes[0]), [4.0, changes[1]]],
    ):
        assert simulate(PARAMETERS, 3, 6.0, 2.0, schedule=schedule) == expected


def test_what_fails_on_the_way_leaves_the_run_until_then():
    """A disc appears where boats are: whether they are in its way is known when its time comes."""
    disc = {"discs": [(0.0, 0.0, 45.0)]}
    pool = PARAMETERS.replace(pool=(90.0, 0.0), n_boats=27)
    with pytest.raises(ParameterError, match="overlap") as raised:
        simulate(pool, 3, 4.0, schedule=[(2.0, disc)])
    assert raised.value.recording.time_s[-1] == 2.0
    assert raised.value.recording == simulate(pool, 3, 2.0)

    class Breaks(Held):
        def predict(self, observation, state=None, episode_start=None):
            if (state or 0) == 10:
                raise KeyboardInterrupt
            return super().predict(observation)[0], (state or 0) + 1

    with pytest.raises(KeyboardInterrupt) as stopped:
        simulate(PARAMETERS, 3, 4.0, policy=Breaks(0.5))
    whole = simulate(PARAMETERS, 3, 1.0, policy=Held(0.5))
    assert np.array_equal(stopped.value.recording.pose, whole.pose)


def test_boats_start_in_the_water():
    """A start of another pool is not pushed in; a hull's width (10 cm) is what contacts may."""
    wide = simulate(PARAMETERS.replace(n_boats=27, pool="wide"), 3, 1.0)
    narrow = wide.parameters.replace(pool="narrow")
    for start in (wide, wide.state_at(1.0)):
        with pytest.raises(ParameterError, match=r"pose = \[.*of boat .*in the water"):
            simulate(narrow, 3, 1.0, start=start)
    env = flockenv.LeadersEnv(n_boats=27, pool="narrow")
    with pytest.raises(ParameterError, match="in the water"):
        env.reset(options={"state": wide.state_at(1.0)})
    pair = PARAMETERS.replace(n_boats=2, n_leaders=0, pool=(90.0, 40.0))
    for radius_cm, goes in ((29.0, False), (31.0, True), (99.0, True), (101.0, False)):
        pose = [[radius_cm, 0.0, 0.0], [0.0, 70.0, 0.0]]
        start = {"pose": pose, "allow_overlap": True}
        if goes:
            assert simulate(pair, 3, 0.0, start=start).pose[0].tolist() == pose
        else:
            with pytest.raises(ParameterError, match=r"of boat 0 is not accepted.*hull's width"):
                simulate(pair, 3, 0.0, start=start)


def test_the_state_of_a_jam_is_a_start():
    jam = simulate(PARAMETERS.replace(n_boats=27, bw_s=0.0), 3, 30.0)
    state = jam.state_at(30.0)
    del state["allow_overlap"]
    run = simulate(jam.parameters, 3, 1.0, start=state)
    assert np.array_equal(run.pose[0], jam.pose[-1])
    # Two hulls of radius 5 cm side by side, 0.06 and 0.04 cm into each other.
    pair = PARAMETERS.replace(n_boats=2, n_leaders=0)
    for overlap_cm in (0.06, 0.04):
        pose = [[70.0, 0.0, 0.0], [70.0, 10.0 - overlap_cm, 0.0]]
        if overlap_cm < 0.05:
            assert simulate(pair, 3, 0.1, start={"pose": pose}).pose[0].tolist() == pose
        else:
            with pytest.raises(ParameterError, match=r"boats \d and \d overlap"):
                simulate(pair, 3, 0.1, start={"pose": pose})


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_a_run_goes_on_from_where_another_ended(dtype):
    first = simulate(PARAMETERS.replace(n_boats=27, bw_s=0.0), 3, 30.0, dtype=dtype)
    loop = simulate(first.parameters.replace(bw_s=0.5), 4, 5.0, start=first)
    assert loop.time_s[[0, -1]].tolist() == [30.0, 35.0]
    assert np.array_equal(loop.pose[0], first.pose[-1])
    assert np.array_equal(loop.velocity[0], first.velocity[-1])
    with pytest.raises(ParameterError, match="pose"):
        simulate(PARAMETERS.replace(n_boats=26), 4, 5.0, start=first)
    with pytest.raises(ParameterError, match="no poses"):
        simulate(first.parameters, 4, 5.0, start=first.without_poses())


def test_each_leader_has_a_policy_of_its_own():
    assignments = {"leader_1": Held(-0.25), "leader_0": Held(0.5)}
    run = simulate(PARAMETERS, 3, 2.0, policy=assignments)
    assert (run.rudder[1:] == [0.5, -0.25]).all()
    assert run.policy == "leader_0: Held; leader_1: Held"
    both = simulate(PARAMETERS, 3, 2.0, policy=dict.fromkeys(assignments, "damped law"))
    assert np.array_equal(both.pose, simulate(PARAMETERS, 3, 2.0, policy="damped law").pose)
    mixed = simulate(
        PARAMETERS, 3, 2.0, policy={"leader_0": "paper's law", "leader_1": "straight ahead"}
    )
    law = simulate(PARAMETERS, 3, 2.0, policy=flockenv.policies.SteeringLaw())
    assert np.array_equal(mixed.rudder[1], [law.rudder[1, 0], 0.0])
    assert mixed.rudder[1, 0] != 0.0


@pytest.mark.parametrize(
    ("periods_s", "hz"), [((0.1, 0.4), 10.0), ((0.4, 0.1), 10.0), ((0.25, 0.1), 20.0)]
)
def test_a_slower_policy_holds_its_decision(periods_s, hz):
    class Counts(Held):
        def predict(self, observation, state=None, episode_start=None):
            return np.full(len(observation), 0.01 * (state or 0)), (state or 0) + 1

    first, second = (Counts(0.0, period_s) for period_s in periods_s)
    run = simulate(PARAMETERS, 3, 4.0, hz, policy={"leader_0": first, "leader_1": second})
    taken = np.arange(len(run) - 1) / hz
    for leader, period_s in enumerate(periods_s):
        expected = 0.01 * np.floor(taken / period_s + 1e-9)
        assert run.rudder[1:, leader] == pytest.approx(expected)
    given = simulate(
        PARAMETERS, 3, 4.0, 5.0, {"leader_0": first, "leader_1": second}, control_hz=5.0
    )
    assert (given.rudder[1:, 0] == given.rudder[1:, 1]).all()


@pytest.mark.parametrize("pool", ["narrow", (150.0, 50.0), (math.inf, 0.0)])
@pytest.mark.parametrize("how", ["object", "file", "leader by leader"])
def test_a_policy_made_for_a_pool_steers_in_no_other(tmp_path, pool, how):
    law = flockenv.policies.load("learned", pool="wide")
    law.save(tmp_path / "wide.json")
    policy = law if how == "object" else str(tmp_path / "wide.json")
    if how == "leader by leader":
        policy = {"leader_0": policy, "leader_1": "paper's law"}
    assert simulate(PARAMETERS.replace(pool="wide"), 3, 0.5, policy=policy).policy
    with pytest.raises(ParameterError, match=r"pool = .* is not accepted with .*pool = 'wide'"):
        simulate(PARAMETERS.replace(pool=pool), 3, 0.5, policy=policy)


def test_a_mirrored_policy_follows_a_target_that_changes():
    law = flockenv.policies.SteeringLaw
    change = [(1.0, {"target": "ccw"})]
    plain = simulate(PARAMETERS, 3, 3.0, policy=law(), schedule=change)
    assert np.abs(plain.rudder).max() > 0.5
    alone = law(mirror_to_target=True)
    for policy in (alone, {"leader_0": alone, "leader_1": alone}):
        mirrored = simulate(PARAMETERS, 3, 3.0, policy=policy, schedule=change)
        assert mirrored.rudder == pytest.approx(plain.rudder, abs=1e-4)


@pytest.mark.parametrize(
    ("policy", "words"),
    [
        ({"leader_0": "paper's law"}, "a policy for each of leader_0, leader_1"),
        ({"leader_0": "paper's law", "leader_1": "low"}, "'low' is not a policy"),
        ({"leader_0": Held(0.0), "leader_1": Held(0.0, 1 / 997)}, "no common multiple"),
        ({"leader_0": Held(0.0), "leader_1": 7}, "policy = 7"),
        (Held(1j), "what a policy returns is not accepted: real numbers, not complex128"),
        (Held("0.5"), "what a policy returns is not accepted: real numbers, not <U"),
        (Returns(np.zeros(2)), "actions and a state, not array"),
        (Returns(None), "actions and a state, not None"),
        (Returns((np.zeros(2), None, None)), "actions and a state, not"),
        (
            Returns((np.zeros(1), None)),
            r"has shape \(1,\), expected a rudder for each of 2",
        ),
        (
            Returns((np.zeros(3), None)),
            r"has shape \(3,\), expected a rudder for each of 2",
        ),
        (Returns((0.5, None)), r"has shape \(\), expected a rudder for each of 2"),
        (
            Says(control_hz=0.0, decision_period_s=None),
            "control_hz = 0.0 of a policy is not",
        ),
        (Says(decision_period_s=-1.0), "decision_period_s = -1.0 of a policy"),
        (Masked(0.5), "what a policy returns is not accepted: numbers, none masked"),
    ],
)
def test_policies_that_do_not_fit_the_leaders_are_refused(policy, words):
    with pytest.raises(ParameterError, match=words):
        simulate(PARAMETERS, 3, 2.0, policy=policy)


@pytest.mark.parametrize(
    ("attributes", "words"),
    [
        ({"observation": "own"}, "a policy's observation must be a dictionary"),
        ({"mirror_to_target": "yes"}, "a policy's mirror_to_target must be True or False"),
        ({"control_hz": "10", "decision_period_s": None}, "control_hz must be a number"),
        ({"decision_period_s": True}, "decision_period_s must be a number"),
    ],
)
def test_what_policies_say_of_themselves_is_of_its_kind(attributes, words):
    with pytest.raises(TypeError, match=words):
        simulate(PARAMETERS, 3, 2.0, policy=Says(**attributes))


@pytest.mark.parametrize("progress", [5, "yes", True, []])
def test_progress_is_a_function(progress):
    with pytest.raises(TypeError, match="progress must be a function, not"):
        simulate(PARAMETERS, 3, 0.1, progress=progress)


@pytest.mark.parametrize("policy", [None, StraightAhead()])
@pytest.mark.parametrize("control_hz", ["often", True])
def test_a_rate_is_a_number(control_hz, policy):
    with pytest.raises(TypeError, match="control_hz must be a number"):
        simulate(PARAMETERS, 3, 2.0, policy=policy, control_hz=control_hz)


@pytest.mark.parametrize("start", [None, Flock(PARAMETERS, 1).snapshot()])
def test_a_seed_is_a_whole_number(start):
    with pytest.raises(TypeError, match="seed must be an integer"):
        simulate(PARAMETERS, True, 2.0, start=start)
    assert simulate(PARAMETERS, 1.0, 2.0, start=start).seed == 1


@pytest.mark.parametrize("control_hz", [5.0, -1.0])
def test_a_rate_without_a_policy_is_refused(control_hz):
    with pytest.raises(ParameterError, match=r"control_hz = .* is not accepted: without a policy"):
        simulate(PARAMETERS, 3, 2.0, control_hz=control_hz)


def spread_cm(run: Recording) -> np.ndarray:
    return run.pose[..., :2].std(axis=1).mean(axis=1)


def test_own_quantities_go_where_the_recording_goes(tmp_path):
    run = simulate(PARAMETERS, 3, 20.0, 2.0, quantities={"spread_cm": spread_cm})
    assert np.array_equal(run.quantities["spread_cm"], spread_cm(run))
    run.save(tmp_path / "run.npz")
    assert Recording.load(tmp_path / "run.npz") == run
    assert run != simulate(PARAMETERS, 3, 20.0, 2.0)
    late = run.analyzed()
    assert np.array_equal(late.quantities["spread_cm"], spread_cm(late))
    assert run.to_dataframe()["spread_cm"].tolist() == spread_cm(run).tolist()
    assert run.to_xarray()["spread_cm"].dims == ("time_s",)


@pytest.mark.parametrize(
    ("name", "function", "words"),
    [
        ("psi_o", spread_cm, "an identifier that no quantity"),
        ("time_s", spread_cm, "an identifier that no quantity"),
        ("my spread", spread_cm, "an identifier that no quantity"),
        ("", spread_cm, "an identifier that no quantity"),
        (7, spread_cm, "an identifier that no quantity"),
        ("x_cm", spread_cm, "an identifier that no quantity"),
        ("heading_rad", spread_cm, "an identifier that no quantity"),
        ("mine", "spread_cm", "'mine' = 'spread_cm' is not accepted: a function"),
        ("mine", lambda run: spread_cm(run) + 0j, "real numbers, not complex128"),
        ("mine", lambda run: run.time_s.astype(np.complex64), "real numbers, not complex64"),
        ("mine", lambda run: (1e9 * run.time_s).astype("m8[ns]"), "not timedelta64"),
        ("mine", lambda run: run.time_s.astype("M8[s]"), "not datetime64"),
        ("mine", lambda run: run.time_s.astype(str), "real numbers, not <U"),
        ("mine", lambda run: run.time_s.astype("S9"), "real numbers, not .S9"),
        ("mine", lambda run: [10**400] * len(run), "real numbers, not object"),
        ("mine", lambda run: [None] * len(run), "real numbers, not object"),
        ("mine", lambda run: np.full(len(run), "1e4000", np.longdouble), "numbers that fit"),
        ("mine", lambda run: [[1.0], [1.0, 2.0]], "'mine' is not accepted: real numbers"),
        ("mine", lambda run: np.ma.masked, r"shape \(\), expected \(21,\)"),
        ("mine", lambda run: 1 / 0, "'mine' failed: ZeroDivisionError"),
        ("mine", lambda run: run.pose.sort(), "'mine' failed: ValueError.*read-only"),
        ("mine", lambda run: run.order.psi_o.fill(1), "read-only"),
        ("mine", lambda run: run.contacts.force.fill(1), "read-only"),
        ("mine", lambda run: run.rudder.fill(1), "read-only"),
        ("mine", lambda run: spread_cm(run)[1:], r"shape \(20,\), expected \(21,\)"),
        ("mine", lambda run: 1.0, r"shape \(\), expected \(21,\)"),
        ("mine", lambda run: ["a"] * len(run), "'mine' is not accepted: real numbers, not <U1"),
    ],
)
def test_own_quantities_that_are_no_series_are_refused(name, function, words):
    with pytest.raises(ParameterError, match=words) as raised:
        simulate(PARAMETERS, 3, 2.0, contacts=True, quantities={name: function})
    is_known_before = any(each in words for each in ("an identifier", "a function"))
    if not is_known_before:
        assert raised.value.recording == simulate(PARAMETERS, 3, 2.0, contacts=True)
    assert hasattr(raised.value, "recording") != is_known_before


@pytest.mark.parametrize("quantities", [7, [spread_cm], zip(["mine"], [spread_cm], strict=True)])
def test_own_quantities_have_names(quantities):
    with pytest.raises(ParameterError, match="functions by name"):
        simulate(PARAMETERS, 3, 2.0, quantities=quantities)


@pytest.mark.parametrize("dtype", [bool, np.int8, np.uint64, np.float16, np.float32, np.longdouble])
def test_own_quantities_of_any_real_kind_are_kept_as_doubles(dtype):
    run = simulate(PARAMETERS, 3, 2.0, quantities={"mine": lambda run: run.time_s.astype(dtype)})
    assert run.quantities["mine"].dtype == np.float64
    assert (run.quantities["mine"] == run.time_s.astype(dtype)).all()
