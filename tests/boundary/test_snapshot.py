"""Law: a snapshot continues bit for bit, and bytes that are none change nothing."""

import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import flockenv
from flockenv import Flock, FlockParameters, ParameterError

PARAMETERS = FlockParameters(n_boats=12, n_leaders=2, pool="narrow")


def moving(parameters=PARAMETERS):
    flock = Flock(parameters, seed=7)
    flock.advance(3.0, rudder=[0.3] * parameters.n_leaders)
    return flock


SNAPSHOT = moving().snapshot()


def test_a_snapshot_brings_seed_and_target_along():
    flock = moving()
    flock.set_target("ccw")
    other = Flock(PARAMETERS, seed=1)
    other.restore(flock.snapshot())
    assert (other.seed, other.parameters.target) == (7, "ccw")


FLIPPED = [SNAPSHOT[:at] + bytes([SNAPSHOT[at] ^ 4]) + SNAPSHOT[at + 1 :] for at in (0, 9, 200)]


@pytest.mark.parametrize(
    "blob",
    [b"", b"PK\x03\x04" * 100, SNAPSHOT[::-1], SNAPSHOT[:-1], SNAPSHOT + b"\0", *FLIPPED],
    ids=range(8),
)
def test_bytes_that_are_no_whole_snapshot_are_refused(blob):
    """Both ways in refuse the bytes, and the flock is as it was."""
    flock = moving()
    for restore in (flock.restore, Flock.from_snapshot):
        with pytest.raises(ParameterError, match="snapshot"):
            restore(blob)
    assert flock.snapshot() == SNAPSHOT


def test_a_snapshot_of_other_parameters_is_refused():
    other = moving(PARAMETERS.replace(c3=0.9))
    flock = moving()
    with pytest.raises(ParameterError, match="other parameters"):
        flock.restore(other.snapshot())
    assert flock.snapshot() == SNAPSHOT


def checksum(body: bytes) -> bytes:
    return zlib.crc32(body).to_bytes(8, "little")


@given(st.data())
def test_a_forged_checksum_gives_a_sound_flock_or_a_named_error(data):
    body = bytearray(SNAPSHOT[16:])
    for _ in range(data.draw(st.integers(1, 3))):
        body[data.draw(st.integers(0, len(body) - 1))] = data.draw(st.integers(0, 255))
    try:
        flock = Flock.from_snapshot(SNAPSHOT[:8] + checksum(body) + bytes(body))
        flock.advance(0.1)
    except flockenv.FlockError:
        return
    assert np.isfinite(flock.pose).all()
