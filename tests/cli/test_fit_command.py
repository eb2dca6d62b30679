"""`flockenv fit` refuses nonsense in words; `flockenv presets` prints the source of numbers."""

import json

import pytest

import flockenv
from flockenv.calibration import search as experiment_fit


@pytest.fixture
def quick(monkeypatch):
    def run_flock(parameters, seed):
        return [
            0.9 if parameters.bw_s < 1.4 + 0.2 * parameters.n_leaders else 0.2,
            0.8,
            0.7,
            0,
            0.05,
            0.7,
        ]

    monkeypatch.setattr(experiment_fit, "run_flock", run_flock)


def test_a_fit_prints_its_residuals_and_writes_its_files(cli, quick, tmp_path):
    options = ["--trials", "11", "--seeds", "1", "--finalists", "1", "--held-out", "2"]
    done = cli("fit", *options, "--json", "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    reported = json.loads(done.stdout)
    within = {row["key"]: row["in_range"] for row in reported["residuals"]}
    # JSON has neither infinity nor NaN: a range without an end, and a value that is undefined.
    assert within == {
        row["key"]: row["value"] is not None
        and (row["target_low"] or 0.0) <= row["value"]
        and (row["target_high"] is None or row["value"] <= row["target_high"])
        for row in reported["residuals"]
    }
    assert {True, False} == set(within.values())
    fitted = flockenv.FlockParameters.from_dict(reported["parameters"])
    text = (tmp_path / "parameters.toml").read_text(encoding="utf-8")
    assert flockenv.FlockParameters.from_toml(text) == fitted


def test_a_preset_can_be_checked_without_a_fit(cli, quick, tmp_path):
    options = ["--check", "experiment", "--held-out", "2", "--scheme", "moreau", "--json"]
    done = cli("fit", *options, "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["parameters"]["scheme"] == "moreau"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--free", "c9"], "c9"),
        (["--only", "beauty"], "beauty"),
        (["--trials", "0"], "trials"),
        (["--scheme", "euler"], "scheme"),
        (["--check", "nothing"], "preset"),
    ],
)
def test_nonsense_is_refused_in_words(cli, options, word, tmp_path):
    done = cli("fit", *options, "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert done.stderr.startswith("Error: ")
    assert word in done.stderr
    assert not (tmp_path / "out").exists()


def test_presets_name_the_source_of_each_number(cli):
    for name in flockenv.FlockParameters.presets():
        sources = flockenv.FlockParameters.preset_sources(name)
        assert list(sources) == list(flockenv.FlockParameters.preset(name).to_dict())
        assert all(sources.values())
    done = cli("presets", COLUMNS="160")
    assert "experiment: flockenv fit" in done.stdout
    assert "Table 3" in done.stdout
