"""The options of `flockenv compare`, and the cases and policies that they name."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, TypeGuard

import typer

from flockenv.cli.options import Flocks, Printing
from flockenv.cli.output import printable
from flockenv.cli.parameters import TrustOption, changed_fields, given_fields, parameters_of
from flockenv.comparison.case import Case
from flockenv.comparison.suite import budget_class, tasks_named
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.policies.registry import FILES

__all__ = ["REFERENCES", "CompareOptions", "cases_of", "is_file", "own_policies"]

REFERENCES = ("learned", "tuned law", "paper's law")
"""What policies are compared with, unless `--only` is given."""

_BOATS = 27
_MOST_LEADERS = 64


class PoolChoice(StrEnum):
    """Pools of a comparison."""

    BOTH = "both"
    WIDE = "wide"
    NARROW = "narrow"


@dataclass(frozen=True, kw_only=True)
class CompareOptions(Flocks, Printing):
    """Options of `flockenv compare`."""

    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="Policy of yours, repeatable: a name, the file of a learned one, the .zip file "
            "of an SB3 model (with --trust), or one per leader, as in leader_0=a.npz,leader_1=law."
        ),
    ] = None
    name: Annotated[
        list[str] | None,
        typer.Option(help="What a policy of yours is called; once for each. [its file's name]"),
    ] = None
    only: Annotated[bool, typer.Option("--only", help=f"Leave out {', '.join(REFERENCES)}.")] = (
        False
    )
    trust: TrustOption = False
    pool: Annotated[
        PoolChoice | None, typer.Option(help="Which pool. [both, or that of the parameters]")
    ] = None
    bw_s: Annotated[
        list[float] | None,
        typer.Option(help="Noise: backward duration in s, repeatable. [critical]"),
    ] = None
    leaders: Annotated[
        str | None, typer.Option(metavar="NUMBERS", help="As in 0-4 or 1,3. [0-4; 1-4 with --env]")
    ] = None
    env: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="Option of the environment, repeatable, as in target=alternate.",
        ),
    ] = None
    episodes: Annotated[int, typer.Option(min=2, help="Seeds for each case.")] = 64
    minutes: Annotated[
        float | None,
        typer.Option(min=0.0, help="Length of an episode. [8; 16 for target=alternate]"),
    ] = None
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0
    suite: Annotated[
        str | None, typer.Option(help="Score the policies on the frozen tasks of a suite: v2.")
    ] = None
    task: Annotated[
        list[str] | None, typer.Option(help="Of the suite, one task, repeatable. [every task]")
    ] = None
    flock_hours: Annotated[
        float | None, typer.Option(help="With --suite: what making your policy has simulated.")
    ] = None
    full: Annotated[
        bool, typer.Option("--full", help="Print differences and straight lines too.")
    ] = False
    out: Annotated[Path, typer.Option(help="Folder for tables and pictures.")] = Path(
        "results/compare"
    )


_FREE = (
    "policy",
    "name",
    "trust",
    "suite",
    "task",
    "flock_hours",
    "full",
    "out",
    "as_json",
    "quiet",
)
"""Options that leave a task as it is."""


def cases_of(options: CompareOptions) -> list[Case]:
    """Return the cases that the options name: tasks of a suite, or flocks.

    Raises
    ------
    ParameterError
        For options that contradict each other or are out of range.
    """
    return _tasks(options) if options.suite else _flocks(options)


def _tasks(options: CompareOptions) -> list[Case]:
    """Return the tasks of a suite; refuse options that would make another task of one."""
    defaults = CompareOptions()
    for name in vars(defaults):
        changed = getattr(options, name) != getattr(defaults, name)
        if changed and name not in _FREE:
            option = {"changes": "--set"}.get(name, f"--{name.replace('_', '-')}")
            raise ParameterError(
                f"{option} is not accepted with --suite {options.suite}, whose tasks fix it: there "
                "is no score of an altered task"
            )
    return tasks_named(str(options.suite), options.task or ())


def _flocks(options: CompareOptions) -> list[Case]:
    """Return a case for each pool and backward duration."""
    for option, value in (("--task", options.task), ("--flock-hours", options.flock_hours)):
        if value is not None:
            raise ParameterError(f"{option} is not accepted without --suite")
    environment = changed_fields(options.env or (), "--env")
    alternates = environment.get("target") == "alternate"
    minutes = options.minutes if options.minutes is not None else 16.0 if alternates else 8.0
    numbers = _numbers(options.leaders or ("1-4" if environment else "0-4"))
    cases: dict[str, Case] = {}
    for parameters in _parameters(options):
        name = f"{_pool_name(parameters)}-bw-{parameters.bw_s:g}"
        if name in cases:
            raise ParameterError(
                f"--bw-s {parameters.bw_s!r} is not accepted beside "
                f"{cases[name].parameters.bw_s!r}: backward durations that differ in six digits"
            )
        cases[name] = Case(
            name=name,
            parameters=parameters,
            leaders=numbers,
            seeds=range(options.seed, options.seed + options.episodes),
            episode_s=60.0 * minutes,
            environment=environment,
        )
    return list(cases.values())


def _numbers(text: str) -> tuple[int, ...]:
    """Return the numbers of leaders that a text such as ``0-2,4`` names."""
    found: set[int] = set()
    for part in text.split(","):
        first, _, last = (each.strip() for each in part.partition("-"))
        ends = (first, last or first)
        if not all(each.isdecimal() for each in ends) or int(ends[0]) > int(ends[1]):
            raise ParameterError(f"--leaders {text} is not accepted: numbers, as in 0-4 or 1,3")
        if int(ends[1]) > _MOST_LEADERS:
            raise ParameterError(f"--leaders {text} is not accepted: at most {_MOST_LEADERS}")
        found.update(range(int(ends[0]), int(ends[1]) + 1))
    return tuple(sorted(found))


def _parameters(options: CompareOptions) -> list[FlockParameters]:
    """Return the parameters for each pool and backward duration.

    Fields that neither the file nor a change names are the preset's, except for 27 boats, both
    pools, and the critical noise of each pool.
    """
    fields = given_fields(options.preset, options.params, options.changes)
    pool, levels = options.pool, options.bw_s
    if "n_leaders" in changed_fields(options.changes or ()):
        raise ParameterError("--set n_leaders is not accepted: numbers of leaders are --leaders")
    if pool is not None and "pool" in fields and fields["pool"] != pool.value:
        raise ParameterError(f"--pool {pool.value} contradicts pool = {fields['pool']!r}")
    if levels and "bw_s" in fields:
        raise ParameterError(f"--bw-s contradicts bw_s = {fields['bw_s']!r}")
    if isinstance(fields.get("target"), list):
        raise ParameterError(
            f"target = {fields['target']!r} is not accepted: leaders, of which there are several "
            "numbers here, have one target: cw or ccw"
        )
    base = parameters_of({"n_boats": _BOATS, **fields})
    pools: list[Any] = [fields["pool"]] if "pool" in fields else _pools(pool or PoolChoice.BOTH)
    found = []
    for parameters in (base.replace(pool=each) for each in pools):
        chosen = levels or ([parameters.bw_s] if "bw_s" in fields else None)
        if chosen is None:
            name = fields.get("preset", "simulation")
            chosen = [FlockParameters.critical_bw_s(name, parameters.pool)]
        found += [parameters.replace(bw_s=level) for level in chosen]
    return found


def _pools(choice: PoolChoice) -> list[str]:
    every = [each.value for each in PoolChoice if each != PoolChoice.BOTH]
    return every if choice == PoolChoice.BOTH else [choice.value]


def _pool_name(parameters: FlockParameters) -> str:
    """Return the name of a flock's pool in the names of files."""
    if isinstance(parameters.pool, str):
        return parameters.pool
    outer, inner = parameters.pool
    return f"{outer:g}x{inner:g}"


def own_policies(options: CompareOptions) -> dict[str, Any]:
    """Return the user's policies by name: as given, or a dictionary of these by leader.

    Raises
    ------
    ParameterError
        For names that are too few or the same, and for a file in a suite without flock-hours.
    """
    given, names = options.policy or [], options.name or []
    if names and len(names) != len(given):
        raise ParameterError(f"--name was given {len(names)} times for {len(given)} policies")
    own: dict[str, Any] = {}
    for place, text in enumerate(given):
        policy = _by_leader(text) if text.startswith("leader_") else text
        name = printable(names[place] if names else _name(text))
        if name in own or (name in REFERENCES and text != name):
            name = printable(text)
        if name in own:
            raise ParameterError(f"--policy {text} is given twice: another --name tells them apart")
        own[name] = policy
    if options.suite and any(map(is_file, own.values())):
        budget_class(options.flock_hours)
    return own


def _by_leader(text: str) -> dict[str, str]:
    """Return the policies of a text such as ``leader_0=a.npz,leader_1=learned``."""
    found = {}
    for part in text.split(","):
        leader, equals, policy = (each.strip() for each in part.partition("="))
        if not (equals and policy) or leader in found:
            raise ParameterError(
                f"--policy {text} is not accepted: one policy per leader, as in "
                "leader_0=mine.npz,leader_1=learned"
            )
        found[leader] = policy
    return found


def _name(text: str) -> str:
    return Path(text).stem if is_file(text) and not text.startswith("leader_") else text


def is_file(policy: Any) -> TypeGuard[str]:
    """Return whether a policy was given by the name of its file."""
    return isinstance(policy, str) and policy.endswith(FILES)
