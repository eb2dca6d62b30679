"""Find circles among the modules of a Rust crate: `python tests/modules/cycles.py src`.

Its `Cargo.toml` lists the layers, from the top down. A folder may name what stands below it.

The files of a folder and the folders beside them may not name each other in a circle. A name that
`mod.rs` re-exports stands for the module that it comes from; `mod.rs` itself may name its files.
"""

import re
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

COMMENT = re.compile(r"//[^\n]*")
START = re.compile(r"\b(?:crate|super)::|(?<=\buse )\w+::")
WORD, SPACE, REST = (re.compile(pattern) for pattern in (r"\s*(\w+)", r"\s*", r"[^,{}]*,?"))

Name = tuple[str, ...]


def tree(code: str, at: int, prefix: Name) -> tuple[list[Name], int]:
    """Return the names of a path at a place, several if it ends in a group, and where it ends."""
    word = WORD.match(code, at)
    if word is None:
        return [prefix], at
    name, at = (*prefix, word[1]), word.end()
    if not code.startswith("::", at):
        return [name], at
    if not code.startswith("{", at + 2):
        return tree(code, at + 2, name)
    found, at = [], SPACE.match(code, at + 3).end()  # type: ignore[union-attr]
    while code[at] != "}":
        inner, at = tree(code, at, name)
        found += inner
        at = REST.match(code, at).end()  # type: ignore[union-attr]
        at = SPACE.match(code, at).end()  # type: ignore[union-attr]
    return found, at + 1


def names_of(path: Path) -> set[Name]:
    """Return the paths that the code of a file names."""
    code = COMMENT.sub("", path.read_text(encoding="utf-8"))
    return {name for start in START.finditer(code) for name in tree(code, start.start(), ())[0]}


def circle(root: Path, folder: Path, every: list[Path]) -> list[str] | None:
    """Return modules of a folder that depend on each other in a circle, or None."""
    parts = ("crate", *folder.relative_to(root).parts)
    front = folder / ("lib.rs" if folder == root else "mod.rs")
    inside = [path for path in every if folder in path.parents and path != front]

    def module(path: Path) -> str:
        return path.relative_to(folder).with_suffix("").parts[0]

    graph: dict[str, set[str]] = {module(path): set() for path in inside}
    rooms = {(name,): name for name in graph}
    if front.exists():
        rooms |= {name[-1:]: name[0] for name in names_of(front) if name[0] in graph}
    for path in inside:
        up = ("super",) * (len(path.relative_to(folder).parts) - (path.name == "mod.rs"))
        for name in names_of(path):
            for start in (parts, up):
                if name[: len(start)] == start and name[len(start) : len(start) + 1] in rooms:
                    graph[module(path)].add(rooms[name[len(start) : len(start) + 1]])
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
        others = {name[1] for name in names_of(path) if name[0] == "crate"}
        for other in others & floor.keys() - {own}:
            if floor[other] >= floor[own]:
                return f"{path} names {other}, which does not stand below {own}"
    return None


def main(root: Path) -> str | None:
    """Return what is wrong with a crate, or None."""
    every = [path for path in sorted(root.rglob("*.rs")) if path != root / "lib.rs"]
    if wrong := upward(root, every):
        return wrong
    folders = sorted({path.parent for path in every} | {root})
    circles = (circle(root, folder, every) for folder in folders)
    found = next((each for each in circles if each), None)
    return found and "modules depend on each other in a circle: " + " -> ".join(found)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
