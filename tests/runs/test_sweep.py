"""A sweep's table has one row per run, of the numbers that run has, whoever made it and when."""

import textwrap
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.policies.names import EVERY_SUBSTEP
from flockenv.runs.sweep import (
    SweepSpec,
    critical_noises,
    load_sweep,
    read_sweep,
    run_sweep,
    to_xarray,
)

SPEC = """
preset = "paper"
minutes = 0.5
seeds = 2

[fixed]
c4 = 0.05

[[grid]]
n_boats = [6]
pool = ["narrow", [120, 20]]
bw_s = [0, 0.5]

[[grid]]
n_boats = [8]
pool = ["narrow"]
bw_s = [0.5]
"""


def read(tmp_path: Path, text: str) -> SweepSpec:
    path = tmp_path / "spec.toml"
    path.write_text(textwrap.dedent(text), encoding="utf-8")
    return read_sweep(path)


def test_fixed_fields_and_those_of_the_grid_are_set_together(tmp_path: Path) -> None:
    """A fixed radius of gyration stays as the hull varies, and 25 leaders fit 27 boats."""
    sweep = read(
        tmp_path,
        """
        minutes = 0.5
        seeds = 1
        [fixed]
        gyration_radius_cm = 4.0
        n_leaders = 25
        [[grid]]
        n_boats = [27]
        boat_radius_cm = [3.0, 4.0]
        """,
    )
    assert [spec.parameters.gyration_radius_cm for spec in sweep.runs] == [4.0, 4.0]
    assert [spec.parameters.n_leaders for spec in sweep.runs] == [25, 25]


def test_every_combination_once(tmp_path: Path) -> None:
    sweep = read(tmp_path, SPEC)
    assert sweep.axes == ("n_boats", "pool", "bw_s")
    points = [tuple(getattr(spec.parameters, axis) for axis in sweep.axes) for spec in sweep.runs]
    assert points[::2] == [
        (6, "narrow", 0),
        (6, "narrow", 0.5),
        (6, (120, 20), 0),
        (6, (120, 20), 0.5),
        (8, "narrow", 0.5),
    ]
    assert [spec.seed for spec in sweep.runs] == [0, 1] * 5
    base = flockenv.FlockParameters.preset("paper").replace(c4=0.05)
    parameters = base.replace(n_boats=8, pool="narrow", bw_s=0.5)
    assert sweep.runs[-1].parameters == parameters
    assert sweep.runs[-1].duration_s == 30.0


def test_the_table_holds_what_the_runs_have(tmp_path: Path) -> None:
    sweep = read(tmp_path, SPEC)
    seen: list[object] = []
    table = run_sweep(sweep, tmp_path / "out", progress=seen.append)
    assert set(seen) == set(sweep.runs)
    assert len(table) == len(sweep.runs)
    assert table["pool"].tolist() == ["narrow"] * 4 + ["120x20"] * 4 + ["narrow"] * 2
    spec = sweep.runs[3]
    row = table.iloc[3]
    recording = flockenv.simulate(spec.parameters, spec.seed, 30.0)
    used = recording.in_analysis_window & (recording.time_s > 3.0)
    assert row["frames"] == used.sum()
    assert row["psi_o_mean"] == pytest.approx(recording.order.psi_o[used].mean(), abs=1e-6)
    assert row["c_v_std"] == pytest.approx(recording.order.c_v[used].std(), rel=1e-4)
    assert row["rotation_mean"] == pytest.approx(recording.order.rotation()[used].mean(), abs=1e-6)
    assert load_sweep(tmp_path / "out").equals(table)


def test_a_table_of_failures_alone_is_written(tmp_path: Path) -> None:
    sweep = read(tmp_path, "minutes = 0.5\nseeds = 1\n[[grid]]\nn_boats = [900]")
    table = run_sweep(sweep, tmp_path / "new" / "folder")
    assert "fit" in table["failure"].iloc[0]
    assert len(load_sweep(tmp_path / "new" / "folder")) == 1


def test_as_xarray(tmp_path: Path) -> None:
    table = run_sweep(read(tmp_path, SPEC), tmp_path / "out")
    dataset = to_xarray(table)
    assert dict(dataset.sizes) == {"n_boats": 2, "pool": 2, "bw_s": 2, "seed": 2}
    point = {"n_boats": 8, "pool": "narrow", "bw_s": 0.5, "seed": 1}
    assert float(dataset["psi_o_mean"].sel(point)) == table["psi_o_mean"].iloc[-1]
    assert np.isnan(dataset["psi_o_mean"].sel(n_boats=8, pool="120x20")).all()


GRID = "[[grid]]\nbw_s = [0.1]\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("minutes = 1\nseeds = 1\n[[grid]]\nbw = [0.1]", "bw_s"),
        ("minutes = 1\nseeds = 1\n[fixed]\nn_bots = 3\n" + GRID, "n_boats"),
        ("minutes = 1\nseeds = 1\n[[grid]]\nbw_s = 0.1", "a list of one or more values"),
        ("minutes = 1\nseeds = 1\n[[grid]]\nbw_s = []", "a list of one or more values"),
        ("minutes = 1\nseeds = 1\n", "grid is missing"),
        ("minutes = 1\nseeds = 0\n" + GRID, "seeds = 0"),
        ("minutes = 1\nseeds = [1, 1]\n" + GRID, "different seeds"),
        ("seeds = 1\n" + GRID, "minutes = None"),
        ("minutes = 1\nseeds = 1\nseedz = 1\n" + GRID, "did you mean 'seeds'"),
        ("minutes = 1\nseeds = 1\nc4 = 1\n" + GRID, r"\[fixed\]"),
        ("minutes = 1\nseeds = 1\n[fixed]\nbw_s = 0.2\n" + GRID, "both under"),
        ("minutes = 1\nseeds = 1\n" + GRID + "[[grid]]\nc4 = [0.1]", "same fields.*bw_s, c4"),
        ("minutes = 1\nseeds = 1000000\n[[grid]]\nbw_s = [0.1, 0.2]", "2000000 runs"),
        ("minutes = \n", "not TOML"),
        (f"minutes = 1{'0' * 400}\nseeds = 1\n" + GRID, "duration_s = inf"),
        (
            "minutes = 1\nseeds = 1\n[[grid]]\npool = [130, 70]",
            r'pool = 130 is not accepted: .* as in pool = \[\[130, 70\], "wide"\]$',
        ),
        (
            'minutes = 1\nseeds = 1\n[[grid]]\npool = ["(130, 70)"]',
            r"pool = '\(130, 70\)' is not accepted: .* as in pool = \[\[130",
        ),
        (
            'minutes = 1\nseeds = 1\n[fixed]\npool = "130,70"\n' + GRID,
            r"pool = '130,70' is not accepted: .* as in pool = \[130, 70\]$",
        ),
        (
            'minutes = 1\nseeds = 1\npolicy = "learned"\n[fixed]\nn_leaders = 1\n'
            'pool = "narrow"\n' + GRID,
            "narrow",
        ),
        ('minutes = 1\nseeds = 1\npolicy = "damped law"\n' + GRID, "nobody is steered"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(flockenv.ParameterError, match=words) as caught:
        read(tmp_path, text)
    assert "spec.toml" in str(caught.value)


def test_flocks_without_leaders_are_what_a_policy_is_compared_with(tmp_path: Path) -> None:
    text = 'minutes = 1\nseeds = 1\npolicy = "damped law"\n[[grid]]\nn_leaders = [0, 2]'
    assert [run.policy for run in read(tmp_path, text).runs] == [EVERY_SUBSTEP, "damped law"]


def test_a_missing_or_foreign_table_is_named(tmp_path: Path) -> None:
    with pytest.raises(flockenv.ParameterError, match=r"cannot be read"):
        read_sweep(tmp_path / "none.toml")
    with pytest.raises(flockenv.ParameterError, match=r"sweep\.parquet"):
        load_sweep(tmp_path)
    (tmp_path / "sweep.parquet").write_bytes(b"PAR1 nonsense")
    with pytest.raises(flockenv.ParameterError, match="not a table of a sweep"):
        load_sweep(tmp_path)


DOCS = Path(__file__).parents[2] / "docs"


def test_the_example_of_the_docs_is_accepted() -> None:
    sweep = read_sweep(DOCS / "sweep-example.toml")
    assert len(sweep.runs) == 2 * 2 * 5 * 4


def test_targets_of_each_leader_are_an_axis(tmp_path: Path) -> None:
    spec = tmp_path / "sides.toml"
    text = """
    minutes = 1
    seeds = 1
    [fixed]
    n_boats = 20
    pool = "narrow"
    [[grid]]
    n_leaders = [2]
    target = ["cw", ["cw", "ccw"], ["ccw", "cw"]]
    """
    spec.write_text(text)
    table = run_sweep(read_sweep(spec), tmp_path / "out")
    assert table["target"].tolist() == ["cw", "cw,ccw", "ccw,cw"]
    assert load_sweep(tmp_path / "out")["signed_order_mean"].nunique() == 3
    spec.write_text(text.replace("[2]", "[3]"))
    with pytest.raises(flockenv.ParameterError, match="n_leaders = 3"):
        read_sweep(spec)


def noisy_table(rotation: float) -> pd.DataFrame:
    """Two flocks at four noises, three runs of each; Ψ_o of the second falls a level later."""
    rows = [
        {
            "n_boats": n,
            "bw_s": bw_s,
            "seed": seed,
            "psi_o_mean": psi_o,
            "rotation_size": rotation if psi_o > 0.5 else 0.1,
            "failure": "",
        }
        for n, curve in ((20, [0.9, 0.3, 0.1, 0.1]), (30, [0.9, 0.9, 0.3, 0.1]))
        for bw_s, psi_o in zip([0.1, 0.2, 0.3, 0.4], curve, strict=True)
        for seed in range(3)
    ]
    return pd.DataFrame(rows)


def test_each_flock_of_a_sweep_has_its_critical_noise() -> None:
    found = critical_noises(noisy_table(0.8)).set_index("n_boats")
    # The middle of 0.9 and 0.1 is 0.5: two thirds of the way from 0.9 down to 0.3.
    assert found["critical_bw_s"].to_list() == pytest.approx([0.1 + 0.2 / 3, 0.2 + 0.2 / 3])
    assert found["rotation_size"].to_list() == pytest.approx([0.8, 0.8])
    assert critical_noises(noisy_table(0.4))["critical_bw_s"].isna().all()
    failed = noisy_table(0.8).assign(failure="too many boats")
    assert critical_noises(failed).empty
    assert critical_noises(noisy_table(0.8).query("bw_s == 0.1")).empty
    assert (
        len(critical_noises(noisy_table(0.8).query("n_boats == 20").drop(columns="n_boats"))) == 1
    )
