"""A comparison runs every policy on the same seeds, through the environment a learner would use."""

import numpy as np
import pytest

import flockenv
from flockenv.comparison import NO_LEADERS, compare_leaders
from flockenv.comparison_report import report


@pytest.fixture(scope="module")
def scene() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(n_boats=9, pool="table-1")


def test_one_row_for_each_policy_number_and_seed(scene: flockenv.FlockParameters) -> None:
    seconds = []
    runs = compare_leaders(scene, [0, 1, 2], ["steering law"], [5, 6], 40.0, seconds.append)
    assert runs["leaders"].tolist() == [0, 0, 1, 1, 2, 2]
    assert runs["seed"].tolist() == [5, 6] * 3
    assert runs["policy"].unique().tolist() == [NO_LEADERS, "steering law"]
    assert runs["psi_o"].between(0, 1).all()
    assert (runs["signed_order"].abs() <= runs["psi_o"] + 1e-12).all()
    assert sum(seconds) == pytest.approx(6 * 40.0)


def test_results_belong_to_the_seed(scene: flockenv.FlockParameters) -> None:
    alone = compare_leaders(scene, [0, 1], ["steering law"], [6], 40.0)
    among = compare_leaders(scene, [0, 1], ["steering law"], [5, 6, 7], 40.0)
    among = among[among["seed"] == 6].reset_index(drop=True)
    assert alone.equals(among)


def test_runs_without_leaders_are_frames_of_the_recording(scene: flockenv.FlockParameters) -> None:
    runs = compare_leaders(scene, [0], [], [3], 60.0)
    env = flockenv.LeadersVectorEnv(1, params=scene.replace(n_leaders=1))
    _, infos = env.reset(seed=[3])
    recording = flockenv.simulate(scene, int(infos["flock_seed"][0]), 60.0)
    late = recording.in_analysis_window & (recording.time_s > 6.0)
    assert runs["psi_o"].item() == pytest.approx(recording.order.psi_o[late].mean(), abs=1e-6)
    towards = np.cos(recording.order.phi_o - np.pi / 2) * recording.order.psi_o
    assert runs["signed_order"].item() == pytest.approx(towards[late].mean(), abs=1e-6)


def test_the_report_writes_its_files(scene: flockenv.FlockParameters, tmp_path: object) -> None:
    folder = tmp_path / "new" / "folder"  # type: ignore[operator]
    result = report(scene, range(3), range(2), 40.0, folder, lambda seconds: None)
    assert {each.name for each in folder.iterdir()} == {
        "leader_curve.png",
        "lines.csv",
        "means.csv",
        "parameters.toml",
        "runs.csv",
    }
    stored = (folder / "parameters.toml").read_text("utf-8")
    assert flockenv.FlockParameters.from_toml(stored) == scene
    assert len(result.means) == 3
    assert (folder / "leader_curve.png").read_bytes().startswith(b"\x89PNG")
