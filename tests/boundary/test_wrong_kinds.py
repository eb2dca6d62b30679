"""Law: an argument of the wrong kind is named by its name, and nothing has changed."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv import Flock, FlockParameters, ParameterError, simulate
from flockenv.policies import DampedLaw, RandomRudders
from flockenv.statistics import (
    bootstrap_interval,
    fit_line,
    kaplan_meier,
    mean_interval,
    paired_difference,
    summarize,
)
from flockenv.tracks import export, recording_of

PARAMETERS = FlockParameters(n_boats=4, n_leaders=2, pool="narrow")
RUN = simulate(PARAMETERS, 3, 0.5)
RUNS = pd.DataFrame({"policy": ["a", "a", "b"], "order": [1.0, 2.0, 3.0]})


@pytest.mark.parametrize("value", ["no", 1, 0, None, [True]])
@pytest.mark.parametrize(
    ("name", "give"),
    [
        ("include_leaders", lambda value: Flock(PARAMETERS, 3).order_parameters(value)),
        ("contacts", lambda value: simulate(PARAMETERS, 3, 0.1, contacts=value)),
        ("compressed", lambda value: RUN.save("no.npz", compressed=value)),
        ("boats", lambda value: RUN.to_dataframe(boats=value)),
        ("overwrite", lambda value: export(RUN, "no.csv", overwrite=value)),
    ],
)
def test_switches_are_true_or_false(name, give, value, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "no.toml").write_text("by hand")
    with pytest.raises(TypeError, match=f"{name} must be True or False, not"):
        give(value)
    assert [each.name for each in tmp_path.iterdir()] == ["no.toml"]


@pytest.mark.parametrize("value", ["text", None, 7, bytearray(b"text"), [1, 2], (1, 2)])
def test_states_are_bytes(value):
    flock, before = Flock(PARAMETERS, 3), Flock(PARAMETERS, 3).snapshot()
    env = flockenv.LeadersEnv(n_boats=4)
    env.reset(seed=0)
    for name, give in (
        ("snapshot", flock.restore),
        ("snapshot", Flock.from_snapshot),
        ("snapshot", lambda value: env.reset(options={"snapshot": value})),
        ("state", env.set_state),
    ):
        with pytest.raises(TypeError, match=f"{name} must be bytes, not"):
            give(value)
    assert flock.snapshot() == before


@pytest.mark.parametrize("value", ["0.1", True, None, [0.1], 1j, pd.NA])
def test_times_and_shares_are_numbers(value):
    for name, give in (
        ("time_s", RUN.state_at),
        ("time_s", kaplan_meier([1.0, 2.0], 3.0).share_at),
        ("after", RUN.analyzed),
    ):
        with pytest.raises(TypeError, match=f"{name} must be a number, not"):
            give(value)


@pytest.mark.parametrize("value", [-0.1, 1.1, float("nan")])
def test_a_share_of_a_run_is_none(value):
    with pytest.raises(ParameterError, match="a share, 0 to 1"):
        RUN.analyzed(value)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ("123", "must be a sequence"),
        ({1.0: 2.0}, "must be a sequence"),
        ({1.0, 2.0}, "must be a sequence"),
        (5.0, "must be a sequence"),
        (["1", "2"], "real numbers, not <U1"),
        ([1j, 2j], "real numbers, not complex128"),
        (np.array([1, 2], "M8[s]"), "real numbers, not datetime64"),
        (RUNS, "an array, as a table.s to_numpy"),
        ([[1.0, 2.0], [3.0, 4.0]], r"shape \(2, 2\), expected \(n,\)"),
        ([1.0, [2.0]], "is not accepted: real numbers"),
    ],
)
def test_values_of_runs_are_series_of_numbers(values, words):
    three = [1.0, 2.0, 4.0]
    for name, give in (
        ("values", mean_interval),
        ("theirs", lambda values: paired_difference(three, values)),
        ("samples", lambda values: bootstrap_interval([values], np.mean)),
        ("x", lambda values: fit_line(values, three)),
    ):
        with pytest.raises((ParameterError, TypeError), match=f"{name}.*{words}"):
            give(values)
    assert mean_interval(each for each in three) == mean_interval(three)


@pytest.mark.parametrize(
    ("give", "words"),
    [
        (lambda: fit_line([1, 2, np.nan], [1, 2, 3]), "finite"),
        (lambda: fit_line([1, 2, 3], [1, 2]), "as many numbers"),
        (lambda: kaplan_meier([1.0, 2.0], [3.0]), "until_s has shape"),
        (lambda: kaplan_meier(["1"], 3.0), "times_s is not accepted: real numbers"),
        (lambda: kaplan_meier([1.0], 3.0).share_at(float("nan")), "at least 0 s"),
        (
            lambda: summarize(RUNS, ["policies"], ["order"]),
            "'policies' is not a column of the runs",
        ),
        (lambda: summarize(RUNS, ["policy"], ["Order"]), "did you mean 'order'"),
    ],
)
def test_statistics_of_what_cannot_be_are_refused(give, words):
    with pytest.raises(ParameterError, match=words):
        give()


def test_columns_are_sequences_of_names():
    with pytest.raises(TypeError, match="by must be a sequence, not 'policy'"):
        summarize(RUNS, "policy", ["order"])
    once = summarize(RUNS, iter(["policy"]), iter(["order"]))
    assert once.equals(summarize(RUNS, ["policy"], ["order"]))


def tracked(**given):
    return recording_of(**{"time_s": RUN.time_s, "pose": RUN.pose, "pool": "narrow", **given})


def test_tracks_take_what_can_be_gone_through_once():
    kept = {"ids": ["a", "b", "c", "d"], "leaders": ["d", "b"], "target": ("cw", "ccw")}
    kept |= {"hull": (5.0, 0.5), "phase": RUN.phase.tolist(), "discs": [(70.0, 0.0, 2.0)]}
    assert tracked(**{name: iter(value) for name, value in kept.items()}) == tracked(**kept)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"phase": "fw"}, "phase must be a sequence"),
        ({"hull": 5.0}, "hull must be a sequence"),
        ({"hull": (5.0, 0.5, 1.0)}, "two numbers"),
        ({"pose": RUN.pose + 1j}, "pose is not accepted: real numbers, not complex128"),
        ({"pose": RUN.pose.astype(str)}, "pose is not accepted: real numbers, not <U"),
        ({"time_s": (1e9 * RUN.time_s).astype("m8[ns]")}, "time_s is not accepted: real numbers"),
        ({"velocity": "still"}, "velocity is not accepted: real numbers"),
    ],
)
def test_tracks_of_another_kind_are_refused(given, words):
    with pytest.raises((ParameterError, TypeError), match=words):
        tracked(**given)


@pytest.mark.parametrize("policy", [DampedLaw, RandomRudders])
def test_a_class_of_policies_stands_for_what_it_makes(policy):
    assert simulate(PARAMETERS, 3, 1.0, policy=policy) == simulate(
        PARAMETERS, 3, 1.0, policy=policy()
    )


@pytest.mark.parametrize("policy", [int, dict, FlockParameters])
def test_a_class_of_something_else_is_no_policy(policy):
    with pytest.raises(ParameterError, match=r"policy = .* is not accepted: a policy's name"):
        simulate(PARAMETERS, 3, 1.0, policy=policy)


@pytest.mark.parametrize("seed", ["1", None, True])
def test_random_rudders_have_a_seed(seed):
    with pytest.raises(TypeError, match="seed must be an integer"):
        RandomRudders(seed)
    with pytest.raises(ParameterError, match=r"seed = 1\.5 is not accepted: a whole number"):
        RandomRudders(1.5)
    with pytest.raises(ParameterError, match="seed = -1 is not accepted: at least 0"):
        RandomRudders(-1)
