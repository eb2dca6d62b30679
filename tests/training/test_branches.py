"""A training in branches goes on from its bytes to the same policy, and names what it refuses."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv import _core
from flockenv.errors import FlockError, ParameterError
from flockenv.policies import load
from flockenv.training.branches import (
    CHECKPOINT,
    POLICY,
    BranchTraining,
    compare_with_laws,
    stored_training,
    train,
    training_flocks,
)

#: Two rounds of two pairs, 32 s each.
TINY = {"pairs": 2, "branch_s": 32.0, "hold_s": 8.0, "trial_s": 16.0, "flock_hours": 0.07}


def tiny(seed: int = 0, **options) -> BranchTraining:
    flocks = training_flocks("narrow", n_boats=6, n_leaders=2)
    return BranchTraining(flocks, seed=seed, **{**TINY, **options})


@pytest.mark.parametrize("mode", ["lean", "rudder"])
def test_a_training_goes_on_from_its_bytes(mode):
    whole, half = tiny(action_mode=mode), tiny(action_mode=mode)
    half.advance()
    half = BranchTraining.from_bytes(half.to_bytes())
    for each in (whole, half):
        while not each.has_ended:
            each.advance()
    assert half.policy().to_json() == whole.policy().to_json()
    assert half.parameters == whole.parameters
    assert list(half.curve["flock_hours"]) == pytest.approx([0.0355556, 0.0711111], abs=1e-6)
    assert whole.policy().to_json() != tiny(seed=1, action_mode=mode).policy().to_json()


RUST = Path(__file__).parents[1] / "environment" / "same_bits_of_training.rs"
LEAN, RUDDER = re.findall(r"ActionMode::(\w+), 0x([0-9a-f_]+)\)", RUST.read_text("utf-8"))


@pytest.mark.parametrize(("mode", "expected"), [LEAN, RUDDER])
def test_this_build_trains_the_bits_of_the_plain_one(mode, expected):
    """The task and the hash of Rust's test, which is built without AVX2; the page has our bits."""
    flock = {"n_boats": 9, "n_leaders": 3, "pool": "narrow", "dt_s": 0.1}
    parameters = flockenv.FlockParameters.preset("simulation").replace(**flock)
    settings = {"action_mode": mode.lower(), "pairs": 6, "flock_hours": 3.0 * 12.0 * 32.0 / 3600.0}
    settings |= {"branch_s": 32.0, "hold_s": 8.0, "seen_s": 2.0, "trial_s": 16.0}
    trainer = _core.Trainer(parameters, settings | {"episode_s": 64.0}, 5, 1 << 40)
    while not trainer.has_ended:
        trainer.advance(6)
    law = json.loads(trainer.law.to_json())
    orders = [order for _, order in trainer.curve]
    found = 0xCBF2_9CE4_8422_2325
    for byte in np.array([*law["weights"].values(), law["bias"], *orders], "<f8").tobytes():
        found = (found ^ byte) * 0x100_0000_01B3 % 2**64
    assert found == int(expected, 16)


def test_branches_that_left_overlaps_beyond_the_tolerance_are_counted():
    def overlaps(training: BranchTraining) -> tuple[int, int, float]:
        while not training.has_ended:
            training.advance()
            training = BranchTraining.from_bytes(training.to_bytes())
        return training.overlaps

    tolerance_cm = tiny().parameters.tolerance_cm
    assert tiny().overlaps == (0, 0, 0.0)
    branches, deep, worst_cm = overlaps(tiny())
    assert (branches, deep) == (4, 0)
    assert 0.0 < worst_cm <= tolerance_cm
    # Boats that pass each other within the shortest substep stay entangled in some branches.
    speeds = {"speed_cm_s": 1e4, "reverse_speed_cm_s": 1e4, "dt_s": 1.0, "bw_s": 2.0}
    fast = training_flocks("narrow", n_boats=6, n_leaders=2, **speeds)
    short = {"branch_s": 4.0, "hold_s": 2.0, "trial_s": 2.0, "blind_s": 1.0, "episode_s": 8.0}
    branches, deep, worst_cm = overlaps(
        BranchTraining(fast, seed=0, pairs=2, flock_hours=0.006, **short)
    )
    assert branches == 4
    assert 0 < deep < 4
    assert worst_cm > tolerance_cm


def test_before_the_first_round_leans_are_those_of_the_tuned_law_and_rudders_are_zero():
    assert set(tiny().policy().weights.values()) == {0.0}
    law = tiny(action_mode="rudder").policy()
    assert law.gains == {}
    assert law.action_mode == "rudder"
    actions, _ = law.predict(np.ones((3, 29), np.float32))
    assert not actions.any()


def test_a_policy_steers_alone_as_from_its_observations():
    """The pilot in the core, and the environment that decides as in the training."""
    training = tiny(action_mode="rudder", step=1.0)
    training.advance()
    training.advance()
    law = training.policy()
    flocks = training.parameters.replace(target="ccw")
    recording = flockenv.simulate(flocks, 3, 20.0, policy=law)
    env = flockenv.LeadersVectorEnv(
        1,
        params=flocks,
        episode_s=20.0,
        observation=law.observation,
        mirror_to_target=True,
        decision_period_s=law.decision_period_s,
        autoreset_mode="disabled",
    )
    seen, _ = env.reset(seed=[3])
    ended = np.zeros(1, bool)
    while not ended.all():
        actions, _ = law.predict(seen)
        assert np.abs(actions).max() > 0.0
        seen, _, _, ended, _ = env.step(actions)
    assert np.array_equal(env._batch.flock(0).pose, recording.pose[-1])


def test_a_folder_is_resumed_and_other_results_are_refused(tmp_path: Path):
    policy = train(tiny(), tmp_path, "a command")
    assert load(tmp_path / POLICY).to_json() == policy.to_json()
    assert policy.provenance["command"] == "a command"
    more = stored_training(tmp_path, 0.1)
    assert not more.has_ended
    assert more.progress.total == pytest.approx(0.1066667)
    settings = tmp_path / "settings.toml"
    settings.write_text(settings.read_text().replace("results_version = ", "results_version = 9"))
    with pytest.raises(ParameterError, match=r"was trained in results version 9\d"):
        stored_training(tmp_path)


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (lambda state: state[:-1], "damaged or cut off"),
        (lambda state: b"", "too short"),
        (lambda state: b"flocken2" + state[8:], "of this kind"),
    ],
)
def test_a_harmed_checkpoint_is_refused(tmp_path: Path, harm, words):
    train(tiny(), tmp_path)
    path = tmp_path / CHECKPOINT
    path.write_bytes(harm(path.read_bytes()))
    with pytest.raises(ParameterError, match=words):
        stored_training(tmp_path)


def test_a_whole_number_may_be_a_float():
    assert tiny(seed=2.0).policy().to_json() == tiny(seed=2).policy().to_json()


def test_what_is_no_training_is_refused_by_its_name():
    for options, words in (
        ({"flock_hours": 0.0}, "flock_hours = 0"),
        ({"pair": 3}, "'pair' is not an option of the training"),
        ({"hold_s": 5.0}, "trial_s = 16"),
        ({"action_mode": "heading"}, "action_mode = heading"),
        ({"seed": -1}, "seed = -1"),
    ):
        with pytest.raises(FlockError, match=words):
            tiny(**options)
    with pytest.raises(FlockError, match="tuned only in the pools"):
        BranchTraining(training_flocks("narrow").replace(pool=(300.0, 0.0)))
    with pytest.raises(ParameterError, match="no checkpoint of branches"):
        stored_training(Path("nowhere"))


def test_all_are_compared_in_the_same_flocks(monkeypatch):
    """Leans of zero are the tuned law, so that its flocks and theirs are the same."""
    monkeypatch.setattr("flockenv.training.branches._EPISODE_S", 30.0)
    training = tiny()
    compared = compare_with_laws(training.policy(), training.parameters, 2)
    orders = {name: each["signed_order"] for name, each in compared.items()}
    assert list(orders) == ["paper's law", "tuned law", "trained"]
    assert np.array_equal(orders["trained"], orders["tuned law"])
    assert not np.array_equal(orders["trained"], orders["paper's law"])
