"""Law: the environments' pages are what their docstrings say today."""

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


def test_pages_are_current():
    spec = importlib.util.spec_from_file_location("environment_pages", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found = module.pages()
    assert len(found) == 4
    for path, text in found.items():
        assert path.read_text() == text, f"run `python docs/{SCRIPT.name}`"
        places = [text.index(f"\n## {section}\n") for section in SECTIONS]
        assert places == sorted(places)
        assert "{" not in text.replace("{'", "").replace("{k-1}", "").replace('{"reset_mask', "")
