"""Print the floors of ARCHITECTURE.md from the layers that `make lint` checks: `make floors`."""

import ast
import re
import tomllib
from pathlib import Path

from docs.scripts.markdown import filled, markdown
from docs.scripts.plots import REPOSITORY

PAGE = REPOSITORY / "ARCHITECTURE.md"
OUTSIDE = (
    ("`studies`, `baselines`, `examples`, `docs`", "Studies, trainings and pages, on public names"),
    ("`web`", "The live page: the same crate, compiled to WebAssembly"),
)


def floors() -> str:
    """Return the table of modules from the top down; floors are numbered from the bottom."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    python = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    cargo = tomllib.loads((REPOSITORY / "Cargo.toml").read_text("utf-8"))
    layers = [(REPOSITORY / "flockenv", names) for names in python]
    layers += [(REPOSITORY / "src", names) for names in cargo["package"]["metadata"]["layers"]]
    body = [["", *row] for row in OUTSIDE]
    for layers_above, (folder, names) in enumerate(layers):
        for path in (_module(folder, name) for name in names.split(" | ")):
            number = str(len(layers) - layers_above)
            body.append([number, f"`{path.relative_to(REPOSITORY)}`", _purpose(path)])
    return markdown(["floor", "module", "what it is"], body)


def _module(folder: Path, name: str) -> Path:
    """Return the file or the folder of a module."""
    files = (folder / f"{name}.{ending}" for ending in ("py", "rs"))
    return next((path for path in files if path.exists()), folder / name)


def _purpose(path: Path) -> str:
    """Return the first sentence of a module's docstring."""
    roots = (path / "__init__.py", path / "mod.rs")
    file = path if path.is_file() else next(root for root in roots if root.exists())
    text = file.read_text("utf-8")
    if file.suffix == ".py":
        words = ast.get_docstring(ast.parse(text)) or ""
    else:
        words = " ".join(re.findall(r"^//! (.*)", text.split("\n//!\n")[0], re.MULTILINE))
    return re.split(r"\.$|\.\s+(?=[A-Z])", " ".join(words.split()), maxsplit=1)[0]


if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text("utf-8"), floors=floors()), encoding="utf-8")
