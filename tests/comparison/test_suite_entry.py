"""Law: an entry that cannot be scored is refused with its name, before anything is written."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import tomli_w

from flockenv.comparison.levels import LEVEL_IDS, LEVELS
from flockenv.comparison.suite_entry import SuiteEntry, ranked, scored
from flockenv.envs.observation import observation_entries
from flockenv.errors import ParameterError
from flockenv.policies import NetworkPolicy, WrappedPolicy

LEVEL = "order-easy"
LAYOUT = {"observation": LEVELS[LEVEL].observation, "mirror_to_target": True}
SIZE = len(observation_entries(LAYOUT["observation"]))


def network(path: Path, rudder: float = 0.0, **made: str) -> str:
    NetworkPolicy([np.zeros((SIZE, 1))], [[rudder]], **LAYOUT, provenance=made).save(path)
    return path.name


@pytest.fixture
def entered(tmp_path: Path):
    """Write an entry with some changes, and return its file."""

    def write(**changes: object) -> Path:
        values: dict[str, object] = {
            "suite": "v3",
            "name": "mine",
            "class": "by hand",
            "link": "https://example.org/mine",
            "flock_hours": 30.0,
            "training_seeds": [2**32, 2**32 + 5],
            "levels": {LEVEL: [network(tmp_path / "a.npz", cpu_s="3")]},
        }
        kept = {name: value for name, value in {**values, **changes}.items() if value is not None}
        (tmp_path / "mine.toml").write_text(tomli_w.dumps(kept), "utf-8")
        return tmp_path / "mine.toml"

    return write


class Wrong:
    """Steers straight ahead, and does something else from the fifth decision on."""

    observation, mirror_to_target = LAYOUT["observation"], True

    def __init__(self, kind: str) -> None:
        self.kind, self.decisions = kind, 0

    def predict(self, observation, state=None):
        rudders = np.zeros(observation.size // SIZE)
        self.decisions += 1
        if self.decisions >= 5:
            if self.kind == "raises":
                raise KeyError("my own mistake")
            if self.kind == "nan":
                rudders[0] = np.nan
            if self.kind == "shape":
                rudders = rudders[:-1]
        return rudders, state


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"suite": "v2"}, "suite = 'v2' is not accepted"),
        (
            {"levels": {"order-esy": ["a.npz"]}},
            "'order-esy' is not a level of suite v3: did you mean",
        ),
        ({"levels": {}}, "not a table of levels"),
        ({"levels": {LEVEL: []}}, "order-easy = [] is not accepted"),
        ({"levels": {LEVEL: ["a.npz", "a.npz"]}}, "names a policy twice"),
        ({"levels": {LEVEL: ["b.npz"]}}, "b.npz cannot be read"),
        ({"levels": {LEVEL: ["module:Class"]}}, "--trust"),
        ({"training_seeds": [5, 2**32]}, "seeds below 2^32 are for evaluation"),
        ({"training_seeds": [2**32]}, "training_seeds = [4294967296] is not accepted"),
        ({"training_seeds": [2**33, 2**32]}, "the first seed is above the last"),
        ({"flock_hours": -1.0}, "flock_hours = -1.0 is not accepted"),
        ({"flock_hours": float("nan")}, "flock_hours = nan is not accepted"),
        ({"flock_hours": None}, "flock_hours is missing"),
        ({"name": ""}, "name = '' is not accepted"),
        ({"clas": "x"}, "'clas' is not a key of an entry: did you mean 'class'?"),
    ],
)
def test_what_is_no_entry_is_refused_by_name(entered, changes, words) -> None:
    with pytest.raises(ParameterError) as error:
        SuiteEntry.from_file(entered(**changes))
    assert words in str(error.value)
    assert "mine.toml: " in str(error.value)


def test_what_a_policy_says_of_its_training_counts(entered, tmp_path: Path) -> None:
    for made, words in (
        ({"training_seeds": "77-4294967300"}, "training_seeds of b.npz"),
        ({"training_seeds": "all"}, "not FIRST-LAST"),
        ({"cpu_s": "2 minutes"}, "b.npz says cpu_s = '2 minutes', not a number of seconds"),
    ):
        network(tmp_path / "b.npz", **made)
        with pytest.raises(ParameterError) as error:
            SuiteEntry.from_file(entered(levels={LEVEL: ["b.npz"]}))
        assert words in str(error.value)


def test_a_policy_of_any_results_version_may_enter(entered, tmp_path: Path) -> None:
    """Whoever scores it names the version of the row."""
    name = network(tmp_path / "b.npz", results_version="5")
    entry = SuiteEntry.from_file(entered(levels={LEVEL: [name]}))
    assert entry.trainings[LEVEL][0].provenance["results_version"] == "5"


def test_weights_that_are_not_finite_are_refused(entered, tmp_path: Path) -> None:
    name = network(tmp_path / "b.npz")
    with np.load(tmp_path / name) as file:
        arrays = dict(file)
    arrays["bias_0"] = np.array([np.inf], np.float32)
    np.savez(tmp_path / name, **arrays)
    with pytest.raises(ParameterError, match="not finite"):
        SuiteEntry.from_file(entered(levels={LEVEL: [name]}))


def test_a_model_whose_weights_are_not_finite_is_refused(entered, tmp_path: Path) -> None:
    torch = pytest.importorskip("torch")
    baselines3 = pytest.importorskip("stable_baselines3")
    from flockenv.sb3 import LeaderVecEnv

    model = baselines3.PPO("MlpPolicy", LeaderVecEnv(1, n_boats=3, n_leaders=1, pool="narrow"))
    with torch.no_grad():
        model.policy.action_net.bias[0] = torch.nan
    model.save(tmp_path / "b.zip")
    with pytest.raises(ParameterError, match=r"b\.zip holds weights that are not finite"):
        SuiteEntry.from_file(entered(levels={LEVEL: ["b.zip"]}), trust=True)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("shape", "what a policy returns has shape (7,), expected a rudder for each of 8 leaders"),
        ("nan", "action = NaN is not accepted"),
        ("raises", "KeyError: 'my own mistake'"),
    ],
)
def test_a_policy_that_breaks_on_the_way_is_named(
    entered, kind, words, tmp_path: Path, monkeypatch
) -> None:
    (tmp_path / "mine.py").write_text(
        f"from {__name__} import Wrong\n\n\ndef make():\n    return Wrong({kind!r})\n", "utf-8"
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(__import__("sys").modules, "mine", raising=False)
    entry = SuiteEntry.from_file(entered(levels={LEVEL: ["mine:make"]}), trust=True)
    with pytest.raises(ParameterError) as error:
        entry.run(LEVEL, 2)
    assert "mine, order-easy, mine:make: " in str(error.value)
    assert words in str(error.value)
    assert "nothing of the entry is scored" in str(error.value)


def test_a_row_says_what_was_scored(entered, tmp_path: Path) -> None:
    names = ["a.npz", network(tmp_path / "b.npz", 0.5, cpu_s="5")]
    entry = SuiteEntry.from_file(entered(levels={LEVEL: names}))
    none, law = np.zeros(4), np.full(4, 0.4)
    row = entry.row(LEVEL, np.array([[0.1] * 4, [0.3] * 4]), none, law)
    assert (row["score"], row["trainings"], row["flocks"]) == (pytest.approx(0.5), 2, 4)
    assert (row["sees"], row["budget"], row["cpu_s"]) == ("as given", "30", 4.0)
    assert np.isnan(row["searched_hours"])
    # Straight ahead is what a network of zeros does.
    found = entry.run(LEVEL, 2)["signed_order"]
    ahead = LEVELS[LEVEL].run("straight ahead", 2)
    assert found[0].tolist() == ahead["signed_order"].tolist()
    assert found[1].tolist() != found[0].tolist()
    ((rows, orders, broken),) = scored([entry], [*LEVELS], 2)
    assert (rows["entry"].tolist(), broken) == (["mine"], ())
    led = orders.groupby("policy", sort=False)["signed_order"].apply(list)
    assert led.index.tolist() == ["straight ahead", "damped law", *names]
    assert led["b.npz"] == found[1].tolist()
    deepest = orders[orders["policy"] == "a.npz"]["worst_overlap_cm"].tolist()
    assert deepest == ahead["worst_overlap_cm"].tolist()
    assert min(deepest) > 0.0


def trained(wrapper: Callable[[Any], Any] = lambda venv: venv, **changes: object) -> Any:
    """A model of stable-baselines3 for the easy flock, which has learned nothing."""
    from flockenv.sb3 import LeaderVecEnv

    baselines3 = pytest.importorskip("stable_baselines3")
    options = {**gymnasium.spec(LEVEL_IDS[LEVEL]).kwargs, **changes}
    venv = wrapper(LeaderVecEnv(2, **options))
    return baselines3.PPO("MlpPolicy", venv, n_steps=8, batch_size=8, seed=0, device="cpu")


def stacked() -> WrappedPolicy:
    """A model that sees three observations at once."""
    from stable_baselines3.common.vec_env import VecFrameStack

    model = trained(lambda venv: VecFrameStack(venv, 3))
    return WrappedPolicy(model, lambda venv: VecFrameStack(venv, 3), model.env.unwrapped)


def sees(path: Path) -> object:
    """What the row of an entry says, from two flocks."""
    entry = SuiteEntry.from_file(path, trust=True)
    orders = entry.run(LEVEL, 2)["signed_order"]
    return entry.row(LEVEL, orders, np.zeros(2), np.full(2, 0.4))["sees"]


def test_a_model_is_said_to_see_what_it_sees(entered, tmp_path: Path) -> None:
    for changes, words in (({}, "as given"), ({"observation": {"phase": False}}, "its own")):
        trained(**changes).save(tmp_path / "model.zip")
        assert sees(entered(levels={LEVEL: ["model.zip"]})) == words


def test_a_model_enters_with_its_wrapper_and_sees_its_own(entered) -> None:
    """Its environment shows the level's observation."""
    pytest.importorskip("stable_baselines3")
    assert sees(entered(levels={LEVEL: [f"{__name__}:stacked"]})) == "its own"


def test_rows_are_sorted_by_level_budget_and_score() -> None:
    rows = [
        {"level": level, "budget": budget, "score": score}
        for level, budget, score in (
            ("order-noisy", "30", 0.9),
            ("order-easy", "more", 0.9),
            ("order-easy", "100", 0.1),
            ("order-easy", "30", 0.2),
            ("order-easy", "30", 0.3),
        )
    ]
    assert ranked(rows).index.tolist() == [*range(5)]
    assert ranked(rows)["score"].tolist() == [0.3, 0.2, 0.1, 0.9, 0.9]
