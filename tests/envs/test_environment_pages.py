"""Law: each environment's docstring is its specification, in the order of Gymnasium's pages."""

import importlib.util
from pathlib import Path

import pytest

pytest.importorskip("stable_baselines3")

SCRIPT = Path(__file__).parents[2] / "docs" / "environment_pages.py"
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


def test_pages_have_their_sections_in_order():
    spec = importlib.util.spec_from_file_location("environment_pages", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found = module.pages()
    assert len(found) == 4
    for text in found.values():
        places = [text.index(f"\n## {section}\n") for section in SECTIONS]
        assert places == sorted(places)
        assert 'gymnasium.make("flockenv:flockenv/Order-easy-v0")' in text
        assert "{" not in text.replace("{'", "").replace("{k-1}", "").replace('{"reset_mask', "")
