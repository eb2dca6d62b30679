"""Law: what is packed comes back within half a quantum."""

import base64
import json
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from flockenv.replay.packing import Packer


def unpacked(text: str) -> dict[str, np.ndarray]:
    """Undo the packing as the page's script does, from the format's description."""
    content = zlib.decompress(base64.b64decode(text), wbits=31)
    end = 4 + int.from_bytes(content[:4], "little")
    columns, place = {}, end
    for header in json.loads(content[4:end]):
        shape = (header["channels"], header["length"])
        planes = np.frombuffer(content, np.uint8, header["planes"] * shape[0] * shape[1], place)
        place += len(planes)
        folded = np.zeros(shape[0] * shape[1], np.uint32)
        for plane in range(header["planes"]):
            part = planes[plane * len(folded) : (plane + 1) * len(folded)]
            folded |= part.astype(np.uint32) << np.uint32(8 * plane)
        whole = ((folded >> 1) ^ -(folded & 1)).astype(np.uint32).view(np.int32)
        values = whole.reshape(shape).astype(np.int64)
        for _ in range(header["differences"]):
            values = values.cumsum(axis=1)
        columns[header["name"]] = values.T * header["quantum"]
    assert place == len(content)
    return columns


numbers = st.floats(-1e12, 1e12, allow_nan=False)
series = arrays.arrays(
    np.float64, st.tuples(st.integers(1, 20), st.integers(1, 4)), elements=numbers
)


@given(series, st.sampled_from([1e-3, 0.5]))
def test_series(values, quantum):
    packer = Packer()
    packer.add("x", values, quantum)
    packer.add_plain("one", np.ones(3))
    found = unpacked(packer.text())
    coarse = max(quantum, np.abs(values).max() / 2**28)
    assert np.abs(found["x"] - values).max() <= 0.5000001 * coarse
    assert found["one"].ravel().tolist() == [1, 1, 1]


@given(arrays.arrays(np.int64, st.integers(0, 30), elements=st.integers(-(2**28), 2**28)))
def test_plain_numbers_are_exact(values):
    packer = Packer()
    packer.add_plain("x", values)
    assert unpacked(packer.text())["x"].ravel().tolist() == values.tolist()


@pytest.mark.parametrize("differences", [0, 1])
def test_smooth_series_take_less_than_their_quanta(differences):
    packer = Packer()
    values = np.sin(np.arange(10_000) / 100)
    packer.add("x", values, 1e-3)
    assert len(packer.text()) < 10_000 / 2
