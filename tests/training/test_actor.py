"""The actor of a training: what it starts as, how it explores, and the policy stored of it."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import flockenv
from flockenv import ParameterError, training
from flockenv._io.array_file import read_arrays
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy, load
from flockenv.training import TrainingSettings
from flockenv.training.actor import (
    actor_module,
    copy_into_actor,
    measure_features,
    network_policy,
)
from flockenv.training.learner import learner


def test_leaders_of_a_flock_explore_with_one_noise_in_every_pool(tiny: TrainingSettings) -> None:
    settings = tiny.replace(pools=["wide", "narrow"], shared_noise_s=1.5)
    model = learner(settings)
    rows = torch.as_tensor(model.env.reset())
    noises = []
    for _ in range(6):
        with torch.no_grad():
            actions, _, _ = model.policy.forward(rows)
            normal = model.policy.get_distribution(rows).distribution
        noises.append(((actions - normal.mean) / normal.stddev)[:, 0])
    flock = torch.as_tensor(model.env.flock_of_slot)
    assert flock.tolist() == sorted(flock.tolist())
    assert flock.max() == 2 * settings.num_flocks - 1
    for noise in noises:
        different = (noise[:, None] - noise[None, :]).abs() > 1e-4
        assert torch.equal(different, flock[:, None] != flock[None, :])
    # 1.5 s are three decisions.
    same = [torch.allclose(one, other, atol=1e-4) for one, other in pairwise(noises)]
    assert same == [True, True, False, True, True]


@pytest.mark.parametrize(
    "changes",
    [
        {"net_arch": [], "activation": "tanh"},
        {"net_arch": [16], "activation": "relu"},
        {"net_arch": [32, 16]},
        {"net_arch": [32, 16], "critic": "flock"},
        {"squash": True},
        {"encoder": "deepsets"},
        {"encoder": "deepsets", "critic": "flock", "activation": "relu", "encoder_arch": [16]},
        {"encoder": "deepsets", "observation": {"neighbors": 3, "law_rudder": True}},
        {"encoder": "leaning", "net_arch": []},
        {"encoder": "leaning", "critic": "flock", "squash": True},
        {"encoder": "leaning", "observation": {"fellow_leaders": 2, "phase": False}},
    ],
    ids=lambda changes: " ".join(f"{name}={value}" for name, value in changes.items()),
)
def test_the_exported_mean_is_torchs(
    tiny: TrainingSettings, changes: dict[str, Any], tmp_path: Path
) -> None:
    settings = tiny.replace(**changes)
    model = learner(settings)
    measure_features(actor_module(model.policy)[0], settings)
    low, high = model.observation_space.low, model.observation_space.high
    rows = low + np.random.default_rng(0).random((500, len(low)), np.float32) * (high - low)
    with torch.no_grad():
        # Larger than SB3 starts with, so that the ends of the range are met, but no larger: single
        # precision rounds in proportion, and processors add up in different orders.
        means = model.policy.get_distribution(torch.as_tensor(rows)).distribution.mean
        largest = 5.0 if settings.squash else 2.0
        model.policy.action_net.weight.mul_(largest / means.abs().max())
    network_policy(model.policy, settings, {}).save(tmp_path / "policy.npz")
    policy = load(tmp_path / "policy.npz")
    expected, _ = model.predict(rows, deterministic=True)
    if settings.squash:
        expected = np.tanh(expected)
    rows = rows[:, : model.env.seen]
    assert (abs(expected) > 0.999).any()
    assert (abs(expected) < 0.9).any()
    np.testing.assert_allclose(policy.predict(rows)[0], expected, atol=2e-6, rtol=0)


def test_start_from_a_policy(tiny: TrainingSettings, tmp_path: Path) -> None:
    start = training.train(tiny.replace(samples=192, seed=3), tmp_path / "start").policy
    path = str(tmp_path / "start" / "best.npz")
    model = learner(tiny)
    copy_into_actor(start, model.policy, tiny)
    copied = network_policy(model.policy, tiny, {})
    for own, other in zip(
        copied.weights + copied.biases, start.weights + start.biases, strict=True
    ):
        np.testing.assert_array_equal(own, other)
    unchanging = tiny.replace(samples=192, start=path, learning_rate=0.0, final_learning_rate=0.0)
    untrained = training.train(unchanging, tmp_path / "still").policy
    for own, other in zip(untrained.weights, start.weights, strict=True):
        np.testing.assert_array_equal(own, other)


@pytest.mark.parametrize(
    "changes",
    [{"encoder": "deepsets"}, {"encoder": "leaning", "net_arch": [], "squash": True}],
    ids=lambda changes: changes["encoder"],
)
def test_start_from_an_encoded_policy(
    tiny: TrainingSettings, tmp_path: Path, changes: dict[str, Any]
) -> None:
    settings = tiny.replace(samples=192, **changes)
    start = training.train(settings.replace(seed=3), tmp_path / "start").policy
    unchanging = settings.replace(
        start=str(tmp_path / "start" / "best.npz"),
        learning_rate=0.0,
        final_learning_rate=0.0,
        average=0.5,
    )
    assert training.train(unchanging, tmp_path / "unchanging").policy.digest == start.digest
    with pytest.raises(ParameterError, match=r"encoder = 'none' is not accepted: .* has '(de|le)"):
        training.train(unchanging.replace(encoder="none", squash=False), tmp_path / "none")


def test_an_untrained_lean_is_nearly_the_tuned_law(tiny: TrainingSettings) -> None:
    for encoder in ("none", "deepsets", "leaning"):
        settings = tiny.replace(encoder=encoder, options={"action_mode": "lean"})
        model = learner(settings)
        measure_features(actor_module(model.policy)[0], settings)
        policy = network_policy(model.policy, settings, {})
        # Of 1, which is 1.2 rad.
        assert 0.0 < abs(policy.predict(model.env.reset())[0]).max() < 0.05


def test_an_exploration_that_is_not_learned_stays(tiny: TrainingSettings, tmp_path: Path) -> None:
    for learned in (True, False):
        folder = tmp_path / str(learned)
        training.train(tiny.replace(samples=192, learn_log_std=learned), folder)
        arrays = read_arrays(folder / "checkpoint.npz")
        assert (arrays["parameter:log_std"] == np.float32(tiny.log_std_init)).all() != learned


def test_a_start_that_does_not_fit_is_refused(tiny: TrainingSettings, tmp_path: Path) -> None:
    size = len(observation_entries())
    path = tmp_path / "linear.npz"
    NetworkPolicy([np.zeros((size, 1))], [[0.0]], mirror_to_target=True).save(path)
    with pytest.raises(flockenv.ParameterError, match="net_arch"):
        training.train(tiny.replace(start=str(path)), tmp_path / "run")
    NetworkPolicy([np.zeros((size, 1))], [[0.0]]).save(path)
    with pytest.raises(flockenv.ParameterError, match="mirror_to_target"):
        training.train(tiny.replace(start=str(path), net_arch=[]), tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_start_of_another_observation_version_is_refused(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    size = len(observation_entries())
    path = tmp_path / "old.npz"
    monkeypatch.setattr("flockenv.policies.files.observation_version", lambda blocks: 0)
    NetworkPolicy([np.zeros((size, 1))], [[0.0]], mirror_to_target=True).save(path)
    monkeypatch.undo()
    with pytest.raises(flockenv.ParameterError, match="version 0 of the observation"):
        training.train(tiny.replace(start=str(path)), tmp_path / "run")
    assert not (tmp_path / "run").exists()
