"""Find circles among the modules of a Rust crate: `python tests/modules/cycles.py src`.

Its `Cargo.toml` lists the layers, from the top down. A folder may name what stands below it.

Folders may not name each other in a circle, and neither may files of one folder. A file that is
called `mod.rs` may name its own files, and a name that it only re-exports is not followed.
"""

import re
import sys
import tomllib
from collections.abc import Callable
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

COMMENT = re.compile(r"//[^\n]*")
GROUP = re.compile(r"\b(crate|super)::\{(.*?)\};", re.DOTALL)
NAMED = {"crate": re.compile(r"\bcrate::(\w+)"), "super": re.compile(r"\bsuper::(\w+)")}


def code_of(path: Path) -> str:
    """Return a file without comments, and with each name of a group by its whole path."""

    def spread(group: re.Match[str]) -> str:
        inner = re.sub(r"::\{[^{}]*\}", "", group[2])
        return " ".join(f"{group[1]}::{name.strip()};" for name in inner.split(","))

    return GROUP.sub(spread, COMMENT.sub("", path.read_text(encoding="utf-8")))


def circle(files: list[Path], module: Callable[[Path], str], start: str) -> list[str] | None:
    """Return modules of some files that depend on each other in a circle, or None."""
    graph: dict[str, set[str]] = {module(path): set() for path in files}
    for path in files:
        graph[module(path)] |= {*NAMED[start].findall(code_of(path))} & graph.keys()
    try:
        TopologicalSorter({name: of - {name} for name, of in graph.items()}).prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return None


def upward(root: Path, files: list[Path]) -> str | None:
    """Return a name that leads up or beside, or a module that stands in no layer."""
    manifest = root.parent / "Cargo.toml"
    package = tomllib.loads(manifest.read_text("utf-8"))["package"] if manifest.exists() else {}
    layers = package.get("metadata", {}).get("layers", [])
    floor = {name: -row for row, names in enumerate(layers) for name in names.split(" | ")}
    for path in files if floor else ():
        own = path.relative_to(root).with_suffix("").parts[0]
        if own not in floor:
            return f"{own} stands in no layer of {manifest}"
        for other in {*NAMED["crate"].findall(code_of(path))} & floor.keys() - {own}:
            if floor[other] >= floor[own]:
                return f"{path} names {other}, which does not stand below {own}"
    return None


def main(root: Path) -> str | None:
    """Return what is wrong with a crate, or None."""
    every = [path for path in sorted(root.rglob("*.rs")) if path != root / "lib.rs"]
    if wrong := upward(root, every):
        return wrong
    found = circle(every, lambda path: path.relative_to(root).with_suffix("").parts[0], "crate")
    for folder in {path.parent for path in every} - {root}:
        own = [path for path in every if path.parent == folder and path.name != "mod.rs"]
        found = found or circle(own, lambda path: path.stem, "super")
    return found and "modules depend on each other in a circle: " + " -> ".join(found)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
