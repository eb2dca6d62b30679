"""Law: a camera without faults gives back what was recorded, and a fault adds an error."""

import sys

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import read_tracks


def test_a_fine_camera_loses_nothing_but_velocities(script) -> None:
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=3, pool="wide")
    truth = flockenv.simulate(parameters, 0, 8.0, sample_hz=script.LAYOUT.fps)
    camera = script.Camera(pixel_cm=1e-6)
    tracks = read_tracks(script.seen(truth, camera, np.random.default_rng(0)), script.LAYOUT)
    expected, found = script.quantities(truth), script.quantities(tracks)
    for name in ("psi_o", "nematic", "largest_cluster"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-4)


def test_missing_detections_are_missing(script) -> None:
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=3, pool="wide")
    truth = flockenv.simulate(parameters, 0, 8.0, sample_hz=script.LAYOUT.fps)
    table = script.seen(truth, script.Camera(missing=0.1), np.random.default_rng(0))
    assert 1.0 - len(table) / truth.pose[..., 0].size == pytest.approx(0.1, abs=0.03)


def test_a_short_run(script, tmp_path, monkeypatch) -> None:
    out = tmp_path / "errors.csv"
    arguments = ["track_errors", "--runs", "1", "--minutes", "0.1", "--out", str(out)]
    monkeypatch.setattr(sys, "argv", arguments)
    script.main()
    found = pd.read_csv(out).set_index("camera")
    assert list(found.index) == [*script.CAMERAS]
    assert found.loc["and headings ± 3°", "psi_o"] > found.loc["pixels of 2.5 mm", "psi_o"]
