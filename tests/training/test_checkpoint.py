"""Law: a checkpoint is restored whole, or refused by its name before anything changes."""

import io
import json
import math
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis
from hypothesis import strategies as st

from flockenv import ParameterError, training
from flockenv._io.array_file import read_arrays
from flockenv.training import TrainingSettings

Arrays = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def whole(tiny: TrainingSettings, tmp_path_factory: pytest.TempPathFactory) -> Arrays:
    folder = tmp_path_factory.mktemp("whole")
    training.train(tiny.replace(samples=384), folder)
    return read_arrays(folder / "checkpoint.npz")


def written(folder: Path, arrays: Arrays, header: Any = None) -> Path:
    if header is not None:
        arrays = {**arrays, "header": np.array(json.dumps(header))}
    blob = io.BytesIO()
    np.savez(blob, **arrays)
    path = folder / "checkpoint.npz"
    path.write_bytes(blob.getvalue())
    return path


def refused(folder: Path, words: str, arrays: Arrays, header: Any = None) -> None:
    """Such a checkpoint is refused in one line with its name, and nothing is written."""
    path = written(folder, arrays, header)
    before = path.read_bytes()
    with pytest.raises(ParameterError, match=words) as raised:
        training.resume(folder, samples=576)
    assert str(raised.value).startswith(str(path))
    assert "\n" not in str(raised.value)
    assert list(folder.iterdir()) == [path]
    assert path.read_bytes() == before


def reported(arrays: Arrays) -> dict[str, Any]:
    return json.loads(str(arrays["header"]))


def changed(name: str, value: Any) -> Callable[[dict[str, Any]], None]:
    """What sets an entry of a header, or takes it out; `a.b` is within `a`."""

    def change(header: dict[str, Any]) -> None:
        *parents, last = name.split(".")
        for parent in parents:
            header = header[parent]
        header[last] = value
        if value is ...:
            del header[last]

    return change


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("settings", ..., "no whole checkpoint: settings is missing"),
        ("settings", 3, "no whole checkpoint: settings = 3 is not accepted"),
        ("settings.foo", 3, "no whole checkpoint: 'foo' is no setting"),
        ("settings.observation", {"neighbors": "a"}, "no whole checkpoint: observation neighbors"),
        ("settings.net_arch", [16], "no whole checkpoint: .* has shape"),
        ("settings.num_flocks", 4, "no whole checkpoint: "),
        ("format", "flockenv policy 1", "no checkpoint in the format"),
        ("observation_version", "1", "no whole checkpoint: observation_version = '1'"),
        ("observation_version", 0, "version 0 of the observation"),
        ("updates", ..., "no whole checkpoint: updates = None"),
        ("updates", -1, "no whole checkpoint: updates = -1"),
        ("progress", ..., "no whole checkpoint: progress is missing"),
        ("progress.samples", "abc", "no whole checkpoint: samples = 'abc'"),
        ("progress.samples", True, "no whole checkpoint: samples = True"),
        ("progress.samples", 10**400, "no whole checkpoint: samples = 1000"),
        ("progress.wall_s", math.nan, "no whole checkpoint: wall_s = nan"),
        ("progress.wall_s", ..., "no whole checkpoint: progress has"),
        ("progress.command", None, "no whole checkpoint: command = None"),
        ("progress.best_score", "high", "no whole checkpoint: best_score = 'high'"),
        ("progress.best_score", None, "no whole checkpoint: best_score = None"),
        ("progress.validations", [], "no whole checkpoint: best_score = "),
        ("progress.validations", [{"samples": 1}], "no whole checkpoint: validations is not"),
        ("progress.curve", [3], "no whole checkpoint: curve is not accepted: rows of numbers"),
        ("progress.curve", {}, "no whole checkpoint: curve is not accepted"),
    ],
)
def test_headers_that_are_refused(
    whole: Arrays, tmp_path: Path, name: str, value: Any, words: str
) -> None:
    header = reported(whole)
    changed(name, value)(header)
    refused(tmp_path, words, whole, header)


@pytest.mark.parametrize(
    "text", ["[" * 100_000, "no JSON", "3", "[]", "null", '"flockenv checkpoint 1"', "{}"]
)
def test_texts_that_are_no_header(whole: Arrays, tmp_path: Path, text: str) -> None:
    refused(tmp_path, "is no checkpoint", {**whole, "header": np.array(text)})


BAD_ARRAYS = {
    "missing": lambda array: None,
    "another shape": lambda array: np.zeros((3, *array.shape), array.dtype),
    "another type": lambda array: np.zeros(array.shape, np.float16),
    "texts": lambda array: np.full(array.shape, "fw"),
    "not finite": lambda array: np.full(array.shape, np.nan, np.float64),
}


@pytest.mark.parametrize("bad", BAD_ARRAYS)
def test_arrays_that_are_refused(whole: Arrays, tmp_path: Path, bad: str) -> None:
    names = [name for name in whole if name != "header"]
    kinds = {name.partition(":")[0]: name for name in names}
    assert {"parameter", "optimizer", "environment", "episode_starts"} < kinds.keys()
    for kind, name in kinds.items():
        folder = tmp_path / kind
        folder.mkdir()
        array = BAD_ARRAYS[bad](whole[name])
        arrays = {**whole, name: array} if array is not None else dict(whole)
        if array is None:
            del arrays[name]
        refused(folder, "no whole checkpoint", arrays)


def test_a_weight_that_is_no_number_is_refused(whole: Arrays, tmp_path: Path) -> None:
    name = "parameter:action_net.weight"
    weights = np.full_like(whole[name], np.nan)
    refused(tmp_path, f"{name} holds numbers that are not finite", {**whole, name: weights})


@pytest.mark.parametrize("place", [-1.0, 625.0, 0.5, 1e12])
def test_places_beyond_the_random_numbers_are_refused(
    whole: Arrays, tmp_path: Path, place: float
) -> None:
    rest = np.array([place, *whole["numpy_rest"][1:]])
    refused(tmp_path, "no whole checkpoint: numpy_rest", {**whole, "numpy_rest": rest})


json_values = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(-3, 2**70), st.floats(), st.text(max_size=3)),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=4,
)


@hypothesis(max_examples=25, deadline=None)
@given(
    name=st.sampled_from(
        ["format", "observation_version", "settings", "progress", "updates", "settings.pools",
         "settings.observation", "settings.options", "settings.reward", "settings.noise",
         "settings.preset", "progress.samples", "progress.wall_s", "progress.best_score",
         "progress.curve", "progress.validations"]
    ),
    value=json_values,
)  # fmt: skip
def test_headers_with_any_entry(
    whole: Arrays, tmp_path_factory: pytest.TempPathFactory, name: str, value: Any
) -> None:
    header = reported(whole)
    changed(name, value)(header)
    path = written(tmp_path_factory.mktemp("run"), whole, header)
    # Where it continues, it lacks the policy that a whole run has beside its checkpoint.
    with suppress(ParameterError, FileNotFoundError):
        training.resume(path.parent, samples=576)
