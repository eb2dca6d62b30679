"""`flockenv run` and `flockenv replay`: they write the given run, completely."""

import json
import shlex
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image, ImageSequence

import flockenv
from flockenv.cli.replay import ReplayOptions
from flockenv.rendering import frame

SMALL = ["--set", "n_boats=8", "--set", "n_leaders=2", "--set", "pool=narrow", "--minutes", "0.2"]
PARAMETERS = flockenv.FlockParameters(n_boats=8, n_leaders=2, pool="narrow")


@pytest.fixture(scope="module")
def run(cli, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("runs") / "law;.npz"
    done = cli.succeeds("run", *SMALL, "--seed", "7", "--out", out)
    assert shlex.join(["flockenv", "replay", str(out)]) in done.stdout.splitlines()[-1]
    return out


def test_the_recording_is_what_simulate_returns(run):
    assert flockenv.Recording.load(run) == flockenv.simulate(PARAMETERS, 7, 12.0, contacts=True)


def test_the_parameters_beside_it_run_it_again(cli, run, tmp_path):
    again = tmp_path / "again.npz"
    toml = run.with_suffix(".toml")
    cli.succeeds("run", "--params", toml, "--minutes", "0.2", "--seed", "7", "--out", again)
    assert flockenv.Recording.load(again) == flockenv.Recording.load(run)
    assert "seed 7, policy paper's law at every substep" in toml.read_text()


def test_what_changes_on_the_way_is_the_schedule_of_simulate(cli, tmp_path):
    out = tmp_path / "changed.npz"
    changes = ["--at", "3:bw_s=0.8", "--at", "3:c4=0.2", "--at", "7.5:target=ccw"]
    cli.succeeds("run", *SMALL, *changes, "--out", out, "-q")
    schedule = [(3.0, {"bw_s": 0.8, "c4": 0.2}), (7.5, {"target": "ccw"})]
    expected = flockenv.simulate(PARAMETERS, 0, 12.0, schedule=schedule, contacts=True)
    assert flockenv.Recording.load(out) == expected
    assert not np.array_equal(expected.pose, flockenv.simulate(PARAMETERS, 0, 12.0).pose)


@pytest.mark.parametrize("change", ["5", "soon:bw_s=1", "5:bw_s", "5:", ":bw_s=1"])
def test_a_change_on_the_way_of_another_form_is_refused(cli, tmp_path, change):
    refused = cli("run", *SMALL, "--at", change, "--out", tmp_path / "run.npz", "-q")
    assert refused.returncode == 2
    assert f"--at '{change}' is not accepted: TIME:FIELD=VALUE" in refused.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--at", "5:bw_s=abc"], "--at '5:bw_s=abc' is not accepted: bw_s must be a number"),
        (["--pool", ""], 'pool = "" is not accepted'),
    ],
)
def test_values_of_the_wrong_type_are_named(cli, tmp_path, options, words):
    refused = cli("run", "--n-boats", "8", *options, "--out", tmp_path / "run.npz", "-q")
    assert refused.returncode == 2
    assert words in refused.stderr
    assert "Traceback" not in refused.stderr


def test_json_is_all_that_is_printed(cli, tmp_path):
    out = tmp_path / "run.npz"
    policy = ["--policy", "damped law", "--no-contacts", "--hz", "5"]
    done = cli("run", *SMALL, *policy, "--json", "--out", out)
    assert done.stderr == ""
    summary = json.loads(done.stdout)
    recording = flockenv.Recording.load(out)
    assert recording.contacts is None
    assert summary["frames"] == len(recording.analyzed())
    late = recording.in_analysis_window & (recording.time_s > 1.2)
    assert summary["psi_o_mean"] == recording.order.psi_o[late].mean()
    assert summary["recording"] == str(out)


def test_what_is_there_is_overwritten_only_if_that_is_asked_for(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for names in (["run"], ["run", "run-2"]):
        cli.succeeds("run", *SMALL, "-q")
        assert sorted(each.stem for each in Path("results").glob("*.npz")) == names
    refused = cli("run", *SMALL, "--seed", "1", "--out", "results/run.npz", "-q")
    assert "results/run.npz already exists: --force overwrites it" in refused.stderr
    assert flockenv.Recording.load("results/run.npz").seed == 0
    cli.succeeds("run", *SMALL, "--seed", "1", "--out", "results/run.npz", "--force", "-q")
    assert flockenv.Recording.load("results/run.npz").seed == 1


@pytest.mark.parametrize("force", [[], ["--force"]])
def test_a_toml_file_that_no_run_wrote_is_never_overwritten(cli, tmp_path, monkeypatch, force):
    monkeypatch.chdir(tmp_path)
    for text in ("n_boats = 3\n", "# flockenv sweep mine.toml\nminutes = 1\n", ""):
        Path("mine.toml").write_text(text)
        refused = cli("run", *SMALL, "--out", "mine.npz", "-q", *force)
        assert refused.returncode == 2
        assert "mine.toml already exists, and no run wrote it" in refused.stderr
        assert Path("mine.toml").read_text() == text
        assert not Path("mine.npz").exists()


def test_replay_writes_a_page_beside_the_recording(cli, run, tmp_path):
    done = cli("replay", run, "--json")
    assert done.stderr == ""
    written = json.loads(done.stdout)
    page = run.with_suffix(".html")
    assert written == {"html": str(page), "bytes": page.stat().st_size, "every": 1}
    pair = tmp_path / "sub" / "pair.html"
    done = cli.succeeds("replay", run, run, "--html", pair)
    assert "<title>law; (1) and law; (2) – flockenv replay</title>" in pair.read_text()


def test_replay_draws_a_moving_picture(cli, run, tmp_path):
    """12 s at 8 times real time last 1.5 s: 19 frames of a GIF, and 38 of a video."""
    files = [tmp_path / "run.gif", tmp_path / "run.mp4"]
    done = cli("replay", run, "--gif", files[0], "--mp4", files[1], "--json")
    assert done.stderr == ""
    assert json.loads(done.stdout) == {"files": list(map(str, files))}
    with Image.open(files[0]) as picture:
        lasting = sum(each.info["duration"] for each in ImageSequence.Iterator(picture))
    assert lasting == pytest.approx(1520, abs=20)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(files[1]))
    assert (frames, seconds) == (38, pytest.approx(1.52, abs=0.05))


def test_replay_draws_two_side_by_side(cli, run, tmp_path):
    shorter, both = tmp_path / "shorter.npz", tmp_path / "both.gif"
    cli.succeeds("run", *SMALL[:-1], "0.1", "--seed", "4", "--out", shorter)
    draw = ("replay", run, shorter, "--gif", both, "--speed", "16")
    for colors in ("direction", "role"):
        cli.succeeds(*draw, "--name", "long", "--name", "short", "--colors", colors)
        with Image.open(both) as picture:
            frames = [np.array(each.convert("RGB")) for each in ImageSequence.Iterator(picture)]
        assert {each.shape for each in frames} == {(600, 1200, 3)}
        recordings = [flockenv.Recording.load(path) for path in (run, shorter)]
        for recording, caption, half in zip(recordings, ("long", "short"), (0, 600), strict=True):
            for number in (0, len(frames) - 1):
                # The shorter one rests at its end.
                time_s = min(number * 16 / 12.5, float(recording.time_s[-1]))
                expected = frame(recording, time_s, colors=colors, caption=caption)
                found = frames[number][:, half : half + 600].astype(int)
                # A GIF has 256 colors.
                assert np.abs(found - expected).mean() < 2.0
    assert cli(*draw, "--colors", "red").returncode == 2


@pytest.mark.parametrize(("start", "frames", "first_s"), [("4", 12, 4.0), ("99", 1, 12.0)])
def test_a_moving_picture_starts_later(cli, run, tmp_path, start, frames, first_s):
    """The 8 s that are left last 1 s at 8 times real time; of nothing there is the last frame."""
    cli.succeeds("replay", run, "--gif", tmp_path / "late.gif", "--start", start)
    with Image.open(tmp_path / "late.gif") as picture:
        assert picture.n_frames == frames
        found = np.array(picture.convert("RGB")).astype(int)
    expected = frame(flockenv.Recording.load(run), first_s)
    assert np.abs(found - expected).mean() < 2.0


def test_a_moving_picture_lasts_as_long_as_the_samples(cli, run, tmp_path):
    """A run that starts at 12 s and lasts 8 s takes 1 s at 8 times real time."""
    start = flockenv.Recording.load(run)
    flockenv.simulate(PARAMETERS, 7, 8.0, start=start).save(tmp_path / "later.npz")
    cli.succeeds("replay", tmp_path / "later.npz", "--gif", tmp_path / "later.gif")
    with Image.open(tmp_path / "later.gif") as picture:
        lasting = sum(each.info["duration"] for each in ImageSequence.Iterator(picture))
    assert lasting == pytest.approx(1000, abs=50)


def test_a_recording_without_samples_has_no_picture(cli, tmp_path):
    empty = tmp_path / "empty.npz"
    flockenv.simulate(PARAMETERS, 7, 0.5).analyzed().save(empty)
    refused = cli("replay", empty, "--gif", tmp_path / "empty.gif")
    assert refused.returncode == 2
    assert "recording 'empty' is not accepted: samples with their poses" in refused.stderr
    done = cli.succeeds("analyze", empty, "--plot", tmp_path / "empty.png")
    assert "phases are unknown" not in done.stdout


def test_names_that_print_alike_are_numbered():
    paths = [Path("a\udcfe.npz"), Path("a\udcff.npz")]
    named = ReplayOptions(first=paths[0], second=paths[1]).named()
    assert named == {"a\ufffd (1)": paths[0], "a\ufffd (2)": paths[1]}


def test_models_of_stable_baselines3_steer_and_are_compared_with_trust(cli, tmp_path):
    stable_baselines3 = pytest.importorskip("stable_baselines3")
    from flockenv.sb3 import LeaderVecEnv

    model, out = tmp_path / "model.zip", tmp_path / "run.npz"
    venv = LeaderVecEnv(1, params=PARAMETERS)
    stable_baselines3.PPO("MlpPolicy", venv, device="cpu", seed=1).save(model)
    steer = ["run", *SMALL, "--seed", "3", "--no-contacts", "--out", out]
    short = ["--pool", "narrow", "--episodes", "2", "--minutes", "0.1", "--set", "n_boats=6"]
    for words in (steer, ["compare", "--n-leaders", "1", *short, "--out", tmp_path / "out"]):
        refused = cli(*words, "--policy", model)
        assert (refused.returncode, "--trust" in refused.stderr) == (2, True)
        assert not out.exists()
        cli.succeeds(*words, "--policy", model, "--trust")
        out.rename(tmp_path / "steered.npz") if out.exists() else None
    policy = flockenv.policies.load(model, trust=True)
    steered = flockenv.simulate(PARAMETERS, 3, 12.0, policy=policy)
    assert flockenv.Recording.load(tmp_path / "steered.npz") == steered
    assert "sha256" in (tmp_path / "out" / "card.md").read_text()


def test_a_run_without_leaders_names_no_target(cli, tmp_path):
    for leaders in (0, 1):
        options = ["--set", f"n_leaders={leaders}", "--set", "n_boats=4", "--minutes", "0.2"]
        done = cli.succeeds("run", *options, "--out", tmp_path / f"{leaders}.npz")
        assert ("signed order" in done.stdout) == (leaders == 1)
        assert "rotation" in done.stdout
