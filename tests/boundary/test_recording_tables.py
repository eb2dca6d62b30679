"""Law: a recording's tables hold its numbers, in the libraries that the user has."""

import copy
import pickle

import numpy as np
import pytest

import flockenv
from flockenv.order import RECORDED

PARAMETERS = flockenv.FlockParameters(n_boats=5, n_leaders=2, pool="narrow")
ORDER = ["psi_o", "phi_o", "c_o", "psi_v", "phi_v", "c_v"]


@pytest.fixture(scope="module")
def run() -> flockenv.Recording:
    return flockenv.simulate(PARAMETERS, 3, 2.0)


def test_a_row_per_sample(run):
    table = run.to_dataframe()
    assert len(table) == 21
    assert table.columns[:3].tolist() == ["time_s", "phase", "in_analysis_window"]
    assert set(ORDER) <= set(table.columns)
    assert np.array_equal(table["time_s"], run.time_s)
    assert np.array_equal(table["psi_v"], run.order.psi_v)
    assert table["phase"].tolist() == run.phase.tolist()


def test_a_row_per_sample_and_boat(run):
    table = run.to_dataframe(boats=True)
    assert len(table) == 21 * 5
    row = table.iloc[7 * 5 + 3]
    assert (row["time_s"], row["boat"], row["is_leader"]) == (0.7, 3, False)
    pose = row[["x_cm", "y_cm", "heading_rad"]].to_numpy(float)
    assert np.array_equal(pose, run.pose[7, 3])
    names = ["velocity_x_cm_s", "velocity_y_cm_s", "angular_velocity_rad_s"]
    assert np.array_equal(row[names].to_numpy(float), run.velocity[7, 3])
    assert table.groupby("boat")["is_leader"].first().tolist() == [True, True, False, False, False]


def test_a_dataset_by_time_and_boat(run):
    data = run.to_xarray()
    assert dict(data.sizes) == {"time_s": 21, "boat": 5}
    assert np.array_equal(data["heading_rad"].sel(boat=4), run.pose[:, 4, 2])
    assert np.array_equal(data["phi_o"], run.order.phi_o)
    assert data["is_leader"].to_numpy().tolist() == [True, True, False, False, False]
    assert flockenv.FlockParameters.from_toml(data.attrs["parameters"]) == PARAMETERS
    assert (data.attrs["seed"], data.attrs["version"]) == (3, run.version)


def test_order_is_drawn_against_time(run):
    figure = pytest.importorskip("matplotlib.figure").Figure()
    axes = figure.subplots()
    assert run.order.plot("psi_v", "signed_order", target="ccw", ax=axes) is axes
    velocity, signed = axes.lines
    assert np.array_equal(velocity.get_xdata(), run.time_s)
    assert np.array_equal(velocity.get_ydata(), run.order.psi_v)
    assert np.array_equal(signed.get_ydata(), run.order.signed_order("ccw"))
    assert [velocity.get_label(), signed.get_label()] == [
        "velocity Ψ_v [cm/s]",
        "signed order",
    ]
    assert axes.get_xlabel() == "time [s]"


def test_what_is_drawn_without_names_has_no_unit(run):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    axes = copy.deepcopy(run).order.plot()
    assert [line.get_label() for line in axes.lines] == [
        "order Ψ_o",
        "nematic order Ψ_n",
        "milling M",
    ]
    assert np.array_equal(axes.lines[0].get_xdata(), run.time_s)
    pyplot.close(axes.figure)


def test_a_quantity_that_is_none_is_not_drawn(run):
    for name in ("psi", "largest_cluster"):
        with pytest.raises(flockenv.ParameterError, match=f"quantity = '{name}' is not .*psi_o"):
            run.order.plot(name)
    with pytest.raises(flockenv.ParameterError, match="target"):
        run.order.plot(target="up")


def test_order_is_equal_to_the_same_series_without_times(run):
    plain = flockenv.OrderSeries(*(getattr(run.order, each.name) for each in RECORDED))
    assert run.order == plain == pickle.loads(pickle.dumps(run.order))
    assert np.array_equal(pickle.loads(pickle.dumps(run.order)).time_s, run.time_s)


@pytest.mark.parametrize("name", ["m.csv", "m.parquet", "m", "m.npz.gz"])
def test_a_recording_is_saved_as_npz_alone(run, tmp_path, name):
    with pytest.raises(flockenv.ParameterError, match=r"ends in \.npz; to_dataframe"):
        run.save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []
