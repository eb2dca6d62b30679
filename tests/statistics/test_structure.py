"""Law: structure measures of recorded boats are the core's; shapes are checked."""

from functools import partial

import numpy as np
import pytest

import flockenv
from flockenv.statistics import structure

PARAMETERS = flockenv.FlockParameters.preset("experiment").replace(n_boats=3)
# Two boats in touch side by side, one apart at the wall (outer radius 90 cm).
POSE = np.array([[[60.0, 0.0, 0.0], [60.0, 10.2, 0.0], [-82.4, 0.0, np.pi]]] * 4)


def test_jams_are_boats_in_touch_that_face_outward():
    around = np.arange(8) * 10.3 / 80.0
    jam = np.stack([80 * np.cos(around), 80 * np.sin(around), around], axis=1)
    parted, none = jam.copy(), jam.copy()
    parted[3, 2] += np.pi / 2
    none[:, 2] += np.pi
    parameters = PARAMETERS.replace(n_boats=8)
    found = structure.jam_sizes(parameters, np.array([jam, parted, none]))
    assert [sizes.tolist() for sizes in found] == [[8], [3, 4], []]


def test_polarization_is_the_length_of_the_mean_heading():
    # Two boats head along x and one against it.
    polarization = partial(structure.structure_series, "polarization", PARAMETERS)
    assert polarization(POSE) == pytest.approx([1 / 3] * 4)
    absent = POSE.copy()
    absent[1, 2], absent[2] = np.nan, np.nan
    assert polarization(absent) == pytest.approx([1 / 3, 1, np.nan, 1 / 3], nan_ok=True)


@pytest.mark.parametrize("pose", [np.zeros((3, 3)), np.zeros((2, 3, 2)), np.zeros((2, 0, 3))])
def test_other_shapes_are_refused(pose):
    with pytest.raises(flockenv.ParameterError, match="pose"):
        structure.structure_series("on_outer_wall", PARAMETERS, pose)


def test_other_arguments_are_refused():
    for name in ("psi_o", "signed_order", "clusters"):
        with pytest.raises(flockenv.ParameterError, match=name):
            structure.structure_series(name, PARAMETERS, POSE)


def test_states_and_ordering_times_of_a_recording():
    run = flockenv.simulate(PARAMETERS.replace(n_boats=12, n_leaders=2, bw_s=1.0), 3, 240.0)
    states = run.order.states(15.0)
    assert states.shape == run.time_s.shape
    ordered = np.char.startswith(states, "ordered")
    assert (run.order.psi_o[ordered] > 0.8).all()
    assert (run.order.series("off_tangent")[ordered] < np.pi / 4).all()
    clusters = structure.structure_series("largest_cluster", run.parameters, run.pose)
    clustering = run.order.states(15.0, clusters) == "clustering"
    assert (states[clustering] == "disordered").all()
    printed = run.order.ordering_time(run.time_s)
    wider = run.order.ordering_time(run.time_s, np.pi / 4)
    assert np.isnan(printed) or wider <= printed
    with pytest.raises(flockenv.ParameterError, match="time_s"):
        run.order.ordering_time(run.time_s[1:])
    with pytest.raises(flockenv.ParameterError, match="largest_cluster"):
        run.order.states(15.0, clusters[1:])
