"""`flockenv presets`."""

from rich.table import Table

from flockenv import FlockParameters
from flockenv.cli.console import console

__all__ = ["presets"]


def presets() -> None:
    """Print every preset, and where each number comes from (sections of Tarcai et al. 2011)."""
    names = FlockParameters.presets()
    values = [FlockParameters.preset(name).to_dict() for name in names]
    sources = [FlockParameters.preset_sources(name) for name in names]
    table = Table("field", *names, "source")
    for field in values[0]:
        told = [source[field] for source in sources]
        table.add_row(field, *(str(each[field]) for each in values), _merged(names, told))
    console.print(table)


def _merged(names: list[str], sources: list[str]) -> str:
    """Return the sources, each once: with the presets that have it, unless all have the same."""
    if len(set(sources)) == 1:
        return sources[0]
    by_source: dict[str, list[str]] = {}
    for name, source in zip(names, sources, strict=True):
        by_source.setdefault(source, []).append(name)
    return "\n".join(f"{', '.join(own)}: {source}" for source, own in by_source.items())
