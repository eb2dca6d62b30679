"""Find cycles among the modules of a Rust crate: `python tests/modules/cycles.py src`.

A module depends on the module that defines what it names. A name that a `mod.rs` only re-exports
belongs to the file that the `mod.rs` takes it from. Folders may not depend on each other in a
circle, and neither may files.
"""

import re
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

COMMENT = re.compile(r"//[^\n]*")
USE = re.compile(r"^([ \t]*pub(?:\([a-z]+\))? )?[ \t]*use ([^;]+);", re.MULTILINE)
INLINE = re.compile(r"\b(?:crate|super)(?:::\w+)+")


def leaves(tree: str) -> list[str]:
    """Return the paths of a use tree: `a::{b, c::d}` names `a::b` and `a::c::d`."""
    head, brace, rest = tree.partition("{")
    if not brace:
        return [re.sub(r"\s+as\s+\w+", "", tree).strip()]
    paths, depth, piece = [], 0, ""
    for letter in rest[: rest.rindex("}")] + ",":
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            paths += [head.strip() + leaf for leaf in leaves(piece)] if piece.strip() else []
            piece = ""
        else:
            piece += letter
    return paths


class Crate:
    """The modules of a crate: their names, what each re-exports and what each names."""

    def __init__(self, root: Path) -> None:
        self.reexports: dict[tuple[str, ...], dict[str, tuple[str, ...]]] = {}
        self.named: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
        for path in sorted(root.rglob("*.rs")):
            parts = path.relative_to(root).with_suffix("").parts
            module = () if parts == ("lib",) else parts[:-1] if parts[-1] == "mod" else parts
            self._read(module, COMMENT.sub("", path.read_text(encoding="utf-8")))

    def _read(self, module: tuple[str, ...], text: str) -> None:
        self.reexports[module], self.named[module] = {}, []
        for public, tree in USE.findall(text):
            for leaf in leaves(tree):
                path = self._absolute(module, leaf, public=bool(public))
                # A macro is made visible in its own module under its own name.
                if public and path and path != (*module, leaf.strip()):
                    self.reexports[module][path[-1]] = path
                elif path:
                    self.named[module].append(path)
        for leaf in INLINE.findall(USE.sub("", text)):
            path = self._absolute(module, leaf, public=False)
            if path:
                self.named[module].append(path)

    def _absolute(
        self, module: tuple[str, ...], leaf: str, *, public: bool
    ) -> tuple[str, ...] | None:
        first, *rest = leaf.removesuffix("::self").split("::")
        if first == "crate":
            return tuple(rest)
        if first == "super":
            return self._absolute(module[:-1], "::".join(["self", *rest]), public=public)
        if first == "self":
            return (*module, *rest)
        # A path that starts with a child of this module; anything else is another crate.
        return (*module, first, *rest) if public else None

    def home(self, path: tuple[str, ...]) -> tuple[str, ...]:
        """Return the module that defines what a path names."""
        for length in range(len(path), -1, -1):
            module = path[:length]
            if module not in self.named:
                continue
            if length < len(path) and path[length] in self.reexports[module]:
                return self.home(self.reexports[module][path[length]] + path[length + 1 :])
            return module
        return ()

    def files(self) -> dict[str, set[str]]:
        """Return what each file depends on."""
        graph: dict[str, set[str]] = {}
        for module, paths in self.named.items():
            homes = {self.home(path) for path in paths} - {module, ()}
            graph["::".join(module) or "lib"] = {"::".join(home) for home in homes}
        return graph

    def folders(self) -> dict[str, set[str]]:
        """Return what each module directly under the root depends on."""
        graph: dict[str, set[str]] = {}
        for module, others in self.files().items():
            top = module.partition("::")[0]
            graph.setdefault(top, set()).update(other.partition("::")[0] for other in others)
        return {top: others - {top} for top, others in graph.items()}


def cycle(graph: dict[str, set[str]]) -> list[str] | None:
    """Return the modules of a cycle, each depending on the next, or None."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return None


def main(root: Path) -> str | None:
    """Return what is wrong with a crate, or None."""
    crate = Crate(root)
    for graph in (crate.folders(), crate.files()):
        found = cycle(graph)
        if found:
            return "modules depend on each other in a circle: " + " -> ".join(found)
    return None


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
