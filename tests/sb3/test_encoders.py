"""Law: an encoder trains in anybody's PPO, and is then the same without torch."""

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO

from flockenv import ParameterError
from flockenv.policies import load
from flockenv.sb3 import (
    FlockCriticPolicy,
    LeaderVecEnv,
    LeaningExtractor,
    NeighborSetExtractor,
    WithFlockFeatures,
    usual_features,
)

OPTIONS = {"n_boats": 8, "n_leaders": 2, "episode_s": 2.0, "mirror_to_target": True}


def encoded(extractor, observations):
    with torch.no_grad():
        return extractor(torch.as_tensor(observations)).numpy()


@pytest.mark.parametrize("extractor", [NeighborSetExtractor, LeaningExtractor])
@pytest.mark.parametrize("flock_critic", [False])
def test_ppo_learns_with_an_encoder(extractor, flock_critic, tmp_path):
    venv = LeaderVecEnv(2, **OPTIONS)
    venv = WithFlockFeatures(venv) if flock_critic else venv
    seen = venv.policy_kwargs if flock_critic else {}
    model = PPO(
        FlockCriticPolicy if flock_critic else "MlpPolicy",
        venv,
        n_steps=8,
        batch_size=32,
        seed=0,
        device="cpu",
        policy_kwargs={**seen, "net_arch": [8], "features_extractor_class": extractor},
    )
    actor = model.policy.mlp_extractor if flock_critic else model.policy
    encoder = actor.encoder if flock_critic else actor.features_extractor
    before = [each.clone() for each in encoder.parameters()]
    model.learn(64)
    assert all(not torch.equal(a, b) for a, b in zip(before, encoder.parameters(), strict=True))
    size = LeaderVecEnv(2, **OPTIONS).observation_space.shape[0]
    observations = venv.reset()[:, :size]
    np.testing.assert_allclose(
        encoder.encoder()(observations), encoded(encoder, observations), atol=1e-5
    )
    model.save(tmp_path / "model.zip")
    stored = load(tmp_path / "model.zip", trust=True)
    np.testing.assert_array_equal(
        stored.predict(observations)[0], model.predict(observations, deterministic=True)[0]
    )


def test_usual_features_are_standardized():
    options = {**OPTIONS, "action_mode": "lean", "episode_s": 300.0, "control_hz": 2.0}
    venv = LeaderVecEnv(4, **options, physics="training")
    venv.seed(5)
    usual = usual_features(venv)
    extractor = LeaningExtractor(venv.observation_space, **usual)
    # Other flocks under the same law.
    venv.seed(50)
    observations, found = venv.reset(), []
    for step in range(520):
        observations, *_ = venv.step(np.zeros((8, 1)))
        if step > 40:
            found.append(encoded(extractor, observations))
    found = np.concatenate(found)
    assert abs(found.mean(axis=0)).max() < 1.0
    assert np.median(found.std(axis=0)) == pytest.approx(1.0, abs=0.25)
    venv.seed(5)
    assert usual_features(venv) == usual


def test_what_is_refused():
    space = LeaderVecEnv(1, **OPTIONS).observation_space
    unmirrored = LeaderVecEnv(1, n_boats=8, n_leaders=1).observation_space
    lonely = LeaderVecEnv(1, **OPTIONS, observation={"neighbors": 0}).observation_space
    for make, words in (
        (lambda: NeighborSetExtractor(lonely), "needs the block neighbors"),
        (lambda: LeaningExtractor(lonely), "needs the blocks own, neighbors and order"),
        (lambda: LeaningExtractor(unmirrored), "without mirror_to_target"),
        (lambda: NeighborSetExtractor(space, layers=()), "no layers"),
        (lambda: NeighborSetExtractor(space, activation="gelu"), "activation = 'gelu'"),
        (
            lambda: NeighborSetExtractor(
                WithFlockFeatures(LeaderVecEnv(1, **OPTIONS)).observation_space
            ),
            "features of a flock",
        ),
        (lambda: NeighborSetExtractor(torch.nn.Identity()), "that of a LeaderVecEnv"),
        (lambda: usual_features(LeaderVecEnv(1, **OPTIONS)), "action_mode = 'rudder'"),
        (
            lambda: NeighborSetExtractor(space).copy_from(LeaningExtractor(space).encoder()),
            "an encoder with layers",
        ),
        (
            lambda: LeaningExtractor(space).copy_from(NeighborSetExtractor(space).encoder()),
            "not accepted: the features radial_position",
        ),
    ):
        with pytest.raises(ParameterError, match=words):
            make()
