"""Law: the search climbs, resumes exactly where it was, and its policy needs core parts alone."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.envs.observation import observation_entries
from flockenv.policies import HiddenUnits, LeaningLaw, NetworkPolicy, load
from flockenv.policies.pretrained import tuned_law

TINY = [
    "--antithetic-pairs",
    "3",
    "--flocks",
    "1",
    "--episode-s",
    "5",
    "--episodes",
    "4",
    "--quiet",
]


@pytest.mark.parametrize(
    "hidden",
    [
        [],
        ["--hidden", "4"],
        ["--form", "leaning", "--sigma", "1", "--average", "0.3"],
        ["--form", "nonlinear", "--hidden", "2", "--sigma", "1", "--fellow-leaders", "1"],
    ],
)
@pytest.mark.parametrize("method", ["evolution-strategy", "lra-cma-es", "sep-cma-es"])
def test_resumed_is_uninterrupted(script, tmp_path: Path, hidden: list[str], method: str) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    hidden = [*hidden, "--method", method]
    script.main([*TINY, *hidden, "--generations", "3", "--out", str(whole)])
    script.main([*TINY, *hidden, "--generations", "1", "--out", str(parts)])
    script.main([*TINY, *hidden, "--generations", "3", "--out", str(parts)])
    one, other = load(whole / "policy.npz"), load(parts / "policy.npz")
    size = len(observation_entries(one.observation))
    rows = np.random.default_rng(0).uniform(-1, 1, (20, size)).astype(np.float32)
    np.testing.assert_array_equal(one.predict(rows)[0], other.predict(rows)[0])
    assert one.digest == other.digest
    states = [{**read_arrays(out / "state.npz")} for out in (whole, parts)]
    for name in set(states[0]) - {"wall_s"}:
        np.testing.assert_array_equal(states[0][name], states[1][name])
    # 3 generations, 6 candidates, one flock with 2 leaders, 10 steps.
    assert one.provenance["samples"] == str(3 * 6 * 2 * 10)
    assert one.provenance["command"].startswith("python baselines/evolution_strategy.py")


def test_candidates_steer_as_their_policies_do(script) -> None:
    random = np.random.default_rng(0)
    size = len(observation_entries())
    for hidden in ([], [5, 3]):
        shape = script.Shape(size, hidden)
        flat = random.standard_normal((4, shape.size)).astype(np.float32) / 5
        rows = random.uniform(-1, 1, (4, 7, size)).astype(np.float32)
        rudders = shape.steering(flat)(rows)
        assert (abs(rudders) < 1).any()
        for candidate in range(4):
            policy = shape.policy(flat[candidate], {})
            expected = policy.predict(rows[candidate])[0][:, 0]
            np.testing.assert_allclose(rudders[candidate], expected, atol=2e-6)


def options_of(script, **changes):
    """Options as the command has them."""
    given = {
        "leaders": [2], "control_hz": 2.0, "seed": 0, "pool": "narrow", "boats": 8, "noise": 1.0,
        "episode_s": 60.0, "reward": "signed_order", "liberal_steps": False, "set": [],
        "tuned": True, "start": None, "scenario": [], "target": "random", "form": "leaning",
        "hidden": [], "fellow_leaders": 0,
    }  # fmt: skip
    return script.argparse.Namespace(**{**given, **changes})


@pytest.mark.parametrize(
    ("changes", "size"),
    [
        ({}, 3 + 1 + 23),
        ({"fellow_leaders": 2}, 3 + 1 + 28),
        ({"form": "nonlinear", "hidden": [3]}, 3 + 1 + 29 + 3 * 31),
        ({"form": "nonlinear", "hidden": [2], "fellow_leaders": 2}, 3 + 1 + 34 + 2 * 36),
        ({"scenario": ["pool=wide", "target=alternate,leaders=3"]}, 3 + 1 + 23),
    ],
)
def test_leaning_candidates_steer_as_their_policies_do(script, changes, size: int) -> None:
    random, seen = np.random.default_rng(0), []
    shape = script.form_of(options_of(script, **changes))
    assert shape.size == size
    flat = random.standard_normal((4, shape.size))
    width = len(observation_entries(shape.blocks))
    rows = random.uniform(-1, 1, (4, 7, width)).astype(np.float32)
    rudders = shape.steering(flat)(rows)
    for candidate in range(4):
        policy = shape.policy(flat[candidate], {})
        expected = policy.predict(rows[candidate])[0][:, 0]
        np.testing.assert_allclose(rudders[candidate], expected, atol=1e-6)
        seen.append(expected)
    # What it starts as is the damped law.
    assert shape.initial.gains == tuned_law("damped law", "narrow").gains
    initial = shape.policy(shape.first(random), {})
    np.testing.assert_allclose(
        initial.predict(rows)[0][..., 0], shape.initial.predict(rows)[0][..., 0], atol=1e-5
    )
    assert np.ptp(seen, axis=0).max() > 0.1
    # Every number of the vector changes something, once hidden units have outputs.
    many = random.uniform(-1, 1, (1, 200, width)).astype(np.float32)
    # Slow enough that the damping of the spin does not exceed a full rudder.
    many[..., [entry.name for entry in observation_entries()].index("clockwise_spin")] *= 0.02
    base = shape.steering(np.full((1, shape.size), 0.3))(many)
    for place in range(shape.size):
        moved = np.full((1, shape.size), 0.3)
        moved[0, place] = 1.0
        assert not np.array_equal(shape.steering(moved)(many), base), place


def test_a_search_starts_from_a_stored_law(script, tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    weights = {"near": 0.3, "mean_sin_orientation": -0.4}
    hidden = HiddenUnits({"near": [0.5, -0.3]}, [0.1, 0.2], [0.4, -0.3])
    gains = {"gain": 0.6, "backward_gain": 1.5, "damping": 9.0}
    path = tmp_path / "law.npz"
    for units, changes in ((None, {}), (hidden, {"form": "nonlinear", "hidden": [3]})):
        law = LeaningLaw(gains, 0.2, weights, hidden=units)
        law.save(path)
        for fellow_leaders in (0, 2):
            more = {"tuned": False, "start": str(path), "fellow_leaders": fellow_leaders}
            shape = script.form_of(options_of(script, **changes, **more))
            found = shape.policy(shape.first(random), {})
            width, size = len(observation_entries(shape.blocks)), len(observation_entries())
            rows = random.uniform(-1, 1, (20, width)).astype(np.float32)
            expected = law.predict(rows[:, :size])[0]
            np.testing.assert_allclose(found.predict(rows)[0], expected, atol=1e-5)
    with pytest.raises(flockenv.ParameterError, match="--form nonlinear --hidden 2"):
        script.form_of(options_of(script, tuned=False, start=str(path)))
    NetworkPolicy([np.zeros((67, 1))], [[0.0]]).save(path)
    with pytest.raises(flockenv.ParameterError, match="not a leaning law"):
        script.form_of(options_of(script, tuned=False, start=str(path)))


def test_a_search_from_another_law_is_another_search(script, tmp_path: Path) -> None:
    path = tmp_path / "law.npz"
    arguments = [*TINY, "--form", "leaning", "--start", str(path), "--out", str(tmp_path / "out")]
    gains = {"gain": 0.6, "backward_gain": 1.5, "damping": 9.0}
    LeaningLaw(gains, 0.2, {}).save(path)
    script.main([*arguments, "--generations", "1"])
    script.main([*arguments, "--generations", "2"])
    LeaningLaw(gains, 0.3, {}).save(path)
    with pytest.raises(SystemExit, match="other options"):
        script.main([*arguments, "--generations", "3"])


@pytest.mark.parametrize("method", ["evolution-strategy", "lra-cma-es", "sep-cma-es"])
def test_it_climbs(script, monkeypatch: pytest.MonkeyPatch, method: str) -> None:
    """On rewards that are known, -|w - 1|², instead of the flock's."""
    shape = script.Shape(3, [])
    monkeypatch.setattr(script, "scores", lambda env, shape, w, *_: -((w - 1) ** 2).sum(axis=1))
    rates = {"sigma": 0.1, "rate": 0.1, "average": 1.0}
    parser = {"pairs": 8, "flocks": 1, "seed": 0, "engine": None, **rates}
    options = script.argparse.Namespace(**parser)
    scenario = script.Scenario("wide", 6, 2, 1.0, "random", 60.0)
    zeros = np.zeros(shape.size)
    state = script.State(0, script.METHODS[method](zeros, options), zeros, 0.0, np.empty(0))
    for _ in range(60):
        state = script.next_generation(state, None, shape, options, scenario)
    np.testing.assert_allclose(state.average, 1.0, atol=0.25)


def test_the_flock_can_be_changed(script, tmp_path: Path, capsys) -> None:
    arguments = [*TINY, "--generations", "1", "--out"]
    for name, change in (("as-is", []), ("strong", ["--set", "c2=1.0"])):
        script.main([*arguments, str(tmp_path / name), *change])
    plain, strong = (load(tmp_path / name / "policy.npz") for name in ("as-is", "strong"))
    assert not np.array_equal(plain.weights[0], strong.weights[0])
    with pytest.raises(SystemExit, match="c22"):
        script.main([*arguments, str(tmp_path / "wrong"), "--set", "c22=1.0"])


def test_other_options_do_not_go_on(script, tmp_path: Path) -> None:
    script.main([*TINY, "--generations", "1", "--out", str(tmp_path)])
    with pytest.raises(SystemExit, match="other options"):
        script.main([*TINY, "--generations", "2", "--seed", "1", "--out", str(tmp_path)])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("bw_s=0.2", "--noise rules it"),
        ("n_boats=8", "--boats rules it"),
        ("n_leaders=1", "--leaders rules it"),
        ("pool=narrow", "--pool rules it"),
        ("reward={signed_order=1.0}", "reward' is no field"),
        ("episode_s=5.0", "episode_s' is no field"),
        ("control_hz=5.0", "control_hz' is no field"),
        ("target=cw", "the search itself rules it"),
        ("observation={order=false}", "observation' is no field"),
        ("autoreset_mode=same_step", "autoreset_mode' is no field"),
        ("dt_s=0.05", "--liberal-steps rules it"),
        ("c2=strong", "--set: c2 must be a number"),
    ],
)
@pytest.mark.parametrize("form", ["network", "leaning"])
def test_what_something_else_rules_is_not_set(
    script, tmp_path: Path, change: str, words: str, form: str
) -> None:
    arguments = [*TINY, "--form", form, "--liberal-steps", "--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit, match=f"Error: .*{words}"):
        script.main([*arguments, "--set", change])
    assert not (tmp_path / "out" / "state.npz").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--form", "leaning", "--hidden", "8"], "--hidden is for --form network"),
        (["--tuned"], "--tuned is for --form leaning"),
        (["--start", "law.npz"], "--start is for --form leaning"),
        (
            ["--form", "leaning", "--tuned", "--start", "law.npz"],
            "--tuned and --start exclude each other",
        ),
        (["--form", "nonlinear", "--hidden", "4", "4"], "has one hidden layer"),
        (["--form", "nonlinear", "--hidden", "0"], "are at least 1"),
        (["--fellow-leaders", "65"], "--fellow-leaders is from 0 to 64"),
        (["--flock-hours", "0"], "--flock-hours is positive"),
        (["--sigma", "0"], "--sigma and --learning-rate are positive"),
        (["--sigma", "nan", "--method", "lra-cma-es"], "--sigma and --learning-rate are positive"),
        (["--learning-rate", "inf"], "--sigma and --learning-rate are positive"),
        (["--moving-average", "1.5"], "--moving-average is above 0 and at most 1"),
        (["--episodes", "1"], "--episodes is at least 2"),
        (["--noise", "1..0.5"], "invalid noise value: '1..0.5'"),
        (["--target", "cw"], "invalid choice: 'cw'"),
        (["--method", "cma"], "invalid choice: 'cma'"),
        (["--seed", "-1"], "--seed: -1 is not accepted: from 0 to 4294967295"),
        (["--seed", str(2**32)], "is not accepted: from 0 to 4294967295"),
    ],
)
def test_options_that_do_not_fit(script, tmp_path: Path, capsys, arguments, words: str) -> None:
    with pytest.raises(SystemExit) as ended:
        script.main([*TINY, *arguments, "--out", str(tmp_path)])
    assert ended.value.code == 2
    assert words in capsys.readouterr().err


def test_the_last_seed(script, tmp_path: Path) -> None:
    arguments = [*TINY, "--generations", "1", "--seed", str(2**32 - 1)]
    script.main([*arguments, "--out", str(tmp_path)])


def test_scores_that_lead_elsewhere_are_refused(script, tmp_path: Path) -> None:
    arguments = [*TINY, "--method", "lra-cma-es", "--out", str(tmp_path), "--generations"]
    script.main([*arguments, "1"])
    arrays = {**read_arrays(tmp_path / "state.npz")}
    for change, words in (
        ({"scores": -arrays["scores"]}, "do not lead to the stored mean"),
        ({"scores": None}, "is no state of a search: the array scores is missing"),
        ({"curve": None}, "is no state of a search"),
    ):
        found = {name: each for name, each in {**arrays, **change}.items() if each is not None}
        write_arrays(tmp_path / "state.npz", found)
        with pytest.raises(SystemExit, match=words):
            script.main([*arguments, "2"])


def test_how_many_are_held_out_is_no_other_search(script, tmp_path: Path) -> None:
    arguments = [*TINY, "--generations", "1", "--out", str(tmp_path)]
    script.main(arguments)
    # Earlier states name them.
    arrays = read_arrays(tmp_path / "state.npz")
    stored = {**json.loads(str(arrays["identity"])), "episodes": 4}
    write_arrays(tmp_path / "state.npz", {**arrays, "identity": np.array(json.dumps(stored))})
    script.main([*arguments, "--episodes", "3"])


def test_a_foreign_state_is_refused(script, tmp_path: Path) -> None:
    for identity in ("[]", "no JSON"):
        write_arrays(tmp_path / "state.npz", {"identity": np.array(identity)})
        with pytest.raises(SystemExit, match=r"state\.npz is no state of a search"):
            script.main([*TINY, "--out", str(tmp_path)])


@pytest.mark.parametrize("method", ["evolution-strategy", "sep-cma-es"])
@pytest.mark.parametrize("name", ["weights", "average", "curve", "generation", "wall_s"])
@pytest.mark.parametrize("damage", [np.zeros((2, 2)), np.array("many"), np.array(np.nan)])
def test_a_damaged_state_is_refused(script, tmp_path: Path, method, name: str, damage) -> None:
    arguments = [*TINY, "--method", method, "--out", str(tmp_path), "--generations"]
    script.main([*arguments, "1"])
    state = tmp_path / "state.npz"
    write_arrays(state, {**read_arrays(state), name: damage})
    with pytest.raises(SystemExit, match="is no state of a search: "):
        script.main([*arguments, "2"])


@pytest.mark.parametrize(
    ("generations", "words"), [(0, "nothing is stored yet"), (1, "resumes from")]
)
def test_an_interrupt_reports_what_is_stored(
    script, tmp_path: Path, monkeypatch, generations: int, words: str
) -> None:
    def interrupted(state, *arguments):
        if state.generation == generations:
            raise KeyboardInterrupt
        return whole(state, *arguments)

    whole = script.next_generation
    monkeypatch.setattr(script, "next_generation", interrupted)
    with pytest.raises(SystemExit, match=f"Interrupted: .*{words}"):
        script.main([*TINY, "--generations", "2", "--out", str(tmp_path)])


def test_neither_torch_nor_pandas_is_needed(script, tmp_path: Path) -> None:
    forbid = "import sys; sys.modules.update(torch=None, stable_baselines3=None, pandas=None)"
    # As Python does for a script that it runs.
    beside = f"sys.path.insert(0, {str(Path(script.__file__).parent)!r})"
    run = f"import runpy; runpy.run_path({script.__file__!r}, run_name='__main__')"
    arguments = [*TINY, "--generations", "1", "--out", str(tmp_path)]
    command = [sys.executable, "-c", f"{forbid}; {beside}; {run}", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "policy.npz").is_file()


@pytest.mark.parametrize("form", ["network", "leaning"])
@pytest.mark.parametrize("engine", ["local", "joblib"])
def test_candidates_scored_in_parts_have_the_same_scores(script, tmp_path, engine, form) -> None:
    options = [*TINY, "--generations", "2", "--form", form, "--out"]
    script.main([*options, str(tmp_path / "batch")])
    script.main([*options, str(tmp_path / "parts"), "--engine", engine, "--workers", "2"])
    states = (read_arrays(tmp_path / name / "state.npz") for name in ("batch", "parts"))
    batch, parts = ({**each} for each in states)
    for name in ("weights", "curve", "average"):
        np.testing.assert_array_equal(batch[name], parts[name])


def test_an_unknown_engine_is_named(script, tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="'abacus' is not accepted"):
        script.main([*TINY, "--engine", "abacus", "--out", str(tmp_path / "out")])


def test_options_of_stored_commands_are_understood(script, tmp_path: Path) -> None:
    """Model cards hold commands with the earlier names of three options."""
    names = ("--pairs", "--rate", "--average")
    present = ("--antithetic-pairs", "--learning-rate", "--moving-average")
    states = []
    for options in (names, present):
        values = [word for pair in zip(options, ("3", "0.1", "0.5"), strict=True) for word in pair]
        out = tmp_path / options[0]
        script.main([*TINY[2:], *values, "--generations", "2", "--out", str(out)])
        states.append({**read_arrays(out / "state.npz")})
    for name in ("weights", "average"):
        np.testing.assert_array_equal(states[0][name], states[1][name])
