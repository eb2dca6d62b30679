"""Law: what an environment's docstring says of the task is what the core declares."""

import inspect
import re

import gymnasium
import pytest

import flockenv
from flockenv import _core
from flockenv.envs.observation import (
    BLOCKS,
    flock_feature_entries,
    observation_entries,
    state_entries,
)
from flockenv.envs.options import TERMS
from flockenv.order import QUANTITIES

pytest.importorskip("stable_baselines3")

from flockenv.sb3 import LeaderVecEnv

EVERY_BLOCK = {block: type(default)(1) for block, default in BLOCKS.items()}
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


def words(text: str) -> str:
    return re.sub(r"\s+", " ", text)


SPECIFIED = words(inspect.getdoc(flockenv.LeadersEnv))


def line(entry) -> str:
    """How the docstring lists an entry: name, bounds, unit and meaning."""
    if entry.block == "lean_features":
        return f"- `{entry.name}`: {entry.meaning}"
    scale = f", {entry.scale}" if entry.scale.startswith("-1") else f" × {entry.scale}"
    scale = "" if entry.scale == "1" else scale
    return f"- `{entry.name}` in [{entry.low:g}, {entry.high:g}]{scale}: {entry.meaning}"


def test_it_lists_every_entry_of_the_observation_and_the_state_in_order():
    for entries in (observation_entries(EVERY_BLOCK), state_entries(1)):
        blocks: dict[str, list] = {}
        for entry in entries:
            blocks.setdefault(entry.block, []).append(entry)
        for block, own in blocks.items():
            heading = " all in [-20, 20] and standardized as in the pool"
            heading = f"- {block}{',' + heading if block == 'lean_features' else ''} "
            assert heading + " ".join(map(line, own)) in SPECIFIED


def test_it_lists_every_feature_of_the_flock():
    blocks: dict[str, list[str]] = {}
    for entry in flock_feature_entries():
        blocks.setdefault(entry.name, []).append(entry.block)
    for entry in flock_feature_entries():
        of = ", ".join(blocks[entry.name])
        bounds = f"[{entry.low:g}, {entry.high:g}]"
        assert f"- `{entry.name}` in {bounds} of {of}: {entry.meaning}" in SPECIFIED


def test_it_lists_every_term_of_the_reward_and_every_option():
    assert " ".join(f"- `{name}`: {meaning}" for name, meaning in TERMS.items()) in SPECIFIED
    defaults = {**_core.env_defaults(), "target": "cw"}
    for option in _core.OPTIONS:
        name, meaning = option["name"], option["doc"]
        if name not in ("bw_s", "autoreset_mode"):
            assert words(f"- `{name}` = `{defaults[name]!r}`: {meaning}") in SPECIFIED
    means = [each.name for each in QUANTITIES if each.is_averaged and each.kind != "structure"]
    assert ", ".join(f"`{name}`" for name in means) in SPECIFIED


def test_its_sections_stand_in_the_order_of_gymnasiums_pages():
    for kind in (
        flockenv.LeadersEnv,
        flockenv.LeadersParallelEnv,
        flockenv.LeadersVectorEnv,
        LeaderVecEnv,
    ):
        text = inspect.getdoc(kind)
        places = [text.find(f"\n## {section}\n") for section in SECTIONS]
        assert min(places[0], places[-1]) > 0
        assert [place for place in places if place > 0] == sorted({*places} - {-1})
        assert kind is flockenv.LeadersEnv or "`LeadersEnv` specifies the task" in text
    assert 'gymnasium.make("flockenv:flockenv/Order-easy-v0")' in SPECIFIED
    assert gymnasium.spec("flockenv/Order-easy-v0").kwargs
