"""Law: the experiment's figures hold what their runs hold, and claims follow from them by rule."""

import re

import numpy as np
import pandas as pd
import pytest

from flockenv.reproduce.catalogue import load
from flockenv.reproduce.command import plan, reproduce
from flockenv.reproduce.experiment.design import LEVELS_S, SETUPS, noise_series
from flockenv.reproduce.experiment.runs import line_or_none, resampled
from flockenv.reproduce.experiment.time_figures import _flips, _longest
from flockenv.reproduce.reproduction import Settings
from flockenv.statistics.intervals import RESAMPLES, interval, mean_replicates

SHORT = Settings(minutes=1 / 3)
FIGURES = ("fig4", "fig5", "fig6", "fig7", "fig8", "fig9", "fig10", "fig11", "fig12")


@pytest.mark.parametrize("name", [*FIGURES, "table2", "motion"])
def test_runs_are_those_of_the_experiment(name):
    specs = load(name).runs(Settings())
    assert len(set(specs)) == len(specs) > 0
    for spec in specs:
        parameters = spec.parameters
        assert (parameters.n_boats, parameters.pool, parameters.leaders_reverse) == (
            27,
            "table-1",
            False,
        )
        assert parameters.n_leaders <= 4
        assert 0.4 <= parameters.bw_s <= 2.8
        assert spec.duration_s in (480.0, 960.0)


def test_columns_differ_by_leaders_alone():
    for setup in SETUPS:
        points = noise_series(Settings(), setup)
        assert len(points) == len(LEVELS_S)
        for bw_s, specs in zip(LEVELS_S, points, strict=True):
            assert {spec.parameters.bw_s for spec in specs} == {bw_s}
            assert {spec.parameters.n_leaders for spec in specs} == {setup.n_leaders}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Of all figures, which share runs."""
    return tmp_path_factory.mktemp("figures")


@pytest.mark.parametrize(
    "name", ["fig4", "fig6", "fig7", "fig9", "fig10", "fig12", "table2", "fig14"]
)
def test_a_figure_of_short_runs_is_written(name, folder, follows):
    claims = reproduce(plan([name], SHORT), folder)
    for ending in ("csv", "parquet", "png", "svg"):
        assert list((folder / name).glob(f"{name}*.{ending}"))
    reported = pd.read_csv(folder / name / "claims.csv")
    assert len(reported) == len(claims[name]) > 0
    assert all(follows(row) for _, row in reported.iterrows())
    assert "short runs: 0.333 min" in next((folder / name).glob("*.svg")).read_text()


def test_the_axis_of_order_ends_at_one(folder):
    reproduce(plan(["fig12"], SHORT), folder)
    picture = (folder / "fig12" / "fig12.svg").read_text()
    ticks = [float(each) for each in re.findall(r">(\d\.\d)</text>", picture)]
    assert max(ticks) == 1.0
    assert len(ticks) == 6


def test_motion_is_written_without_claims(folder):
    assert reproduce(plan(["motion"], SHORT), folder) == {"motion": []}
    tables = [
        pd.read_csv(path) for path in (folder / "motion").glob("*.csv") if path.name != "claims.csv"
    ]
    assert tables
    assert all(len(table) and table.notna().any().all() for table in tables)


def test_runs_are_drawn_within_their_groups():
    runs = pd.DataFrame({"k": [0] * 4 + [1] * 4, "y": [0.0] * 4 + [1.0] * 4})
    slopes = resampled(runs, "k", lambda r: np.polyfit(r["k"], r["y"], 1)[0])
    assert len(slopes) == RESAMPLES + 1
    assert interval(slopes) == pytest.approx((1.0, 1.0, 1.0))


def test_a_line_needs_three_known_points():
    x, y = pd.Series([0.0, 1.0, 2.0, 3.0]), pd.Series([1.0, 3.0, np.nan, 7.0])
    line = line_or_none(x, y)
    assert line is not None
    assert (line.slope, line.intercept, line.n) == (pytest.approx(2.0), pytest.approx(1.0), 3)
    assert line_or_none(x[1:], y[1:]) is None


def test_means_over_runs_are_drawn_from_them():
    values = mean_replicates(np.array([0.0, 1.0]))
    assert values[0] == 0.5
    assert set(values[1:]) == {0.0, 0.5, 1.0}


def cycles(*rotation):
    return pd.DataFrame({"time_s": 6.0 * np.arange(len(rotation)), "rotation": rotation})


def test_changes_of_direction_and_stretches_of_order():
    both = cycles(0.9, 0.8, 0.1, 0.9, -0.1, -0.9, -0.9, -0.9, 0.2, 0.9)
    # Disorder between two stretches one way is no change of direction, but it ends a stretch.
    assert _flips(both) == 2
    assert _longest(both) == pytest.approx(3 * 6 / 60)
    assert _flips(cycles(0.1, 0.2, -0.3)) == 0
    assert _longest(cycles(0.1, 0.2, -0.3)) == 0.0
