"""The pages of the environments, from what the core declares: `make environment-pages`.

`tables.md` lists parameters, options, terms of the reward, entries of the observation and of the
global state, and features of the flock. id_pages.py makes a page for each id, and the table of
`index.md`. They are committed, so that they are there where a repository is read. `classes.md`, the
docstring of each class, is on the site alone.
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


def pages() -> dict[Path, str]:
    """Return the text of every page that is committed."""
    index, listed = ((FOLDER / name).read_text("utf-8") for name in ("index.md", "tables.md"))
    filled_in = {"index": filled(index, ids=registered()), "tables": tables(listed)}
    texts = {**id_pages(), **filled_in}
    return {FOLDER / f"{name}.md": text for name, text in texts.items()}


def classes() -> str:
    """Return the page of the classes, which are their docstrings."""
    docs = "\n\n".join(f"# {each.__name__}\n\n{inspect.getdoc(each)}" for each in CLASSES)
    docs = docs.replace("docs/environments/tables.md", "[Tables](tables.md)")
    docs = re.sub("^(#+ )", r"#\1", docs, flags=re.MULTILINE)
    return f"# Classes\n\n`help(flockenv.LeadersEnv)` shows the same text.\n\n{docs}\n"


def tables(page: str) -> str:
    """Return the page of everything that the core declares of the environments, filled in."""
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
    for each in fields(FlockParameters):
        values = [str(values[each.name]) for values in presets.values()]
        preset = values[0] if len({*values}) == 1 else ", ".join(values)
        unit = each.metadata["unit"]
        meaning = each.metadata["doc"] + (f" [{unit}]" if unit else "")
        body.append([f"`{each.name}`", meaning, preset, each.metadata["accepted"]])
    return markdown(["field", "meaning", ", ".join(presets), "accepted"], body)


def _by_block(entries: Iterable[Entry]) -> str:
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
                    f"`{each.name}`",
                    _bounds(each),
                    plain_cell(each.scale),
                    "yes" if each.mirrored else "",
                    plain_cell(each.meaning),
                ]
                for each in own
            ],
        )
        for block, own in blocks.items()
    )


def _features() -> str:
    of: dict[str, list[str]] = {}
    entries = {entry.name: entry for entry in flock_feature_entries()}
    for entry in flock_feature_entries():
        of.setdefault(entry.name, []).append(entry.block)
    body = [
        [f"`{name}`", ", ".join(of[name]), _bounds(each), plain_cell(each.meaning)]
        for name, each in entries.items()
    ]
    return markdown(["feature", "of", "bounds", "meaning"], body)


def _bounds(entry: Entry) -> str:
    return f"[{entry.low:g}, {entry.high:g}]"


def write() -> None:
    """Write the pages that differ."""
    for path, text in {**pages(), FOLDER / "classes.md": classes()}.items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def draw() -> None:
    """Draw what the pages show on the site."""
    draw_films()


if __name__ == "__main__":
    write()
