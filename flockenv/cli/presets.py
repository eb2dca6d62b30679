"""`flockenv presets`."""

from rich.table import Table

from flockenv import FlockParameters
from flockenv.cli.console import console

__all__ = ["presets"]


def presets() -> None:
    """Print every preset."""
    table = Table("field", *FlockParameters.presets())
    columns = [FlockParameters.preset(name).to_dict() for name in FlockParameters.presets()]
    for field in columns[0]:
        table.add_row(field, *(str(column[field]) for column in columns))
    console.print(table)
