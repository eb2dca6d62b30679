"""Law: the page of the architecture names what there is."""

import re
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
NAMED = set(re.findall(r"`([^`]+)`", (REPOSITORY / "ARCHITECTURE.md").read_text("utf-8")))


def test_steps_are_functions():
    files = [*REPOSITORY.glob("src/**/*.rs"), *REPOSITORY.glob("flockenv/**/*.py")]
    code = "\n".join(path.read_text("utf-8") for path in files)
    steps = {re.split(r"::|\.", each)[-1] for each in NAMED if re.fullmatch(r"\w+(::|\.)\w+", each)}
    assert {"advance_to", "resolve", "solve"} <= steps
    missing = {name for name in steps if not re.search(rf"\b(fn|def) {name}\b", code)}
    assert missing == set()
