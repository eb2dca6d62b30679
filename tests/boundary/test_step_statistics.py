"""Law: every run states whether it kept its tolerance, wherever its numbers go."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv import FlockParameters, Recording, StepStatistics
from flockenv.comparison import compare_leaders
from flockenv.comparison.report import overlap_notes
from flockenv.flock import STEP_STATISTICS
from flockenv.policies import DampedLaw
from flockenv.runs.sweep import summary

PARAMETERS = FlockParameters(n_boats=27, n_leaders=2, pool="narrow", bw_s=2.0, dt_s=0.1)


def of_flock(parameters: FlockParameters, seed: int, duration_s: float) -> dict[str, float]:
    flock = flockenv.Flock(parameters, seed)
    flock.advance(duration_s)
    return {name: getattr(flock.statistics, name) for name in STEP_STATISTICS}


@pytest.fixture(scope="module")
def run() -> Recording:
    return flockenv.simulate(PARAMETERS, seed=4, duration_s=20.0)


def test_a_recording_has_what_its_flock_counted(run):
    assert vars(run.statistics) == of_flock(PARAMETERS, 4, 20.0)
    assert 0.0 < run.statistics.worst_overlap_cm <= PARAMETERS.tolerance_cm
    assert run.statistics.unsolved == 0
    assert run.statistics.halved_substeps > 0


@pytest.mark.parametrize("law", [{}, {"policy": DampedLaw(3.0, 4.0, 35.0)}])
def test_a_change_of_parameters_keeps_what_was_counted(law):
    """The substeps after the change are too short to be halved or to overlap as much."""
    before = flockenv.simulate(PARAMETERS, 4, 20.0, **law).statistics
    change = (20.0, {"bw_s": 0.5, "dt_s": 1e-3})
    after = flockenv.simulate(PARAMETERS, 4, 20.5, schedule=[change], **law).statistics
    assert before.halved_substeps > 0
    assert after == before


def test_its_file_keeps_it_and_older_files_do_not_say(run, tmp_path):
    file = tmp_path / "run.npz"
    run.save(file)
    assert Recording.load(file).statistics == run.statistics
    with np.load(file) as stored:
        arrays = {name: stored[name] for name in stored if not name.startswith("statistics_")}
    np.savez(file, **arrays)
    assert Recording.load(file).statistics is None


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_a_count_that_no_run_has_is_refused_by_name(run, tmp_path, value):
    with pytest.raises(flockenv.ParameterError, match="worst_overlap_cm"):
        StepStatistics(worst_overlap_cm=value, unsolved=0, halved_substeps=0)
    file = tmp_path / "run.npz"
    run.save(file)
    with np.load(file) as stored:
        arrays = dict(stored)
    np.savez(file, **{**arrays, "statistics_worst_overlap_cm": np.array(value)})
    with pytest.raises(flockenv.ParameterError, match="worst_overlap_cm"):
        Recording.load(file)


def test_the_row_of_a_sweep_has_it(run):
    row = summary(run)
    assert {name: row[name] for name in STEP_STATISTICS} == vars(run.statistics)


def test_the_summary_of_an_episode_has_it():
    env = flockenv.LeadersVectorEnv(1, params=PARAMETERS, episode_s=5.0)
    env.reset(seed=3)
    ended = np.zeros(1, np.bool_)
    while not ended.all():
        _, _, _, ended, infos = env.step(np.zeros((1, 2)))
    found = {name: infos["episode_summary"][name][0] for name in STEP_STATISTICS}
    flock = flockenv.Flock.from_snapshot(env.snapshots()[0])
    assert found == {name: getattr(flock.statistics, name) for name in STEP_STATISTICS}
    assert 0.0 < found["worst_overlap_cm"] <= PARAMETERS.tolerance_cm


def test_the_rows_of_a_comparison_have_it():
    seeds = [1, 2]
    rows = compare_leaders(PARAMETERS, [0, 2], {"law": "paper's law"}, seeds, 5.0)
    assert (rows["worst_overlap_cm"] <= PARAMETERS.tolerance_cm).all()
    assert (rows["worst_overlap_cm"] > 0.0).all()
    assert (rows["unsolved"] == 0).all()
    assert overlap_notes(rows) == []


def test_overlaps_beyond_the_tolerance_are_said_in_one_line():
    rows = pd.DataFrame({"worst_overlap_cm": [0.031, 5e-5, 0.2], "unsolved": [3, 0, 1]})
    (line,) = overlap_notes(rows)
    assert line == "2 of 3 episodes left overlaps deeper than tolerance_cm; the deepest is 0.2 cm"
