"""`flockenv presets`."""

import dataclasses
from typing import Annotated

import typer
from rich.table import Table

from flockenv.cli.console import console, print_json, say
from flockenv.parameters import FlockParameters

__all__ = ["ABOUT", "presets"]

ABOUT = {
    "simulation": "Table 3's boats, with a scheme and a noise whose statistics do not depend on dt",
    "paper": "Table 3's boats, with the paper's own scheme and noise taken literally",
    "experiment": "the boats of Table 1, with constants fitted to Section 4",
}
"""What each preset is, in a line."""


def presets(
    as_json: Annotated[bool, typer.Option("--json", help="Print all of it as JSON.")] = False,
) -> None:
    """Print every preset: values, units, meanings and sources (sections of Tarcai et al. 2011).

    Example: `flockenv presets --json`
    """
    names = FlockParameters.presets()
    values = {name: FlockParameters.preset(name).to_dict() for name in names}
    sources = {name: FlockParameters.preset_sources(name) for name in names}
    declared = {each.name: each.metadata for each in dataclasses.fields(FlockParameters)}
    if as_json:
        data = {
            name: {
                "about": ABOUT[name],
                "fields": {
                    field: {
                        "value": value,
                        "unit": declared[field]["unit"],
                        "meaning": declared[field]["doc"],
                        "source": sources[name][field],
                    }
                    for field, value in values[name].items()
                },
            }
            for name in names
        }
        print_json(data)
        return
    for name in names:
        say(f"{name}: {ABOUT[name]}")
    numbers, meanings = Table(box=None), Table(box=None, show_header=False, padding=(0, 2, 1, 0))
    for heading in ("field", *names):
        numbers.add_column(heading, no_wrap=True)
    for heading in ("field", "meaning"):
        meanings.add_column(heading, no_wrap=heading == "field")
    for field, metadata in declared.items():
        first, *others = (str(each[field]) for each in values.values())
        # Four whole columns would not fit into 80.
        numbers.add_row(field, first, *("" if each == first else each for each in others))
        unit = f"Unit: {metadata['unit']}. " if metadata["unit"] else ""
        source = _merged({name: each[field] for name, each in sources.items()})
        meanings.add_row(field, f"{metadata['doc']}\n{unit}Source: {source}")
    say(f"\nWhere a column is empty, the value is that of {names[0]}.\n")
    console.print(numbers)
    say("\nWhat the fields mean, and where the values come from\n")
    console.print(meanings, highlight=False)


def _merged(by_preset: dict[str, str]) -> str:
    """Return the sources, each once: with the presets that have it, unless all have the same."""
    presets_of: dict[str, list[str]] = {}
    for name, source in by_preset.items():
        presets_of.setdefault(source, []).append(name)
    if len(presets_of) == 1:
        return next(iter(presets_of))
    return "; ".join(f"{', '.join(names)}: {source}" for source, names in presets_of.items())
