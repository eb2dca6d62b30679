"""Law: discs and walls are fields like others: checked once, and stored wherever parameters are."""

from dataclasses import fields

import numpy as np
import pytest

from flockenv import Flock, FlockError, FlockParameters, ParameterError, Recording, simulate
from flockenv.runs.sweep import read_sweep

DISCS = ((30.0, 0.0, 8.0), (-30.0, 10.0, 3.5))
WALLS = ((-60.0, 40.0, 0.0, 40.0),)


@pytest.fixture
def arena():
    return FlockParameters(n_boats=9, n_leaders=2, pool=(90.0, 0.0), discs=DISCS, walls=WALLS)


def test_any_rows_of_numbers_are_taken_and_stored_as_tuples(arena):
    for discs, walls in (
        ([list(each) for each in DISCS], [list(each) for each in WALLS]),
        (np.array(DISCS), np.array(WALLS)),
        (np.array(DISCS, np.float32), [np.array(WALLS[0], int)]),
    ):
        assert arena.replace(discs=discs, walls=walls) == arena
    assert arena.discs == DISCS
    assert type(arena.walls[0][0]) is float
    assert arena.replace(discs=np.zeros((0, 3)), walls=[]).discs == ()
    assert len({arena, arena.replace(), arena.replace(walls=())}) == 2


def test_snapshots_and_recordings_hold_them(arena, tmp_path):
    flock = Flock(arena, seed=3)
    flock.advance(2.0)
    other = Flock.from_snapshot(flock.snapshot())
    assert other.parameters == arena
    flock.advance(2.0)
    other.advance(2.0)
    assert flock.snapshot() == other.snapshot()
    run = simulate(arena, 3, 40.0, contacts=True)
    assert run.contacts.j.min() <= -3
    run.save(tmp_path / "run.npz")
    loaded = Recording.load(tmp_path / "run.npz")
    assert loaded == run
    assert loaded.parameters == arena


def test_recorded_contacts_of_other_obstacles_are_refused(arena):
    run = simulate(arena, 3, 40.0, contacts=True)
    values = {each.name: getattr(run, each.name) for each in fields(run)}
    with pytest.raises(ParameterError, match="contacts"):
        Recording(**(values | {"parameters": arena.replace(discs=(), walls=())}))


def test_sweeps_vary_them(tmp_path):
    (tmp_path / "sweep.toml").write_text(
        "minutes = 1\nseeds = 2\n[fixed]\npool = [90, 0]\nn_boats = 5\n"
        "[[grid]]\ndiscs = [[], [[30, 0, 8]], [[30, 0, 8], [-30, 0, 8]]]\n"
    )
    sweep = read_sweep(tmp_path / "sweep.toml")
    assert [len(run.parameters.discs) for run in sweep.runs] == [0, 0, 1, 1, 2, 2]


BAD = {
    "negative radius": {"discs": [(30, 0, -1)]},
    "no radius": {"discs": [(30, 0, 0)]},
    "NaN": {"discs": [(np.nan, 0, 3)]},
    "infinite": {"walls": [(0, 0, np.inf, 3)]},
    "outside": {"discs": [(120, 0, 20)]},
    "outside, a wall": {"walls": [(100, -50, 100, 50)]},
    "a point": {"walls": [(10, 10, 10, 10)]},
    "too many": {"discs": [(0, 0, 1)] * 1001},
    "too many, a view": {"walls": np.broadcast_to(1.0, (10**12, 4))},
    "wrong columns": {"discs": [(1, 2)]},
    "ragged": {"walls": [(1, 2, 3, 4), (1,)]},
}


@pytest.mark.parametrize("changes", BAD.values(), ids=BAD)
def test_bad_obstacles_are_refused_by_name(arena, changes):
    with pytest.raises(ParameterError, match=next(iter(changes))):
        arena.replace(**changes)


@pytest.mark.parametrize(
    ("name", "flat", "columns"),
    [
        ("discs", (30, 0, 8), "x_cm, y_cm, radius_cm"),
        ("walls", [-9, 0, 9, 0], "x0_cm, y0_cm, x1_cm, y1_cm"),
        ("walls", np.arange(4.0), "x0_cm, y0_cm, x1_cm, y1_cm"),
    ],
)
def test_one_row_that_is_in_no_list_is_refused_with_what_rows_have(arena, name, flat, columns):
    with pytest.raises(
        ParameterError, match=rf"{name} = .* is not accepted: rows of \({columns}\)"
    ):
        arena.replace(**{name: flat})


@pytest.mark.parametrize("value", [None, 3.0, "(1, 2, 3)", {}, {(1, 2, 3)}, True])
@pytest.mark.parametrize("name", ["discs", "walls"])
def test_what_are_no_rows_is_a_type_error(arena, name, value):
    with pytest.raises(TypeError, match=name):
        arena.replace(**{name: value})


def test_rows_may_be_gone_through_once(arena):
    rows = [(30.0, 0.0, 8.0), (-30.0, 0.0, 8.0)]
    for discs in (iter(rows), (map(float, row) for row in rows), dict(enumerate(rows)).values()):
        assert arena.replace(discs=discs).discs == tuple(rows)


def test_no_room_is_an_error_before_anything_changes(arena):
    with pytest.raises(FlockError, match=r"do not fit the pool.*fewer obstacles"):
        Flock(arena.replace(discs=[(0, 0, 85)], walls=()), seed=1)
    flock = Flock(arena, seed=1)
    before = flock.snapshot()
    with pytest.raises(FlockError, match="boat 0 and disc 0 overlap"):
        flock.set_state([[30.0, 0.0, 0.0]] * 9, np.zeros((9, 3)))
    assert flock.snapshot() == before
