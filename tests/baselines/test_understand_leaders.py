"""Pictures of what leaders do: drawn, and their numbers those of the flock itself."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

import flockenv
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy


def test_it_draws(script, tmp_path: Path, capsys) -> None:
    arguments = ["--episodes", "2", "--minutes", "0.5", "--quiet", "--out", str(tmp_path)]
    script.main([*arguments, "--policy", "damped law", "--policy", "straight ahead"])
    for name in ("rudders", "places", "tracks"):
        with Image.open(tmp_path / f"{name}.png") as picture:
            assert picture.width > 800
    means = pd.read_csv(tmp_path / "means.csv", index_col="policy")
    for share in ("at_wall", "beside_wall", "beside_leader"):
        assert means[share].between(0.0, 1.0).all()
    assert (means["at_wall"] + means["beside_wall"]).max() > 0.0
    assert list(means.index) == ["damped law", "straight ahead"]
    assert means.loc["straight ahead", "rudder"] == 0.0


def test_the_names_of_phases_lie_on_no_color(script) -> None:
    parameters = flockenv.FlockParameters(bw_s=0.3)
    columns = ("cycle_s", "misalignment_rad", "spin_rad_s", "rudder")
    rows = pd.DataFrame(np.zeros((30, 4)), columns=columns)
    figure = script.draw_rudders({"a": rows, "b": rows}, parameters)
    figure.draw_without_rendering()
    for axes in figure.axes[:4]:
        names = [text.get_window_extent() for text in axes.texts]
        assert len(names) == 4
        assert all(axes.bbox.y1 <= name.y0 for name in names)
        assert all(name.y1 <= axes.title.get_window_extent().y0 for name in names)
        assert all(left.x1 < right.x0 for left, right in pairwise(names))


def test_files_of_one_name_are_distinguished(script, tmp_path: Path) -> None:
    size, files = len(observation_entries()), []
    for rudder in (0.5, -0.5):
        files.append(str(tmp_path / f"{rudder}" / "best.npz"))
        Path(files[-1]).parent.mkdir()
        NetworkPolicy([np.zeros((size, 1))], [[rudder]]).save(Path(files[-1]))
    arguments = ["--episodes", "1", "--minutes", "0.5", "--quiet", "--out", str(tmp_path)]
    script.main([*arguments, "--policy", files[0], "--policy", files[1]])
    means = pd.read_csv(tmp_path / "means.csv", index_col="policy")
    assert list(means.index) == files
    assert means.loc[files[0], "rudder"] == -means.loc[files[1], "rudder"] != 0.0


def test_samples_are_the_flocks_own(script) -> None:
    parameters = flockenv.FlockParameters(n_boats=8, n_leaders=3, pool="narrow", bw_s=0.4)
    env = flockenv.LeadersVectorEnv(1, params=parameters)
    observations, _ = env.reset(seed=3)
    actions = np.array([[0.5, -1.0, 0.0]], np.float32)
    for _ in range(37):
        observations, *_ = env.step(actions)
    flock = env._batch.flock(0)
    rows = script.samples(observations, actions, env.state(), parameters)
    place = flock.pose[:3, :2] @ [1, 1j]
    np.testing.assert_allclose(rows["radius_cm"], abs(place), atol=1e-3)
    apart = [min(abs(place[i] - place[j]) for j in range(3) if j != i) for i in range(3)]
    np.testing.assert_allclose(rows["apart_cm"], apart, atol=1e-3)
    np.testing.assert_allclose(rows["spin_rad_s"], flock.velocity[:3, 2], atol=1e-5)
    heading = np.exp(1j * flock.pose[:3, 2])
    np.testing.assert_allclose(
        rows["alignment"], (heading / (-1j * place / abs(place))).real, atol=1e-5
    )
    np.testing.assert_allclose(rows["cycle_s"], 3.7, atol=1e-5)
    np.testing.assert_allclose(rows["rudder"], [0.5, -1.0, 0.0])


def test_policies_without_observations_are_refused(script, tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="sees no observations"):
        script.main(["--policy", "steering law at every substep", "--out", str(tmp_path)])
