"""Write the addresses of repository and site where readers and registries look: `make addresses`.

`addresses.py --check` ends with a sentence while they are not filled in, or not written everywhere.
"""

import re
import sys
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]
DECLARED = ".github/addresses.toml"


def texts(root: Path, repository: str, site: str) -> Mapping[Path, str]:
    """Return the files that hold the addresses, as they should be."""
    urls = [
        f'Homepage = "{site}"',
        f'Repository = "{repository}"',
        f'Issues = "{repository}/issues"',
    ]
    return {
        root / "pyproject.toml": _tail(root / "pyproject.toml", ["[project.urls]", *urls]),
        root / "Cargo.toml": _after(
            root / "Cargo.toml",
            r'(?:repository|homepage) = ".*"\n',
            r'readme = "README\.md"\n',
            [f'repository = "{repository}"', f'homepage = "{site}"'],
        ),
        root / "CITATION.cff": _after(
            root / "CITATION.cff",
            r'(?:repository-code|url): ".*"\n',
            r"license: MIT\n",
            [f'repository-code: "{repository}"', f'url: "{site}"'],
        ),
        root / "README.md": _after(
            root / "README.md",
            r"\[Pages and the live page\]\(.*\n\n?",
            r"# flockenv\n\n",
            [f"[Pages and the live page]({site}) · [repository]({repository})", ""],
        ),
    }


def _tail(file: Path, lines: Iterable[str]) -> str:
    """Return a file that ends in these lines."""
    text = re.sub(r"\n\[project\.urls\]\n(?:\w+ = .*\n)*", "", file.read_text("utf-8"))
    return text + "\n" + "".join(f"{line}\n" for line in lines)


def _after(file: Path, old: str, place: str, lines: Iterable[str]) -> str:
    """Return a file with these lines after a place, where old ones may be."""
    new = "".join(f"{line}\n" for line in lines)
    text = re.sub(f"^{old}", "", file.read_text("utf-8"), flags=re.MULTILINE)
    found = re.search(f"^{place}", text, re.MULTILINE)
    if found is None:
        raise SystemExit(f"{file.name} has no line {place}")
    return text[: found.end()] + new + text[found.end() :]


def main(root: Path, *options: str) -> None:
    """Write the addresses, or check that they are written."""
    declared = tomllib.loads((root / DECLARED).read_text("utf-8"))
    empty = [name for name in ("repository", "site") if not declared[name]]
    if empty:
        raise SystemExit(f"{DECLARED} has no {' and no '.join(empty)} yet: a release fills it in")
    for file, text in texts(root, declared["repository"].rstrip("/"), declared["site"]).items():
        if "--check" not in options:
            file.write_text(text, "utf-8")
        elif file.read_text("utf-8") != text:
            raise SystemExit(f"{file.name} has other addresses: `make addresses` writes them")


if __name__ == "__main__":
    main(ROOT, *sys.argv[1:])
