"""Law: an encoder reads what leaders observe, whatever the order and the number of neighbors."""

import numpy as np
import pytest

from flockenv import ParameterError
from flockenv.envs.observation import neighbor_places, observation_entries, observation_space
from flockenv.policies import NetworkPolicy, load
from flockenv.policies.encoders import LeaningEncoder, NeighborSetEncoder
from flockenv.policies.lean_features import features, observed_features

NAMES = [entry.name for entry in observation_entries()]
SIZE = len(NAMES)
FEATURES = observed_features(NAMES)
COUNT = len(FEATURES)
USUAL = LeaningEncoder(np.zeros(COUNT), np.ones(COUNT))


def rows(count: int = 50) -> np.ndarray:
    space = observation_space({})
    share = np.random.default_rng(0).random((count, SIZE), np.float32)
    found = space.low + share * (space.high - space.low)
    found[:, neighbor_places()[:, 0]] = np.random.default_rng(1).integers(0, 2, (count, 6))
    return found


def deep_set(**options) -> NeighborSetEncoder:
    random = np.random.default_rng(2)
    weights = [random.normal(size=(8, 5)), random.normal(size=(5, 4))]
    return NeighborSetEncoder(weights, [np.ones(5), np.zeros(4)], **options)


def test_each_neighbor_has_its_eight_numbers():
    places = neighbor_places()
    assert places.shape == (6, 8)
    assert {tuple(NAMES[place] for place in row) for row in places} == {
        tuple(NAMES[place] for place in places[0])
    }
    assert [NAMES[row[0]] for row in places] == ["present"] * 6
    assert neighbor_places({"neighbors": 0}).shape == (0, 0)


def test_one_neighbor_by_hand():
    # An identity embedding: what is left is the neighbor's own numbers over the six places.
    encoder = NeighborSetEncoder([np.eye(8)], [np.zeros(8)], "relu")
    row = np.zeros((1, SIZE), np.float32)
    second = neighbor_places()[1]
    row[0, second] = [1.0, 0.5, 0.25, 0.0, 1.0, 0.75, 0.0, 1.0]
    row[0, neighbor_places()[2]] = [0.0, *np.ones(7)]  # not there, whatever the rest says
    row[0, 0] = 0.3
    encoded = encoder(row)
    assert encoded.shape == (1, encoder.size) == (1, SIZE - 6 * 8 + 8)
    np.testing.assert_allclose(encoded[0, -8:], row[0, second] / 6, rtol=1e-6)
    assert encoded[0, 0] == np.float32(0.3)


def test_the_order_of_neighbors_does_not_matter():
    encoder, seen = deep_set(), rows()
    mixed = seen.copy()
    places = neighbor_places()
    mixed[:, places] = seen[:, places[[3, 0, 5, 1, 4, 2]]]
    np.testing.assert_allclose(encoder(mixed), encoder(seen), atol=1e-6)
    missing = seen.copy()
    missing[:, places[:, 0]] = 0.0
    assert abs(encoder(missing) - encoder(seen)).max() > 0.01


def test_standardized_features():
    encoder = LeaningEncoder(np.full(COUNT, 0.1), np.full(COUNT, 0.25))
    expected = np.clip((features(rows(), NAMES, FEATURES) - 0.1) / 0.25, -5.0, 5.0)
    np.testing.assert_allclose(encoder(rows()), expected, atol=1e-5)
    assert abs(encoder(rows())).max() == 5.0


def test_a_linear_network_of_features_leans_as_a_leaning_law():
    random = np.random.default_rng(3)
    mean, deviation = random.normal(size=COUNT) * 0.1, random.uniform(1.0, 2.0, COUNT)
    weights = random.normal(size=COUNT) * 0.05
    encoder = LeaningEncoder(mean, deviation)
    network = NetworkPolicy(
        [(weights * deviation)[:, None] / 1.2],
        [[0.2 + weights @ mean / 1.2]],
        mirror_to_target=True,
        action_mode="lean",
        encoder=encoder,
        squashed=True,
    )
    lean = 1.2 * np.tanh((0.24 + features(rows(), NAMES, FEATURES) @ weights) / 1.2)
    np.testing.assert_allclose(1.2 * network.predict(rows())[0][:, 0], lean, atol=1e-4)


@pytest.mark.parametrize(
    "encoder",
    [deep_set(), deep_set(activation="relu"), USUAL],
    ids=["deepsets", "relu", "leaning"],
)
def test_files(encoder, tmp_path):
    weights = np.random.default_rng(4).normal(size=(encoder.size, 1))
    policy = NetworkPolicy([weights], [[0.1]], mirror_to_target=True, encoder=encoder)
    policy.save(tmp_path / "policy.npz")
    stored = load(tmp_path / "policy.npz")
    np.testing.assert_array_equal(stored.predict(rows())[0], policy.predict(rows())[0])
    assert stored.digest == policy.digest
    assert repr(stored) == repr(policy)
    assert encoder.kind in repr(policy)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: deep_set(observation={"neighbors": 0}), "needs the block neighbors"),
        (lambda: deep_set(activation="gelu"), "activation = 'gelu'"),
        (lambda: NeighborSetEncoder([np.ones((7, 2))], [np.ones(2)]), "encoder's layer 0 has"),
        (lambda: NeighborSetEncoder([], []), "one of each a layer"),
        (lambda: NeighborSetEncoder([np.full((8, 2), np.nan)], [np.ones(2)]), "not finite"),
        (lambda: LeaningEncoder(np.zeros(3), np.ones(3)), "mean is not accepted: \\d+ finite"),
        (lambda: LeaningEncoder(np.zeros(COUNT), np.zeros(COUNT)), "positive"),
        (
            lambda: LeaningEncoder(np.zeros(COUNT), np.ones(COUNT), observation={"order": False}),
            "needs the blocks own, neighbors and order",
        ),
        (
            lambda: NetworkPolicy(
                [np.ones((COUNT, 1))],
                [[0.0]],
                encoder=USUAL,
            ),
            "without mirror_to_target",
        ),
        (
            lambda: NetworkPolicy([np.ones((SIZE, 1))], [[0.0]], encoder=deep_set()),
            "layer 0 has weights",
        ),
        (
            lambda: NetworkPolicy(
                [np.ones((deep_set().size, 1))],
                [[0.0]],
                encoder=deep_set(),
                observation={"neighbors": 3},
            ),
            f"it reads another layout, of {SIZE} numbers",
        ),
        (
            lambda: NetworkPolicy(
                [np.ones((COUNT, 1))],
                [[0.0]],
                encoder=USUAL,
                observation={"fellow_leaders": 2},
                mirror_to_target=True,
            ),
            "it reads another layout",
        ),
        (
            lambda: NetworkPolicy([np.ones((SIZE, 1))], [[0.0]], encoder="deepsets"),
            "encoder = 'deepsets' is not accepted: an Encoder",
        ),
        (
            lambda: NeighborSetEncoder([["many"]], [[0.0]]),
            "weights of the encoder's layer 0 = .* is not accepted: numbers",
        ),
        (lambda: LeaningEncoder(np.full(COUNT, 1e300), np.ones(COUNT)), "finite numbers"),
        (lambda: LeaningEncoder("many", np.ones(COUNT)), "mean = 'many' is not accepted: numbers"),
        (lambda: LeaningEncoder([], [], features=[]), "at least one, none of them twice"),
        (lambda: LeaningEncoder([0, 0], [1, 1], features=["near"] * 2), "none of them twice"),
    ],
)
def test_nonsense_is_refused(make, words):
    with pytest.raises(ParameterError, match=words):
        make()


def test_a_file_of_an_unknown_encoder_is_refused(tmp_path, monkeypatch):
    policy = NetworkPolicy([np.ones((deep_set().size, 1))], [[0.0]], encoder=deep_set())
    monkeypatch.setattr(NeighborSetEncoder, "kind", "attention")
    policy.save(tmp_path / "policy.npz")
    with pytest.raises(ParameterError, match="encoder = 'attention' is not accepted: one of"):
        load(tmp_path / "policy.npz")
