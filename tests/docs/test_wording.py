"""Law: pages and code hold no refused word; a refused word is found with what to write instead."""

import importlib.util
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("docs_wording", REPOSITORY / "docs/wording.py")
wording = importlib.util.module_from_spec(spec)
spec.loader.exec_module(wording)

GIVEN = (
    "the noise" + " level",
    "fell and falls" + " short",
    "two colour" + "s",
    "the_centre" + "_cm",
)


@pytest.mark.parametrize("text", GIVEN)
@pytest.mark.parametrize("name", ["docs/start.md", "src/lib.rs"])
def test_a_refused_word_is_found(name, text):
    (line,) = wording.refused(name, f"first line\n{text}\n")
    assert line.startswith(f"{name}:2: ")


def test_plan_language_is_refused_in_pages_alone():
    text = "a goal" + " of 5 µs a step"
    assert len(list(wording.refused("docs/start.md", text))) == 2
    assert list(wording.refused("src/lib.rs", text)) == []


def test_plain_words_pass():
    assert list(wording.refused("docs/start.md", "The center takes 5 µs per step.")) == []


def test_an_allowed_word_passes_in_its_file_alone():
    word = "arrange" + "ment"
    assert list(wording.refused("CHANGELOG.md", word)) == []
    assert len(list(wording.refused("README.md", word))) == 1


def test_the_repository_holds_none():
    assert wording.main() == 0
