"""`flockenv fit` refuses nonsense in words; `flockenv presets` prints the source of numbers."""

import json

import numpy as np
import pytest

import flockenv
from flockenv.calibration import held_out, surrogate, tradeoffs
from flockenv.calibration import search as fit_search
from flockenv.calibration.flock_runs import QUANTITIES, FlockRuns

SMALL = [
    *("--free", "c3,c4", "--pools", "table-1", "--filling-hours", "27", "--flock-hours", "32"),
    *("--batch", "4", "--repetitions", "1", "--judged", "1", "--held-out", "2"),
]


@pytest.fixture
def quick(monkeypatch):
    def run_flocks(parameters, design, seeds, jobs=1, progress=lambda: None):
        shape = (len(design.cells), len(design.seeds(seeds)), len(QUANTITIES))
        values = np.full(shape, 0.7)
        for place, cell in enumerate(design.cells):
            values[place, :, 0] = 0.95 if cell.bw_s < 1.4 + 0.2 * cell.leaders else 0.2
        return FlockRuns(design, values)

    monkeypatch.setattr(fit_search, "run_flocks", run_flocks)
    monkeypatch.setattr(held_out, "run_flocks", run_flocks)
    monkeypatch.setattr(held_out, "_RESAMPLES", 5)
    monkeypatch.setattr(surrogate, "_CANDIDATES", 60)
    monkeypatch.setattr(tradeoffs, "_CLOUD", 60)


def test_a_fit_prints_its_residuals_and_writes_its_files(cli, quick, tmp_path):
    done = cli("fit", *SMALL, "--json", "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    reported = json.loads(done.stdout)
    within = {row["key"]: row["in_range"] for row in reported["residuals"]}
    # JSON has neither infinity nor NaN: a range without an end, and a value that is undefined.
    assert within == {
        row["key"]: row["value"] is not None
        and (row["target_low"] is None or row["target_low"] <= row["value"])
        and (row["target_high"] is None or row["value"] <= row["target_high"])
        for row in reported["residuals"]
    }
    assert {True, False} == set(within.values())
    fitted = flockenv.FlockParameters.from_dict(reported["parameters"])
    text = (tmp_path / "parameters.toml").read_text(encoding="utf-8")
    assert flockenv.FlockParameters.from_toml(text) == fitted
    # Without --json the budget of each part is printed too; the finished fit is only read.
    done = cli("fit", *SMALL, "-q", "--out", str(tmp_path))
    assert "24 trials; flock-hours: search 32, finalists 19, held-out seeds 11" in done.stdout


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
        (["--pools", "pond"], "pond"),
        (["--flock-hours", "100"], "inconclusive: needs at least filling_hours = 2048"),
        (["--filling-hours", "100"], "inconclusive: needs at least 293"),
        (["--repetitions", "0"], "repetitions"),
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
