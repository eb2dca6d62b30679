"""Learned networks: w·tanh(W·x + b) + c clipped to [-1, 1], the same from NumPy as from torch.

On paper: a network without hidden layers whose weights are 0 steers by its bias.
"""

import itertools
import json

import numpy as np
import pytest

import flockenv
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.envs.observation import OBSERVATION_VERSION, observation_entries
from flockenv.envs.options import OPTIONS
from flockenv.envs.spaces import ObservationSpace
from flockenv.policies import NetworkPolicy, RandomRudders, StraightAhead, load

SIZE = len(observation_entries())
DEFAULTS = {name: each.default for name, each in OPTIONS.items()}


def network(hidden: int = 8, seed: int = 0, **kwargs) -> NetworkPolicy:
    random = np.random.default_rng(seed)
    sizes = [SIZE, hidden, hidden, 1]
    weights = [random.normal(0, 0.3, pair) for pair in itertools.pairwise(sizes)]
    return NetworkPolicy(weights, [random.normal(0, 0.1, n) for n in sizes[1:]], **kwargs)


def test_without_weights_the_bias_steers():
    policy = NetworkPolicy([np.zeros((SIZE, 1))], [[0.25]])
    rudders, state = policy.predict(np.ones((5, 3 * SIZE)), state="kept")
    assert rudders.dtype == np.float32
    assert state == "kept"
    np.testing.assert_array_equal(rudders, np.full((5, 3), 0.25, np.float32))
    beyond = NetworkPolicy([np.zeros((SIZE, 1))], [[-7.0]])
    assert beyond.predict(np.ones(SIZE))[0] == -1.0


def torch_network(activation, outputs=2):
    torch = pytest.importorskip("torch")
    torch.manual_seed(3)
    between = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}[activation]
    hidden = torch.nn.Sequential(torch.nn.Linear(SIZE, 9), between())
    return torch.nn.Sequential(
        hidden, torch.nn.Linear(9, 7), between(), torch.nn.Linear(7, outputs), torch.nn.Identity()
    )


@pytest.mark.parametrize(("activation", "squashed"), [("tanh", 0), ("tanh", 1), ("relu", 0)])
@pytest.mark.parametrize("outputs", [1, 2])
def test_a_torch_network_becomes_a_policy(activation, squashed, outputs, tmp_path):
    torch = pytest.importorskip("torch")
    module = torch_network(activation, outputs)
    options = {"observation": {}, "mirror_to_target": True, "action_mode": "lean"}
    space = ObservationSpace({**DEFAULTS, **options, "decision_period_s": 2.0})
    policy = NetworkPolicy.from_module(
        module, space, squashed=bool(squashed), has_spread=outputs == 2
    )
    policy.save(tmp_path / "policy.npz")
    loaded = load(tmp_path / "policy.npz")
    assert loaded.digest == policy.digest
    assert (loaded.mirror_to_target, loaded.action_mode) == (True, "lean")
    assert loaded.decision_period_s == 2.0
    rows = np.random.default_rng(1).uniform(-2, 2, (500, SIZE)).astype(np.float32)
    with torch.no_grad():
        mean = module(torch.from_numpy(rows))[:, 0]
        expected = (mean.tanh() if squashed else mean.clamp(-1, 1)).numpy()
    assert expected.std() > 0.02
    np.testing.assert_allclose(loaded.predict(rows)[0][:, 0], expected, atol=2e-6)


@pytest.mark.parametrize(
    ("layers", "options", "message"),
    [
        (lambda nn: [nn.Linear(SIZE, 4), nn.SiLU(), nn.Linear(4, 1)], {}, "SiLU"),
        (lambda nn: [nn.Linear(SIZE, 4), nn.ELU(0.5), nn.Linear(4, 1)], {}, "alpha = 0.5 of ELU"),
        (lambda nn: [nn.Linear(SIZE, 1), nn.GELU("tanh")], {}, "approximate = 'tanh' of GELU"),
        (
            lambda nn: [nn.Linear(SIZE, 4), nn.Linear(4, 1)],
            {},
            "linear layer with 1 outputs follows one with 4 and nothing stands between",
        ),
        (lambda nn: [nn.Linear(SIZE, 1), nn.Tanh(), nn.LayerNorm(1)], {}, "LayerNorm"),
        (lambda nn: [nn.Linear(SIZE, 1), nn.Tanh(), nn.Tanh()], {}, "Tanh"),
        (lambda nn: [nn.Linear(SIZE, 2)], {}, "2 outputs is not accepted: one, the rudder"),
        (lambda nn: [nn.Linear(SIZE, 1)], {"has_spread": True}, "1 outputs is not accepted with a"),
        (
            lambda nn: [nn.Linear(SIZE, 2), nn.Tanh()],
            {"has_spread": True},
            "2 outputs is not accepted with a spread: .* nothing after them",
        ),
        (lambda nn: [nn.Linear(SIZE, 4), nn.Tanh(), nn.Linear(3, 1)], {}, "do not fit each other"),
        (lambda nn: [nn.Linear(SIZE, 4, bias=False)], {}, "bias=False"),
        (lambda nn: [nn.Linear(SIZE, 4), nn.Tanh()], {}, r"layer 0 has weights \(67, 4\)"),
        (lambda nn: [], {}, r"Sequential\(\)"),
        (lambda nn: [nn.Identity()], {}, "no linear layer"),
        (lambda nn: [nn.Linear(SIZE, 3)], {}, r"layer 0 has weights \(67, 3\)"),
        (lambda nn: [nn.Linear(5, 1)], {}, r"layer 0 has weights \(5, 1\).*leader observes 67"),
        (
            lambda nn: [nn.Linear(SIZE, 1), nn.Tanh()],
            {"squashed": True},
            "squashed = True is not accepted: tanh follows",
        ),
    ],
)
def test_other_torch_networks_are_refused(layers, options, message):
    nn = pytest.importorskip("torch").nn
    module = nn.Sequential(*layers(nn))
    with pytest.raises(flockenv.ParameterError, match=message):
        NetworkPolicy.from_module(module, ObservationSpace(DEFAULTS), **options)


def test_weights_that_are_not_finite_are_named():
    torch = pytest.importorskip("torch")
    module = torch.nn.Sequential(torch.nn.Linear(SIZE, 4), torch.nn.ReLU(), torch.nn.Linear(4, 1))
    with torch.no_grad():
        module[0].weight[0, 0] = torch.nan
    with pytest.raises(flockenv.ParameterError, match="layer 0 holds numbers that are not finite"):
        NetworkPolicy.from_module(module, ObservationSpace(DEFAULTS))


NETWORKS = {
    "actor of TD3": lambda nn: [
        *(nn.Linear(SIZE, 9), nn.ReLU(), nn.Linear(9, 7), nn.ReLU()),
        *(nn.Linear(7, 1), nn.Tanh()),
    ],
    "ELU": lambda nn: [nn.Linear(SIZE, 9), nn.ELU(), nn.Linear(9, 1)],
    "GELU": lambda nn: [nn.Linear(SIZE, 9), nn.GELU(), nn.Linear(9, 1), nn.Tanh()],
    "LayerNorm": lambda nn: [
        *(nn.Linear(SIZE, 9), nn.LayerNorm(9), nn.ELU(), nn.Linear(9, 7), nn.LayerNorm(7)),
        *(nn.Linear(7, 1), nn.Identity()),
    ],
    "LayerNorm without weights": lambda nn: [
        *(nn.Linear(SIZE, 9), nn.LayerNorm(9, elementwise_affine=False), nn.Tanh()),
        *(nn.Dropout(0.5), nn.Linear(9, 1)),
    ],
}


@pytest.mark.parametrize("made", NETWORKS.values(), ids=NETWORKS)
def test_networks_of_other_learners_become_policies(made, tmp_path):
    """The same to 2e-6, also from the file, and for each row whatever the others are."""
    torch = pytest.importorskip("torch")
    torch.manual_seed(5)
    module = torch.nn.Sequential(*made(torch.nn))
    with torch.no_grad():
        for each in module.parameters():
            each.add_(0.2 * torch.randn_like(each))
    module[0].eval()
    of_double = NetworkPolicy.from_module(module.double(), ObservationSpace(DEFAULTS))
    policy = NetworkPolicy.from_module(module.float(), ObservationSpace(DEFAULTS))
    assert of_double.digest == policy.digest
    policy.save(tmp_path / "policy.npz")
    loaded = load(tmp_path / "policy.npz")
    modes = [part.training for part in module]
    assert [module.training, *modes] == [True, False, *[True] * (len(modes) - 1)], "as they were"
    rows = np.random.default_rng(1).uniform(-2, 2, (200, SIZE)).astype(np.float32)
    with torch.no_grad():
        expected = module.eval()(torch.from_numpy(rows)).clamp(-1, 1).numpy()
    assert expected.std() > 0.05
    actions = loaded.predict(rows)[0]
    np.testing.assert_allclose(actions, expected, atol=2e-6)
    assert actions.tolist() == [loaded.predict(each)[0].tolist() for each in rows]


def own_modules():
    """Modules with a forward of their own, and the words that refuse them; None: taken."""
    nn = pytest.importorskip("torch").nn
    functional = nn.functional

    class Two(nn.Module):
        def __init__(self):
            super().__init__()
            self.first, self.last = nn.Linear(SIZE, 4), nn.Linear(4, 1)

    class Functions(Two):
        def forward(self, rows):
            return self.last(functional.relu(self.first(rows)))

    class Doubles(nn.Module):
        def __init__(self):
            super().__init__()
            self.last = nn.Linear(SIZE, 1)

        def forward(self, rows):
            return 2.0 * self.last(rows)

    class TwoHeads(Doubles):
        def forward(self, rows):
            return self.last(rows), self.last(rows)

    class Registered(Two):
        def __init__(self):
            super().__init__()
            self.between = nn.Tanh()

        def forward(self, rows):
            return self.last(self.between(self.first(rows)))

    class Plain(Doubles):
        def forward(self, rows):
            return self.last(rows)

    class Squeezed(Doubles):
        def forward(self, rows):
            return self.last(rows).squeeze(-1)

    class OwnSpread(Doubles):
        def forward(self, rows):
            return self.last(rows), self.last.bias.exp()

    class TakesByName(Doubles):
        def forward(self, rows):
            return self.last(rows.leaders)

    class TakesTwo(Doubles):
        def forward(self, rows, state):
            return self.last(rows)

    class SharesTanh(nn.Module):
        def __init__(self):
            super().__init__()
            tanh = nn.Tanh()
            layers = nn.Linear(SIZE, 4), tanh, nn.Linear(4, 4), tanh, nn.Linear(4, 1)
            self.layers = nn.Sequential(*layers)
            self.last = self.layers[-1]

        def forward(self, rows):
            return self.layers(rows)

    return [
        (Functions, "activations that forward calls as functions are not seen"),
        (Doubles, "computes something else than its 1 linear layers"),
        (TwoHeads, "computes something else than its 1 linear layers"),
        (Registered, "nothing stands between them"),
        (Squeezed, "computes something else than its 1 linear layers"),
        (OwnSpread, "computes something else than its 1 linear layers"),
        (TakesByName, "cannot be run on observations: AttributeError"),
        (TakesTwo, "cannot be run on observations: TypeError"),
        (SharesTanh, None),
        (Plain, None),
    ]


def test_a_module_of_ones_own_is_what_it_computes():
    for made, words in own_modules():
        if words is None:
            NetworkPolicy.from_module(made(), ObservationSpace(DEFAULTS))
            continue
        with pytest.raises(flockenv.ParameterError, match=words):
            NetworkPolicy.from_module(made(), ObservationSpace(DEFAULTS))


def test_a_torch_network_of_all_leaders_at_once_is_refused():
    torch = pytest.importorskip("torch")
    two = flockenv.LeadersVectorEnv(1, n_leaders=2).single_observation_space
    assert NetworkPolicy.from_module(torch.nn.Linear(SIZE, 1), two).weights[0].shape == (SIZE, 1)
    layers = torch.nn.Linear(2 * SIZE, 3), torch.nn.Tanh(), torch.nn.Linear(3, 3)
    with pytest.raises(flockenv.ParameterError, match=rf"layer 0 has weights \({2 * SIZE}, 3\)"):
        NetworkPolicy.from_module(torch.nn.Sequential(*layers), two)
    two.options["new_option"] = 3
    words = "'new_option' is not an option that a policy"
    with pytest.raises(flockenv.ParameterError, match=words):
        NetworkPolicy.from_module(torch.nn.Linear(SIZE, 1), two)
    with pytest.raises(flockenv.ParameterError, match="space = Box"):
        NetworkPolicy.from_module(torch.nn.Linear(SIZE, 1), type(two).__mro__[1](-1, 1, (SIZE,)))


@pytest.mark.parametrize("policy", [network(), StraightAhead(), RandomRudders(3)])
def test_every_form_of_observation(policy):
    for shape, rudders in [((SIZE,), (1,)), ((3 * SIZE,), (3,)), ((4, 2 * SIZE), (4, 2))]:
        actions, _ = policy.predict(np.zeros(shape, np.float32))
        assert actions.shape == rudders
        assert actions.dtype == np.float32
        assert (np.abs(actions) <= 1).all()
    actions, _ = policy.predict({"leader_0": np.zeros(SIZE), "leader_1": np.zeros(SIZE)})
    shapes = {name: each.shape for name, each in actions.items()}
    assert shapes == {"leader_0": (1,), "leader_1": (1,)}
    with pytest.raises(flockenv.ParameterError, match=f"multiple of {SIZE}, "):
        policy.predict(np.zeros(SIZE + 1))


def test_a_leader_does_as_it_would_alone():
    seen = np.random.default_rng(5).standard_normal((200, SIZE)).astype(np.float32)
    policy = network()
    assert policy.predict(seen)[0].tolist() == [policy.predict(each)[0].tolist() for each in seen]


def test_a_file_keeps_every_bit(tmp_path):
    policy = network(
        mirror_to_target=True, activation="relu", provenance={"command": "train", "seed": "1"}
    )
    policy.save(tmp_path / "policy.npz")
    again = load(tmp_path / "policy.npz")
    observations = np.random.default_rng(2).uniform(-1, 1, (50, SIZE))
    np.testing.assert_array_equal(again.predict(observations)[0], policy.predict(observations)[0])
    assert again.mirror_to_target
    assert again.provenance == {"command": "train", "seed": "1"}
    assert again.activations == ["relu", "relu", "identity"]


def test_a_file_holds_an_observation_of_numbers_of_numpy(tmp_path):
    observation = {"neighbors": np.int64(2), "order": np.bool_(False)}
    size = len(observation_entries(observation))
    policy = NetworkPolicy([np.zeros((size, 1))], [[0.5]], observation=observation)
    policy.save(tmp_path / "policy.npz")
    assert load(tmp_path / "policy.npz").observation == {"neighbors": 2, "order": False}
    assert flockenv.policies.policy(policy).name.endswith(policy.digest)


def changed(policy, tmp_path, **entries):
    """The policy's file with other entries in its header, or other arrays."""
    policy.save(tmp_path / "policy.npz")
    arrays = read_arrays(tmp_path / "policy.npz")
    header = json.loads(str(arrays["header"]))
    for name, value in entries.items():
        if name in header or isinstance(value, str):
            header[name] = value
        else:
            arrays[name] = value
    arrays["header"] = np.array(json.dumps(header))
    write_arrays(tmp_path / "changed.npz", arrays)
    return tmp_path / "changed.npz"


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"observation_version": OBSERVATION_VERSION + 1}, "version .* of the observation"),
        ({"observation_version": str(OBSERVATION_VERSION)}, "version '1' of the observation"),
        ({"format": "something else"}, "format = 'something else'"),
        ({"weight_1": np.zeros((8, 3))}, "layer 1 has weights"),
        ({"other": np.zeros(3), "another": np.zeros(3)}, "'other' is not an array of a network"),
        ({"pools": "wide"}, "'pools' is not an entry of a network's header"),
        ({"activations": ["exec", "tanh", "tanh"]}, "'exec' is not an activation"),
        ({"activations": [["tanh"]] * 3}, r"\['tanh'\] is not an activation"),
        ({"activations": "tanh"}, "activations must be a sequence"),
        (
            {"activations": ["tanh"]},
            "'(bias|weight)_1' is not an array of a network",
        ),
        ({"norms": [1.0, None, None]}, "it has no 'scale_0'"),
        ({"norms": [None]}, "not a complete policy"),
        ({"norms": 3}, "not a complete policy"),
        ({"observation": {"neighbor": 3}}, "neighbor"),
        ({"observation": {"neighbors": 3}}, "layer 0"),
        ({"observation": 3}, "observation = 3 is not accepted: blocks by name"),
        ({"made": 3}, "not a complete policy"),
        ({"decision_period_s": True}, "decision_period_s"),
        ({"decision_period_s": "2"}, "decision_period_s"),
        ({"decision_period_s": -2.0}, "decision_period_s = -2.0 is not accepted: a time in s"),
        ({"mirror_to_target": "no"}, "mirror_to_target = 'no' is not accepted: True or False"),
        ({"weight_0": np.full((SIZE, 8), np.nan)}, "not finite"),
        ({"weight_0": np.full((SIZE, 8), 1e300)}, "not finite"),
        ({"weight_0": np.full((SIZE, 8), "fw")}, "layer 0 is not accepted: real numbers"),
        ({"bias_0": np.zeros(9)}, "layer 0"),
    ],
)
def test_files_that_are_no_policy_are_named(tmp_path, entries, message):
    path = changed(network(), tmp_path, **entries)
    with pytest.raises(flockenv.ParameterError, match=message) as raised:
        load(path)
    assert str(raised.value).startswith(str(path))


def test_an_option_that_a_file_lacks_has_its_default(tmp_path):
    policy = network()
    policy.save(tmp_path / "policy.npz")
    arrays = read_arrays(tmp_path / "policy.npz")
    whole = json.loads(str(arrays["header"]))
    for name, reads in (("decision_period_s", True), ("activations", False), ("made", False)):
        header = {each: value for each, value in whole.items() if each != name}
        write_arrays(tmp_path / "less.npz", {**arrays, "header": np.array(json.dumps(header))})
        if reads:
            assert load(tmp_path / "less.npz").digest == policy.digest
        else:
            with pytest.raises(flockenv.ParameterError, match=f"it has no '{name}'"):
                load(tmp_path / "less.npz")


def test_damaged_and_foreign_files(tmp_path):
    (tmp_path / "damaged.npz").write_bytes(b"PK" + bytes(1000))
    with pytest.raises(flockenv.ParameterError, match=r"damaged\.npz"):
        load(tmp_path / "damaged.npz")
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "nowhere.npz")
    flockenv.simulate(flockenv.FlockParameters(), 1, 1.0).save(tmp_path / "run.npz")
    with pytest.raises(flockenv.ParameterError, match=r"run\.npz is not a .*: it has no 'header'"):
        load(tmp_path / "run.npz")


@pytest.mark.parametrize(("place", "byte"), [(6, 109), (9, 8)])
def test_damage_in_the_directory_of_an_archive_is_named(tmp_path, place, byte):
    """A version of the format that there is not, or names in UTF-8 that are none."""
    path = tmp_path / "damaged.npz"
    policy = NetworkPolicy([np.zeros((SIZE, 1))], [[0.0]])
    policy.save(path)
    content = bytearray(path.read_bytes())
    entry = content.index(b"PK\1\2")
    content[entry + place] = byte
    content[entry + 46] = 0xFF
    path.write_bytes(content)
    with pytest.raises(flockenv.ParameterError, match=r"damaged\.npz"):
        load(path)


def test_a_file_that_inflates_is_refused_unread(tmp_path, monkeypatch):
    network().save(tmp_path / "policy.npz")
    monkeypatch.setattr("flockenv.policies.network._LARGEST_FILE", 1000)
    monkeypatch.setattr("zipfile.ZipFile.read", lambda *_: pytest.fail("read"))
    with pytest.raises(flockenv.ParameterError, match="bytes of 1000 that are accepted"):
        load(tmp_path / "policy.npz")
