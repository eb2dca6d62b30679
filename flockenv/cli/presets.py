"""`flockenv presets`."""

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

# Narrower terminals have the sources in a table of their own.
_WIDE = 120


def presets(
    as_json: Annotated[
        bool, typer.Option("--json", help="Print values and sources as JSON.")
    ] = False,
) -> None:
    """Print every preset, and where each number comes from (sections of Tarcai et al. 2011).

    Example: `flockenv presets --json`
    """
    names = FlockParameters.presets()
    values = {name: FlockParameters.preset(name).to_dict() for name in names}
    sources = {name: FlockParameters.preset_sources(name) for name in names}
    if as_json:
        data = {
            name: {
                "about": ABOUT[name],
                "fields": {
                    field: {"value": value, "source": sources[name][field]}
                    for field, value in values[name].items()
                },
            }
            for name in names
        }
        print_json(data)
        return
    for name in names:
        say(f"{name}: {ABOUT[name]}")
    merged = {
        field: _merged({name: source[field] for name, source in sources.items()})
        for field in values[names[0]]
    }
    is_wide = console.width >= _WIDE
    table, origins = Table("field", box=None), Table("field", "source", box=None)
    for name in names:
        table.add_column(name, no_wrap=True)
    table.columns[0].no_wrap = origins.columns[0].no_wrap = True
    if is_wide:
        table.add_column("source")
    for field, source in merged.items():
        row = [field, *(str(each[field]) for each in values.values())]
        table.add_row(*row, *([source] if is_wide else []))
        origins.add_row(field, source)
    say("")
    console.print(table)
    if not is_wide:
        say("\nWhere they come from\n")
        console.print(origins)


def _merged(by_preset: dict[str, str]) -> str:
    """Return the sources, each once: with the presets that have it, unless all have the same."""
    presets_of: dict[str, list[str]] = {}
    for name, source in by_preset.items():
        presets_of.setdefault(source, []).append(name)
    if len(presets_of) == 1:
        return next(iter(presets_of))
    return "\n".join(f"{', '.join(names)}: {source}" for source, names in presets_of.items())
