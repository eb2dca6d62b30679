"""`flockenv presets`."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from rich.table import Table

from flockenv.cli.console import console, print_json
from flockenv.cli.options import option, takes
from flockenv.parameters import FlockParameters

ABOUT = {
    "simulation": "Table 3's boats, with a scheme and a noise whose statistics do not depend on dt",
    "paper": "Table 3's boats, with the paper's own scheme and noise taken literally",
    "experiment": "the boats of Table 1, with constants fitted to Section 4",
}
"""A line about each preset."""


@dataclass(frozen=True, kw_only=True)
class PresetsOptions:
    """Options of `flockenv presets`."""

    as_json: bool = option(False, "Print the presets as JSON.", "--json")


@takes(PresetsOptions)
def presets(options: PresetsOptions) -> None:
    """Print every preset: values, units, meanings and sources (sections of Tarcai et al. 2011).

    Example: `flockenv presets --json`
    """
    presets_by_name: dict[str, dict[str, Any]] = {}
    for name in FlockParameters.presets():
        values = FlockParameters.preset(name).to_dict()
        sources = FlockParameters.preset_sources(name)
        entries = {
            parameter.name: {
                "value": values[parameter.name],
                "unit": parameter.metadata["unit"],
                "meaning": parameter.metadata["doc"],
                "source": sources[parameter.name],
            }
            for parameter in dataclasses.fields(FlockParameters)
        }
        presets_by_name[name] = {"about": ABOUT[name], "fields": entries}
    if options.as_json:
        print_json(presets_by_name)
        return
    for name in presets_by_name:
        console.print(f"{name}: {ABOUT[name]}", highlight=False)
    table = Table(box=None, show_header=False, padding=(0, 2, 1, 0))
    table.add_column(no_wrap=True)
    for parameter in dataclasses.fields(FlockParameters):
        meaning, unit = parameter.metadata["doc"], parameter.metadata["unit"]
        lines = [f"{meaning} Unit: {unit}." if unit else meaning]
        for name, preset in presets_by_name.items():
            entry = preset["fields"][parameter.name]
            lines.append(f"{name}: {entry['value']} ({entry['source']})")
        table.add_row(parameter.name, "\n".join(lines))
    console.print("", table, highlight=False)
