"""Shards hold every run once, the same on every machine; a workload is what is missing."""

import re

import pytest

import flockenv
from flockenv.runs.spec import RunSpec, execute
from flockenv.runs.store import RunStore
from flockenv.runs.workload import Shard, measure_workload

PARAMETERS = flockenv.FlockParameters.preset("paper").replace(n_boats=8)
NARROW = PARAMETERS.replace(pool="narrow", n_leaders=1)
SPECS = [RunSpec(parameters=PARAMETERS, seed=seed, duration_s=60.0) for seed in range(300)]


@pytest.mark.parametrize("of", [1, 2, 7, 60])
def test_shards_hold_every_run_once_in_its_order(of):
    specs = SPECS[:60]
    shares = [Shard(number, of).runs_of(specs) for number in range(1, of + 1)]
    assert sorted((spec for share in shares for spec in share), key=specs.index) == specs
    for share in shares:
        assert share == sorted(share, key=specs.index)


@pytest.mark.parametrize("text", ["", "3", "3/", "/8", "3/8/9", "-1/8", "1.5/8", "a/b", "٣/٨"])
def test_other_texts_are_refused(text):
    with pytest.raises(flockenv.ParameterError, match="such as 3/8"):
        Shard.parse(text)


@pytest.mark.parametrize("text", ["0/8", "9/8", "0/0", "1/0"])
def test_shards_that_there_are_not_are_refused(text):
    with pytest.raises(flockenv.ParameterError, match=re.escape(f"shard {text} is not accepted")):
        Shard.parse(text)


def test_a_workload_counts_runs_once_and_leaves_out_stored_ones(tmp_path):
    specs = [*SPECS[:6], SPECS[0]]
    store = RunStore(tmp_path)
    work = measure_workload(specs, store)
    assert (work.runs, work.stored) == (6, 0)
    assert work.flock_hours == pytest.approx(0.1)
    assert 0.0 < work.core_hours < 0.1
    assert not list(tmp_path.iterdir())
    store.save(SPECS[0], execute(SPECS[0]))
    work = measure_workload(specs, store)
    assert (work.runs, work.stored) == (6, 1)
    assert work.flock_hours == pytest.approx(5 / 60)


def test_each_policy_has_a_trial_of_its_middle_run(tmp_path, monkeypatch):
    # Trials are of at most a minute; here the clock of the processor is a made-up one.
    clock = iter([0.0, 1.0, 10.0, 14.0])
    monkeypatch.setattr("time.process_time", lambda: next(clock))
    specs = [
        RunSpec(parameters=NARROW, seed=0, duration_s=minutes * 60.0, policy=policy)
        for policy in ("damped law", "tuned law")
        for minutes in (5.0, 10.0, 15.0)
    ]
    work = measure_workload(specs, RunStore(tmp_path))
    assert work.core_hours * 3600 == pytest.approx(30 * 1.0 + 30 * 4.0)


def test_flocks_that_cannot_be_made_have_no_time(tmp_path):
    crowded = PARAMETERS.replace(n_boats=300, pool="narrow")
    work = measure_workload(
        [RunSpec(parameters=crowded, seed=0, duration_s=60.0)], RunStore(tmp_path)
    )
    assert work.core_hours is None
