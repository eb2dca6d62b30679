"""Law: a docstring says what the task is; what the core declares stands in tables made of it."""

import inspect
import re

import gymnasium
import pytest

import flockenv
from flockenv.envs.observation import (
    BLOCKS,
    flock_feature_entries,
    observation_entries,
    state_entries,
)
from flockenv.envs.options import OPTIONS, TERMS, EnvOptions
from flockenv.order import QUANTITIES

pytest.importorskip("stable_baselines3")

from flockenv.sb3 import LeaderVecEnv

KINDS = (
    flockenv.LeadersEnv,
    flockenv.LeadersParallelEnv,
    flockenv.LeadersVectorEnv,
    LeaderVecEnv,
)
SECTIONS = (
    "Description",
    "Action space",
    "Observation space",
    "Rewards",
    "Starting state",
    "Episode end",
    "Arguments",
    "Version history",
)
LONGEST = 150


@pytest.fixture(scope="module")
def tables():
    """The page of tables: its rows by section."""
    from docs.scripts import environment_pages

    page = environment_pages.pages()[environment_pages.FOLDER / "tables.md"]
    sections = re.split(r"^## ", page, flags=re.MULTILINE)[1:]
    return {text.split("\n", 1)[0]: re.findall(r"^\| `(.+?)` ", text, re.M) for text in sections}


def test_the_tables_list_everything_once_and_in_order(tables):
    every_block = {block: type(default)(1) for block, default in BLOCKS.items()}
    features = dict.fromkeys(entry.name for entry in flock_feature_entries())
    assert tables == {
        "Parameters": [*flockenv.FlockParameters.__dataclass_fields__],
        "Options": [*OPTIONS],
        "Reward terms": [*TERMS],
        "Observation": [entry.name for entry in observation_entries(every_block)],
        "Global state": [entry.name for entry in state_entries(1)],
        "Flock features": [*features],
    }


def test_every_option_is_accepted_with_its_default():
    drawn = {name: each.default for name, each in OPTIONS.items() if name != "params"}
    shown = {"render_mode", "render_size", "autoreset_mode"}
    EnvOptions.parse({name: each for name, each in drawn.items() if name not in shown})
    taken = inspect.signature(flockenv.LeadersEnv).parameters
    for name in shown - {"autoreset_mode"}:
        assert taken[name].default == OPTIONS[name].default
    assert "autoreset_mode" in inspect.signature(flockenv.LeadersVectorEnv).parameters


@pytest.mark.parametrize("kind", KINDS)
def test_a_docstring_is_the_task_in_few_lines(kind):
    text = inspect.getdoc(kind)
    assert text.count("\n") < LONGEST
    places = [text.find(f"\n## {section}\n") for section in SECTIONS]
    assert min(places[0], places[-1]) > 0
    assert [place for place in places if place > 0] == sorted({*places} - {-1})
    assert kind is flockenv.LeadersEnv or "`LeadersEnv` specifies the task" in text


def test_names_of_the_task_are_names_of_the_core():
    text = inspect.getdoc(flockenv.LeadersEnv)
    named = {section.split("\n", 1)[0]: section for section in text.split("\n## ")}
    listed = re.findall(r"^- ((?:`\w+`(?:, | or )?)+)", named["Arguments"], re.M)
    arguments = {name for each in listed for name in re.findall(r"`(\w+)`", each)}
    assert len(arguments) > 10
    assert arguments <= {*OPTIONS}
    blocks = {*re.findall(r"^- `(\w+)`", named["Observation space"], re.M)}
    assert len(blocks) > 3
    assert blocks <= {*BLOCKS}
    env = flockenv.LeadersEnv(n_boats=4, n_leaders=1, episode_s=60.0)
    env.reset(seed=0)
    over = False
    while not over:
        _, _, _, over, info = env.step([0.0])
    summary = re.findall(r"`(\w+)`", named["Episode end"].split("has:")[1])
    assert {*summary} <= {*info["episode_summary"]}
    assert {*summary} & {each.name for each in QUANTITIES}
    assert 'gymnasium.make("flockenv:flockenv/Order-easy-v0")' in text
    assert gymnasium.spec("flockenv/Order-easy-v0").kwargs
