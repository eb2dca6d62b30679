"""Law: a quantity of the table is in recordings, sweep tables, commands and the replay page."""

import json

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters
from flockenv.order import QUANTITIES
from flockenv.replay.quantities import shown_quantities
from flockenv.runs.spec import RunSpec, execute
from flockenv.runs.sweep import summary

TABLE = QUANTITIES
RECORDED = [each.name for each in TABLE if each.kind == "recorded"]
AVERAGED = [each.name for each in TABLE if each.is_averaged]
PARAMETERS = FlockParameters(n_boats=5, n_leaders=1, pool="narrow")


@pytest.fixture(scope="module")
def run():
    return flockenv.simulate(PARAMETERS, seed=3, duration_s=20.0)


def test_tables_of_sweeps_have_every_averaged_quantity():
    result = execute(RunSpec(parameters=PARAMETERS, seed=3, duration_s=20.0))
    row = summary(result)
    assert {f"{name}_mean" for name in AVERAGED} <= row.keys()
    assert row["nematic_mean"] == pytest.approx(result.analyzed().order.nematic.mean(), abs=1e-6)


def test_the_command_line_and_the_replay_page_show_the_table(cli, run, tmp_path):
    options = ["--set", "n_boats=5", "--set", "n_leaders=1", "--minutes", "0.3", "--json"]
    done = cli.succeeds("run", *options, "--out", tmp_path / "run.npz")
    shown = json.loads(done.stdout)
    assert {"nematic_mean", "milling_mean", "psi_v_mean", "signed_order_mean"} <= shown.keys()
    keys = [each["key"] for each in shown_quantities([run])]
    assert keys == ["signed_order", "rotation", *RECORDED]


def test_plain_arrays_have_the_quantities_of_their_recording(run):
    normal = slice(run.parameters.n_leaders, None)
    found = flockenv.order_series(run.pose[:, normal].tolist(), run.velocity[:, normal])
    for name in RECORDED:
        assert (getattr(found, name) == getattr(run.order, name)).all()
    gone = run.pose[:, normal].copy()
    gone[2] = np.nan
    assert np.flatnonzero(np.isnan(flockenv.order_series(gone, run.velocity[:, normal]).psi_o)) == [
        2
    ]


@pytest.mark.parametrize(
    ("pose", "velocity", "words"),
    [
        (np.zeros((2, 3)), np.zeros((2, 1, 3)), "pose has shape"),
        (np.zeros((2, 1, 3)), np.zeros((2, 2, 3)), "velocity has shape"),
        (np.zeros((2, 1, 2)), np.zeros((2, 1, 2)), "pose has shape"),
        (np.zeros((2, 0, 3)), np.zeros((2, 0, 3)), "at least one boat"),
        ("here", np.zeros((2, 1, 3)), "numbers"),
    ],
)
def test_plain_arrays_of_other_shapes_are_refused(pose, velocity, words):
    with pytest.raises(flockenv.ParameterError, match=words):
        flockenv.order_series(pose, velocity)
