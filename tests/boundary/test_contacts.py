"""Law: contacts list who touches whom, with the forces that hold the hulls apart."""

import numpy as np
import pytest

import flockenv
from flockenv import Flock, FlockParameters


def test_none_before_the_first_substep(flock):
    contacts = flock.contacts()
    assert isinstance(contacts, flockenv.Contacts)
    assert len(contacts) == 0
    assert contacts.normal.shape == (0, 2)


def test_shapes_and_dtypes(flock):
    flock.advance(10.0)
    contacts = flock.contacts()
    c = len(contacts)
    assert c > 0
    assert contacts.i.shape == contacts.j.shape == contacts.gap_cm.shape == (c,)
    assert contacts.normal.shape == (c, 2)
    assert contacts.i.dtype == contacts.j.dtype == np.int64
    assert np.allclose(np.hypot(*contacts.normal.T), 1.0)
    assert (contacts.force >= 0).all()
    assert (contacts.i < 12).all()
    assert (contacts.j >= -2).all()


@pytest.mark.parametrize(
    ("pool", "x_cm", "heading", "wall"),
    [((1000.0, 0), 992.5, 0.0, -1), ("narrow", 56.0, np.pi, -2)],
)
def test_walls_are_negative_numbers(parameters, pool, x_cm, heading, wall):
    flock = Flock(parameters.replace(n_boats=1, n_leaders=0, c4=0.0, pool=pool), seed=1)
    flock.set_state([[x_cm, 0.0, heading]], np.zeros((1, 3)))
    flock.advance(1.0)
    contacts = flock.contacts()
    pushing = contacts.force > 0
    assert contacts.j[pushing].tolist() == [wall]
    point_cm = {-1: 1000.0, -2: 48.5}[wall]
    assert contacts.point_cm[pushing] == pytest.approx(np.array([[point_cm, 0.0]]), abs=1e-9)
    assert contacts.force[pushing] == pytest.approx([15.0], rel=1e-6)


def test_places_along_the_cores_give_the_points_back():
    jam = FlockParameters(n_boats=40, n_leaders=0, pool="narrow", bw_s=0.0)
    run = flockenv.simulate(jam, seed=3, duration_s=20.0, contacts=True)
    contacts = run.contacts
    assert len(contacts.i) > 500
    pose = run.pose[np.repeat(np.arange(len(run)), contacts.count), contacts.i]
    along = contacts.along_cm
    axis = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=1)
    points = pose[:, :2] + along[:, None] * axis - 5.0 * contacts.normal
    assert contacts.point_cm == pytest.approx(points, abs=1e-4)
    # Points lie on the hull's end discs and its sides, whose core reaches 2.5 cm either way.
    assert np.abs(along).max() == pytest.approx(2.5, abs=1e-4)
