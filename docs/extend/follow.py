"""Apply and test the pages of this folder: `make extend`, or `make extend PAGE=policy`.

A page is a patch. A block ```` ```diff ```` starts with the file that it changes; the lines that it
keeps or removes must occur in that file exactly once. A block after ``<!-- new file: PATH -->`` is
a new file. The changes are made in a copy of the tree. There the page's shell commands then run in
their order. The first command that fails ends the script. The copy stays in target/extend, so that
the next page compiles only its own changes.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
FOLDER = Path(__file__).parent
COPY = REPOSITORY / "target" / "extend"
FENCE = re.compile(
    r"(?:<!-- new file: (?P<new>\S+) -->\n\n)?^```(?P<language>\w+)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)


class PageError(Exception):
    """A page that cannot be followed."""


def apply(page: str, tree: Path) -> list[str]:
    """Make a page's changes in a tree; return its shell commands."""
    commands = []
    for block in FENCE.finditer(page):
        text = block["text"]
        if block["new"]:
            path = tree / block["new"]
            if path.exists():
                raise PageError(f"{block['new']} already exists")
            path.write_text(text, encoding="utf-8")
        elif block["language"] == "diff":
            header, _, hunks = text.partition("\n")
            name = header.removeprefix("+++ ")
            content = (tree / name).read_text("utf-8")
            for hunk in hunks.split("@@\n")[1:]:
                content = changed(content, hunk, name)
            (tree / name).write_text(content, encoding="utf-8")
        elif block["language"] == "sh":
            commands.append(text)
    return commands


def changed(content: str, hunk: str, name: str) -> str:
    """Return a file's content after one change; its old lines must occur in it exactly once."""
    lines = hunk.splitlines(keepends=True)
    before = "".join(line[1:] or line for line in lines if line[0] in " -\n")
    after = "".join(line[1:] or line for line in lines if line[0] in " +\n")
    if content.count(before) != 1:
        raise PageError(f"{name} has these lines {content.count(before)} times:\n{before}")
    return content.replace(before, after)


def copy_tree() -> None:
    """Make the copy hold the files of this tree that git tracks or does not ignore."""

    def git(*words: str, folder: Path = REPOSITORY) -> str:
        done = subprocess.run(["git", *words], cwd=folder, check=True, capture_output=True)
        return done.stdout.decode()

    COPY.mkdir(parents=True, exist_ok=True)
    names = git("ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0")
    files = {name for name in names if name and (REPOSITORY / name).is_file()}
    if (COPY / ".git").exists():
        copied = git("ls-files", "-z", "--cached", "--others", "--exclude-standard", folder=COPY)
        for name in {*copied.split("\0")} - files - {""}:
            (COPY / name).unlink(missing_ok=True)
    else:
        git("init", "--quiet", str(COPY))
    for name in files:
        source, target = REPOSITORY / name, COPY / name
        # Unchanged files keep their time, so that they are not compiled again.
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(source.read_bytes())
            target.chmod(source.stat().st_mode)


def follow(page: Path) -> None:
    """Apply a page to a copy of the tree, and run its commands there."""
    print(f"--- {page.stem}", flush=True)
    copy_tree()
    own_target = {"CARGO_TARGET_DIR": str(COPY / "target")}
    for commands in apply(page.read_text("utf-8"), COPY):
        run = ["bash", "-euxc", commands]
        done = subprocess.run(run, cwd=COPY, env={**os.environ, **own_target}, check=False)
        if done.returncode:
            raise PageError(f"{page.stem}: a command ended with {done.returncode}")


def main() -> None:
    """Follow the pages of the command line, or all that change something."""
    pages = sys.argv[1:] or sorted(
        path.stem for path in FOLDER.glob("*.md") if "```diff" in path.read_text("utf-8")
    )
    try:
        for name in pages:
            follow(FOLDER / f"{name}.md")
    except (PageError, OSError) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
