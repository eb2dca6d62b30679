"""The pages of the environments, from what the core declares: `make environment-pages`.

`tables.md` lists parameters, options, terms of the reward, entries of the observation and of the
global state, and features of the flock. id_pages.py makes a page for each id, and the table of
`index.md`. They are committed, so that readers of the repository see them. `classes.md`, the
docstring of each class, is only on the site.
"""

import inspect
import re
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path

import flockenv
from docs.scripts.id_pages import draw_films, id_pages, plain_cell, registered
from docs.scripts.markdown import filled, markdown
from docs.scripts.plots import DOCS
from flockenv.envs.observation import (
    BLOCKS,
    Entry,
    flock_feature_entries,
    observation_entries,
    state_entries,
)
from flockenv.envs.options import OPTIONS, TERMS
from flockenv.parameters import FlockParameters
from flockenv.sb3 import LeaderVecEnv

FOLDER = DOCS / "environments"
CLASSES = (
    flockenv.LeadersEnv,
    flockenv.LeadersParallelEnv,
    flockenv.LeadersVectorEnv,
    LeaderVecEnv,
)
EVERY_BLOCK = {name: type(default)(1) for name, default in BLOCKS.items()}
"""An observation with every block: flags are True, and counts 1."""


def pages() -> dict[Path, str]:
    """Return the text of every page that is committed."""
    index, tables_page = ((FOLDER / name).read_text("utf-8") for name in ("index.md", "tables.md"))
    filled_in = {"index": filled(index, ids=registered()), "tables": tables(tables_page)}
    texts = {**id_pages(), **filled_in}
    return {FOLDER / f"{name}.md": text for name, text in texts.items()}


def classes() -> str:
    """Return the page with the docstring of each class."""
    docs = "\n\n".join(f"# {cls.__name__}\n\n{inspect.getdoc(cls)}" for cls in CLASSES)
    docs = docs.replace("docs/environments/tables.md", "[Tables](tables.md)")
    docs = re.sub("^(#+ )", r"#\1", docs, flags=re.MULTILINE)
    return f"# Classes\n\n`help(flockenv.LeadersEnv)` shows the same text.\n\n{docs}\n"


def tables(page: str) -> str:
    """Return the page `tables.md`, with its tables filled in from the core's declarations."""
    options = [
        [f"`{name}`", f"`{option.default!r}`", plain_cell(option.doc)]
        for name, option in OPTIONS.items()
    ]
    terms = [[f"`{name}`", plain_cell(meaning)] for name, meaning in TERMS.items()]
    return filled(
        page,
        parameters=_parameters(),
        options=markdown(["option", "default", "meaning"], options),
        terms=markdown(["term", "meaning"], terms),
        entries=_by_block(observation_entries(EVERY_BLOCK)),
        state=_by_block(state_entries(1)),
        features=_features(),
    )


def _parameters() -> str:
    presets = {name: FlockParameters.preset(name).to_dict() for name in FlockParameters.presets()}
    body = []
    for field in fields(FlockParameters):
        values = [str(preset[field.name]) for preset in presets.values()]
        default = values[0] if len({*values}) == 1 else ", ".join(values)
        unit = field.metadata["unit"]
        meaning = field.metadata["doc"] + (f" [{unit}]" if unit else "")
        body.append([f"`{field.name}`", meaning, default, field.metadata["accepted"]])
    return markdown(["field", "meaning", ", ".join(presets), "accepted"], body)


def _by_block(entries: Iterable[Entry]) -> str:
    """Return a table of entries for each block, below its name."""
    blocks: dict[str, list[Entry]] = {}
    for entry in entries:
        blocks.setdefault(entry.block, []).append(entry)
    header = ["entry", "bounds", "scale", "mirrored", "meaning"]
    return "\n\n".join(
        f"### `{block}`\n\n"
        + markdown(
            header,
            [
                [
                    f"`{entry.name}`",
                    _bounds(entry),
                    plain_cell(entry.scale),
                    "yes" if entry.mirrored else "",
                    plain_cell(entry.meaning),
                ]
                for entry in block_entries
            ],
        )
        for block, block_entries in blocks.items()
    )


def _features() -> str:
    """Return the table of flock features, each with the blocks that have a feature of its name."""
    blocks: dict[str, list[str]] = {}
    entries = {entry.name: entry for entry in flock_feature_entries()}
    for entry in flock_feature_entries():
        blocks.setdefault(entry.name, []).append(entry.block)
    body = [
        [f"`{name}`", ", ".join(blocks[name]), _bounds(entry), plain_cell(entry.meaning)]
        for name, entry in entries.items()
    ]
    return markdown(["feature", "of", "bounds", "meaning"], body)


def _bounds(entry: Entry) -> str:
    return f"[{entry.low:g}, {entry.high:g}]"


def write() -> None:
    """Write the pages whose text has changed."""
    for path, text in {**pages(), FOLDER / "classes.md": classes()}.items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def draw() -> None:
    """Draw the films and plots that the pages show on the site."""
    draw_films()


if __name__ == "__main__":
    write()
