"""Law: generations steer in the scenarios that the options list, in turn, and count their time."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv._io.array_file import read_arrays
from flockenv.policies import load

TINY = ["--antithetic-pairs", "2", "--flocks", "1", "--episodes", "2", "--quiet"]


@pytest.fixture
def search(script, monkeypatch):
    monkeypatch.syspath_prepend(str(Path(script.__file__).parent))
    import evolution_strategy

    return evolution_strategy.main


def options_of(script, **changes):
    given = {
        "pool": "narrow", "boats": 8, "leaders": [3, 1], "noise": 1.0, "target": "random",
        "episode_s": 60.0, "scenario": [], "set": [], "liberal_steps": True, "control_hz": 2.0,
        "reward": "signed_order", "pairs": 2, "flocks": 3, "generations": None,
        "flock_hours": None,
    }  # fmt: skip
    return script.argparse.Namespace(**{**given, **changes})


def test_each_number_of_leaders_has_every_scenario_once(script) -> None:
    scenario = ["pool=wide,noise=0.5..1.25", "target=alternate,episode-s=480,leaders=2"]
    found = script.scenarios_of(options_of(script, scenario=scenario))
    assert [str(each) for each in found] == [
        "pool=wide,boats=8,leaders=3,noise=0.5..1.25,target=random,episode-s=60",
        "pool=narrow,boats=8,leaders=2,noise=1,target=alternate,episode-s=480",
        "pool=wide,boats=8,leaders=1,noise=0.5..1.25,target=random,episode-s=60",
        "pool=narrow,boats=8,leaders=2,noise=1,target=alternate,episode-s=480",
    ]
    assert [each.leaders for each in script.scenarios_of(options_of(script))] == [3, 1]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pool", "'pool' is no NAME=VALUE"),
        ("", "'' is no NAME=VALUE"),
        ("poll=narrow", "did you mean 'pool'"),
        ("pool=table-2", "pool = 'table-2' is not accepted: one of wide, narrow"),
        ("leaders=0", "leaders = '0' is not accepted: a whole number of at least 1"),
        ("boats=2.5", "boats = '2.5' is not accepted"),
        ("noise=1.25..0.5", "noise = '1.25..0.5' is not accepted: a number, or a range"),
        ("noise=nan", "noise = 'nan' is not accepted"),
        ("noise=1..2..3", "is not accepted: a number, or a range"),
        ("target=ccw", "target = 'ccw' is not accepted: one of random, alternate"),
        ("episode-s=0", "episode-s = '0' is not accepted: a positive time"),
        ("leaders=1,leaders=2", "has leaders twice"),
    ],
)
def test_bad_scenarios_are_named(script, text: str, words: str) -> None:
    with pytest.raises(flockenv.ParameterError, match=words):
        script.scenarios_of(options_of(script, scenario=["leaders=2", text]))


def test_noise_is_drawn_from_its_range_by_the_seed(script) -> None:
    scenario = script.scenarios_of(options_of(script, noise=(0.5, 1.25)))[0]
    env = script.environment(options_of(script), 40, scenario)
    critical = flockenv.FlockParameters.critical_bw_s("simulation", "narrow")
    for _ in range(2):
        env.reset(seed=[*range(20), *range(20)])
        drawn = np.array([env._batch.flock(place).parameters.bw_s for place in range(40)])
        np.testing.assert_array_equal(drawn[:20], drawn[20:])
        assert 0.5 * critical <= drawn.min() < 0.7 * critical
        assert 1.05 * critical < drawn.max() <= 1.25 * critical


def test_rewards_count_from_the_first_switch_of_the_target_on(script) -> None:
    options = options_of(script, target="alternate", reward="signed_order", episode_s=8.0)
    scenario = script.scenarios_of(options)[0]
    assert script.unscored_steps(options, scenario) == 4
    assert script.unscored_steps(options, script.scenarios_of(options_of(script))[0]) == 0
    env = script.environment(options, 2, scenario)
    seeds, ahead = [2**40, 2**40 + 1], lambda rows: np.zeros((2, 3))
    env.reset(seed=seeds)
    rewards = [env.step(ahead(None))[1] for _ in range(16)]
    found, _ = script.mean_rewards(env, seeds, ahead, 4)
    np.testing.assert_allclose(found, np.mean(rewards[4:], axis=0), atol=1e-12)
    assert not np.allclose(found, np.mean(rewards, axis=0))


def test_what_generations_take(script) -> None:
    scenario = ["target=alternate,episode-s=480,leaders=2", "pool=wide"]
    turns = script.Turns(options_of(script, scenario=scenario, flock_hours=4.0))
    # 12 flocks, in turn of 480 s with 2 leaders, and of 60 s with 3 leaders and with 1.
    assert turns.flock_hours(3) == pytest.approx(12 * (480 + 60 + 480) / 3600)
    assert turns.samples(4) == 12 * (2 * 960 + 3 * 120 + 2 * 960 + 1 * 120)
    assert [turns.are_over(count) for count in (3, 4, 5)] == [False, False, True]
    assert turns.most is None
    assert script.Turns(options_of(script)).most == 50
    both = script.Turns(options_of(script, generations=2, flock_hours=4.0))
    assert [both.are_over(count) for count in (1, 2)] == [False, True]


def test_a_mixed_search_ends_with_its_flock_hours(search, tmp_path: Path, capsys) -> None:
    mixed = ["--scenario", "pool=narrow,boats=8", "--scenario", "target=alternate,episode-s=8"]
    options = [*TINY, "--leaders", "2", "1", "--episode-s", "4", *mixed, "--form", "leaning"]
    # 4 flocks of 4 s and 8 s: the third generation ends beyond 16 s of 4 flocks.
    hours = 3 * 4 * 4 / 3600
    search([*options, "--flock-hours", str(hours), "--out", str(tmp_path)])
    expected = 4 * (4 + 8) / 3600
    assert float(read_arrays(tmp_path / "state.npz")["flock_hours"]) == pytest.approx(expected)
    table = pd.read_csv(tmp_path / "curve.csv")
    assert table["pool"].tolist() == ["narrow", "wide"]
    assert table["target"].tolist() == ["random", "alternate"]
    assert table["flock_hours"].tolist() == pytest.approx([16 / 3600, 48 / 3600], abs=1e-4)
    assert load(tmp_path / "policy.npz").provenance["flock_hours"] == f"{expected:.6g}"
    printed = capsys.readouterr().out
    assert "pool=wide,boats=6,leaders=1,noise=0.3,target=alternate,episode-s=8" in printed
    # More flock-hours continue it, here by a generation with one leader.
    search([*options, "--flock-hours", str(hours + 1e-9), "--out", str(tmp_path)])
    assert pd.read_csv(tmp_path / "curve.csv")["leaders"].tolist() == [2, 2, 1]


def test_candidates_scored_in_parts_have_the_same_scores(search, tmp_path: Path) -> None:
    switching = ["--target", "alternate", "--episode-s", "8", "--noise", "0.5..1"]
    options = [*TINY, *switching, "--form", "nonlinear", "--fellow-leaders", "1"]
    for name, engine in (("batch", []), ("parts", ["--engine", "local", "--workers", "3"])):
        arguments = ["--method", "lra-cma-es", "--generations", "2", "--out", str(tmp_path / name)]
        search([*options, *arguments, *engine])
    batch, parts = (read_arrays(tmp_path / name / "state.npz") for name in ("batch", "parts"))
    for name in ("scores", "average"):
        np.testing.assert_array_equal(batch[name], parts[name])
