"""The flocks of a comparison: one or both pools, one or several backward durations."""

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from flockenv.cli.parameters import given_fields, parameters_of
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters

__all__ = ["PoolChoice", "PoolOption", "compared_flocks", "pool_name"]

#: The flock of the experiment, unless another number is given.
_BOATS = 27


class PoolChoice(StrEnum):
    """Pools of a comparison."""

    BOTH = "both"
    WIDE = "wide"
    NARROW = "narrow"


PoolOption = Annotated[
    PoolChoice | None, typer.Option("--pool", help="Which pool. [both, or that of the parameters]")
]


def compared_flocks(
    preset: str | None,
    file: Path | None,
    changes: Sequence[str] | None,
    pool: PoolChoice | None,
    noise_levels: Sequence[float] | None = None,
) -> list[FlockParameters]:
    """Return the parameters that a command's options select, for each pool and backward duration.

    Fields that neither the file nor a change names are the preset's, except for 27 boats, both
    pools, and the critical noise of each pool. The command sets numbers of leaders itself.

    Raises
    ------
    ParameterError
        As for `read_parameters`; for a pool or a backward duration given twice; for changes of the
        number of leaders and lists of targets; for pools whose critical noise is not known.
    """
    for change in changes or ():
        if change.partition("=")[0].strip() == "n_leaders":
            raise ParameterError(
                f"--set {change} is not accepted: numbers of leaders have an option of their own"
            )
    fields = given_fields(preset, file, changes)
    if pool is not None and "pool" in fields and fields["pool"] != pool.value:
        raise ParameterError(f"--pool {pool.value} contradicts pool = {fields['pool']!r}")
    if noise_levels and "bw_s" in fields:
        raise ParameterError(f"--bw-s contradicts bw_s = {fields['bw_s']!r}")
    if isinstance(fields.get("target"), list):
        raise ParameterError(
            f"target = {fields['target']!r} is not accepted: the command sets the number of "
            "leaders itself, and they have one target: cw or ccw"
        )
    base = parameters_of({"n_boats": _BOATS, **fields})
    pools: list[Any] = [fields["pool"]] if "pool" in fields else _pools(pool or PoolChoice.BOTH)
    found = []
    for each in pools:
        parameters = base.replace(pool=each)
        levels: Sequence[float] = [parameters.bw_s] if "bw_s" in fields else noise_levels or []
        if not levels:
            name = fields.get("preset", "simulation")
            levels = [FlockParameters.critical_bw_s(name, parameters.pool)]
        found += [parameters.replace(bw_s=level) for level in levels]
    return found


def pool_name(parameters: FlockParameters) -> str:
    """Return the name of a flock's pool in the names of folders."""
    if isinstance(parameters.pool, str):
        return parameters.pool
    outer, inner = parameters.pool
    return f"{outer:g}x{inner:g}"


def _pools(choice: PoolChoice) -> list[str]:
    every = [each.value for each in PoolChoice if each != PoolChoice.BOTH]
    return every if choice == PoolChoice.BOTH else [choice.value]
