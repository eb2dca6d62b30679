"""`flockenv presets`."""

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Any

import typer
from rich.table import Table

from flockenv.cli.console import console, print_json
from flockenv.cli.options import takes
from flockenv.parameters import FlockParameters

__all__ = ["ABOUT", "presets"]

ABOUT = {
    "simulation": "Table 3's boats, with a scheme and a noise whose statistics do not depend on dt",
    "paper": "Table 3's boats, with the paper's own scheme and noise taken literally",
    "experiment": "the boats of Table 1, with constants fitted to Section 4",
}
"""What each preset is, in a line."""


@dataclass(frozen=True, kw_only=True)
class PresetsOptions:
    """Options of `flockenv presets`."""

    as_json: Annotated[bool, typer.Option("--json", help="Print all of it as JSON.")] = False


@takes(PresetsOptions)
def presets(options: PresetsOptions) -> None:
    """Print every preset: values, units, meanings and sources (sections of Tarcai et al. 2011).

    Example: `flockenv presets --json`
    """
    names = FlockParameters.presets()
    values = {name: FlockParameters.preset(name).to_dict() for name in names}
    sources = {name: FlockParameters.preset_sources(name) for name in names}
    declared = dataclasses.fields(FlockParameters)
    if options.as_json:
        print_json({name: _described(name, values[name], sources[name]) for name in names})
        return
    for name in names:
        console.print(f"{name}: {ABOUT[name]}", highlight=False)
    table = Table(box=None, show_header=False, padding=(0, 2, 1, 0))
    table.add_column(no_wrap=True)
    for each in declared:
        unit, meaning = each.metadata["unit"], each.metadata["doc"]
        lines = [f"{meaning} Unit: {unit}." if unit else meaning]
        lines += [f"{n}: {values[n][each.name]} ({sources[n][each.name]})" for n in names]
        table.add_row(each.name, "\n".join(lines))
    console.print("", table, highlight=False)


def _described(
    name: str, values: dict[str, Any], sources: dict[str, str]
) -> dict[str, str | dict[str, Any]]:
    fields = {}
    for each in dataclasses.fields(FlockParameters):
        unit, meaning = each.metadata["unit"], each.metadata["doc"]
        value, source = values[each.name], sources[each.name]
        fields[each.name] = {"value": value, "unit": unit, "meaning": meaning, "source": source}
    return {"about": ABOUT[name], "fields": fields}
