"""`flockenv run` and `flockenv replay`: they write the given run, completely."""

import json
import sys
from pathlib import Path

import imageio_ffmpeg
import pytest
from PIL import Image, ImageSequence

import flockenv

SMALL = ["--set", "n_boats=8", "--set", "n_leaders=2", "--set", "pool=narrow", "--minutes", "0.2"]


@pytest.fixture(scope="module")
def run(cli, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("runs") / "law.npz"
    done = cli("run", *SMALL, "--seed", "7", "--out", out)
    assert done.returncode == 0, done.stderr
    assert f"flockenv replay {out}" in done.stdout.replace("\n", "")
    return out


def test_the_recording_is_what_simulate_returns(run):
    parameters = flockenv.FlockParameters(n_boats=8, n_leaders=2, pool="narrow")
    assert flockenv.Recording.load(run) == flockenv.simulate(parameters, 7, 12.0, contacts=True)


def test_the_parameters_beside_it_run_it_again(cli, run, tmp_path):
    again = tmp_path / "again.npz"
    toml = run.with_suffix(".toml")
    done = cli("run", "--params", toml, "--minutes", "0.2", "--seed", "7", "--out", again)
    assert done.returncode == 0, done.stderr
    assert flockenv.Recording.load(again) == flockenv.Recording.load(run)
    assert "seed 7, policy paper's law at every substep" in toml.read_text()


def test_json_is_all_that_is_printed(cli, tmp_path):
    out = tmp_path / "run.npz"
    policy = ["--policy", "damped law", "--no-contacts", "--hz", "5"]
    done = cli("run", *SMALL, *policy, "--json", "--out", out)
    assert done.stderr == ""
    summary = json.loads(done.stdout)
    recording = flockenv.Recording.load(out)
    assert recording.contacts is None
    assert summary["samples"] == len(recording) == 61
    late = recording.in_analysis_window & (recording.time_s > 1.2)
    assert summary["psi_o"] == recording.order.psi_o[late].mean()
    assert summary["recording"] == str(out)


def test_what_is_there_is_overwritten_only_if_that_is_asked_for(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for names in (["run"], ["run", "run-2"]):
        assert cli("run", *SMALL, "-q").returncode == 0
        assert sorted(each.stem for each in Path("results").glob("*.npz")) == names
    before = Path("results/run.npz").read_bytes()
    refused = cli("run", *SMALL, "--seed", "1", "--out", "results/run.npz", "-q")
    assert refused.returncode == 2
    assert "results/run.npz is there already: --force overwrites it" in refused.stderr
    assert Path("results/run.npz").read_bytes() == before
    forced = cli("run", *SMALL, "--seed", "1", "--out", "results/run.npz", "--force", "-q")
    assert forced.returncode == 0, forced.stderr
    assert flockenv.Recording.load("results/run.npz").seed == 1
    Path("mine.toml").write_text("n_boats = 3\n")
    refused = cli("run", "--params", "mine.toml", "--out", "mine.npz", "-q")
    assert "--params mine.toml is where results would be written" in refused.stderr
    assert not Path("mine.npz").exists()


@pytest.mark.parametrize("out", [[], ["--out", "results/run.npz"]])
def test_commands_at_once_lose_no_recording(cli, tmp_path, monkeypatch, out):
    monkeypatch.chdir(tmp_path)
    simulate, seeds = sys.modules["flockenv.cli.run"].simulate, iter((1, 2))

    def meanwhile(*arguments, **options):
        for seed in seeds:
            assert cli("run", *SMALL, *out, "--seed", str(seed), "-q").returncode == 0
        return simulate(*arguments, **options)

    monkeypatch.setattr(sys.modules["flockenv.cli.run"], "simulate", meanwhile)
    done = cli("run", *SMALL, *out, "--seed", "3", "-q")
    assert done.returncode == 0, done.stderr
    assert "Written to results/run-3.npz and results/run-3.toml" in done.stdout
    assert done.stderr == "results/run.npz was written by another command meanwhile.\n"
    before = {
        each.name: flockenv.Recording.load(each).seed for each in Path("results").glob("*.npz")
    }
    assert before == {"run.npz": 2, "run-2.npz": 1, "run-3.npz": 3}


def test_replay_writes_a_page_beside_the_recording(cli, run, tmp_path):
    done = cli("replay", run, "--json")
    assert done.stderr == ""
    written = json.loads(done.stdout)
    page = run.with_suffix(".html")
    assert written == {"html": str(page), "bytes": page.stat().st_size, "every": 1}
    pair = tmp_path / "sub" / "pair.html"
    done = cli("replay", run, run, "--html", pair)
    assert done.returncode == 0, done.stderr
    assert "<title>law (1) and law (2) – flockenv replay</title>" in pair.read_text()


def test_replay_draws_a_moving_picture(cli, run, tmp_path):
    """12 s at 8 times real time last 1.5 s: 19 frames of a GIF, and 38 of a video."""
    files = [tmp_path / "run.gif", tmp_path / "run.mp4"]
    done = cli("replay", run, "--gif", files[0], "--mp4", files[1], "--json")
    assert done.stderr == ""
    assert json.loads(done.stdout) == {"files": list(map(str, files))}
    with Image.open(files[0]) as picture:
        lasting = sum(frame.info["duration"] for frame in ImageSequence.Iterator(picture))
    assert lasting == pytest.approx(1520, abs=20)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(files[1]))
    assert (frames, seconds) == (38, pytest.approx(1.52, abs=0.05))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["replay", "{}/good.npz", "--gif", "{}/page.png"], ".gif"),
        (["replay", "{}/good.npz", "{}/good.npz", "--mp4", "{}/a.mp4"], "show one recording"),
        (["run", "--set", "n_bots=3"], "n_boats"),
        (["run", "--n_boats", "27"], "as in --set n_boats=27"),
        (["run", "--n-boats=27"], "as in --set n_boats=27"),
        (["run", "--n_boats", "--json"], "as in --set n_boats=VALUE"),
        (["run", "--set", "noise=0.3"], "noise_scheme"),
        (["run", "--preset", "simulaton"], "simulation"),
        (["run", "--policy", "dampd law"], "damped law"),
        (["run", "--policy", "{}/none.npz"], "cannot be read"),
        (["run", "--policy", "{}/good.npz"], "good.npz"),
        (["run", "--out", "{}/run.txt"], ".npz"),
        (["run", "--out", "/proc/none/run.npz"], "cannot be written"),
        (["run", "--minutes", "1e9", "--out", "/proc/run.npz"], "cannot be written"),
        (["run", "--minutes", "1e9", "--out", "{}/folder.npz"], "it is a folder"),
        (["run", "--minutes", "1e9", "--out", "{}/a.npz"], "a.toml cannot be written"),
        (["run", "--hz", "0"], "sample_hz"),
        (["run", "--set", "target=[/nothing]"], "target"),
        (["run", "--params", "{}/none.toml"], "cannot be read"),
        (["replay", "{}/none.npz"], "cannot be read"),
        (["replay", "{}/damaged.npz"], "damaged.npz"),
        (["replay", "{}/other.npz", "--html", "{}/x.html"], "other.npz"),
        (["replay", "{}/good.npz", "--html", "{}/page.png"], ".html"),
        (["replay", "{}/none.npz", "--html", "/proc/page.html"], "cannot be written"),
        (["replay", "{}/good.npz", "--name", "a", "--name", "b"], "2 times for 1"),
    ],
)
def test_errors_are_named_with_exit_code_2(cli, arguments, words, run, tmp_path):
    good = run.read_bytes()
    (tmp_path / "good.npz").write_bytes(good)
    (tmp_path / "damaged.npz").write_bytes(good[:3000] + bytes(200) + good[3200:])
    (tmp_path / "other.npz").write_bytes(b"PK\5\6" + bytes(18))
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "a.toml").mkdir()
    before = sorted(tmp_path.iterdir())
    done = cli(*(word.replace("{}", str(tmp_path)) for word in arguments), "--quiet")
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert sorted(tmp_path.iterdir()) == before


@pytest.fixture(scope="module")
def model(tmp_path_factory) -> Path:
    stable_baselines3 = pytest.importorskip("stable_baselines3")
    from flockenv.sb3 import LeaderVecEnv

    parameters = flockenv.FlockParameters(n_boats=8, n_leaders=2, pool="narrow")
    ppo = stable_baselines3.PPO(
        "MlpPolicy", LeaderVecEnv(1, params=parameters), device="cpu", seed=1
    )
    path = tmp_path_factory.mktemp("models") / "model.zip"
    ppo.save(path)
    return path


def test_models_of_stable_baselines3_steer_with_trust(cli, model, tmp_path):
    out = tmp_path / "run.npz"
    done = cli("run", *SMALL, "--seed", "3", "--policy", model, "--out", out)
    assert done.returncode == 2
    assert "--trust" in done.stderr
    assert not out.exists()
    trusted = ["--policy", model, "--trust", "--no-contacts"]
    done = cli("run", *SMALL, "--seed", "3", *trusted, "--out", out)
    assert done.returncode == 0, done.stderr
    policy = flockenv.policies.load(model, trust=True)
    parameters = flockenv.FlockParameters(n_boats=8, n_leaders=2, pool="narrow")
    assert flockenv.Recording.load(out) == flockenv.simulate(parameters, 3, 12.0, policy=policy)


def test_models_of_stable_baselines3_are_compared_with_trust(cli, model, tmp_path):
    short = ["--pool", "narrow", "--episodes", "2", "--minutes", "0.1", "--set", "n_boats=6"]
    call = ["compare", "--policy", model, "--leaders", "1", *short, "--out", tmp_path / "out"]
    refused = cli(*call)
    assert (refused.returncode, "--trust" in refused.stderr) == (2, True)
    done = cli(*call, "--trust")
    assert done.returncode == 0, done.stderr
    assert "sha256" in (tmp_path / "out" / "card.md").read_text()


def test_a_run_without_leaders_names_no_target(cli, tmp_path):
    for leaders in (0, 1):
        options = ["--set", f"n_leaders={leaders}", "--set", "n_boats=4", "--minutes", "0.2"]
        done = cli("run", *options, "--out", tmp_path / f"{leaders}.npz")
        assert done.returncode == 0, done.stderr
        assert ("towards target" in done.stdout) == (leaders == 1)
        assert "rotation" in done.stdout
