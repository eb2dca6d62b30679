"""Refuse words of pages and code: `make lint` runs ``python docs/wording.py``.

docs/words.toml lists the words, what to write instead, and the files that may hold one. Lines with
a refused word are printed, and the exit code is 1 if there are any.
"""

import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
WORDS: dict[str, Any] = tomllib.loads((ROOT / "docs/words.toml").read_text(encoding="utf-8"))
SUFFIXES = {
    *("", ".css", ".hbs", ".html", ".js", ".md", ".mjs"),
    *(".py", ".pyi", ".rs", ".sh", ".toml", ".yml"),
}
LEFT_OUT = re.compile(r"^(LICENSES?/|LICENSE$|tests/fixtures/|\.git)")


def main() -> int:
    """Print every line with a refused word."""
    found = [
        line
        for name in _tracked_files()
        for line in refused(name, (ROOT / name).read_text(encoding="utf-8"))
    ]
    sys.stdout.writelines(f"{line}\n" for line in found)
    return 1 if found else 0


def refused(name: str, text: str) -> Iterator[str]:
    """Yield a line for each refused word in the text of a file."""
    banned = WORDS["everywhere"] | (WORDS["pages"] if name.endswith(".md") else {})
    allowed = [
        word for files, words in WORDS["allowed"].items() if fnmatch(name, files) for word in words
    ]
    pattern = re.compile("|".join(rf"\b(?:{word})\b" for word in banned), re.IGNORECASE)
    for number, line in enumerate(text.splitlines(), 1):
        for match in pattern.finditer(line):
            if not any(re.fullmatch(word, match[0], re.IGNORECASE) for word in allowed):
                advice = next(
                    advice
                    for word, advice in banned.items()
                    if re.compile(rf"\b(?:{word})\b", re.IGNORECASE).match(line, match.start())
                )
                yield f"{name}:{number}: {match[0]!r}: write {advice}"


def _tracked_files() -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split("\0")
    return [
        name
        for name in listed
        if name
        and Path(name).suffix in SUFFIXES
        and not LEFT_OUT.search(name)
        and (ROOT / name).exists()
    ]


if __name__ == "__main__":
    sys.exit(main())
