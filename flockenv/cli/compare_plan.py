"""Plans of comparisons: what `flockenv compare` is asked for, checked before anything runs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Self

from flockenv.cli.console import echo, errors
from flockenv.cli.options import TRUST, Printing, option, option_of
from flockenv.cli.output import printable
from flockenv.cli.parameters import Flocks, changed_fields, pool_of
from flockenv.comparison.case import Case
from flockenv.comparison.levels import SUITE as LEVELS_SUITE
from flockenv.comparison.suite import REFERENCE, tasks_named
from flockenv.errors import ParameterError, short_repr
from flockenv.parameters import FlockParameters
from flockenv.policies.base import Policy, Pool
from flockenv.policies.names import LEARNED, PAPERS_LAW, TUNED_LAW
from flockenv.policies.registry import FILES, policy

REFERENCES = (LEARNED, TUNED_LAW, PAPERS_LAW)
"""Policies that others are compared with, unless `--only` is given."""

Given = str | Mapping[str, str]
"""A policy as it is typed, or one for each leader."""

Steers = Policy | Mapping[str, Policy]
"""A policy, or one for each leader."""

_BOATS = 27
_MOST_LEADERS = 64


@dataclass(frozen=True, kw_only=True)
class CompareOptions(Flocks, Printing):
    """Options of `flockenv compare`."""

    policy: list[str] | None = option(
        None,
        "Your policy; repeatable. A name, the file of a learned policy, the .zip file of an SB3 "
        "model or module:attribute (with --trust), or one per leader, as in "
        "leader_0=a.npz,leader_1=learned.",
    )
    name: list[str] | None = option(None, "Name of your policy; once for each. [its file's name]")
    only: bool = option(False, f"Leave out {', '.join(REFERENCES)}.", "--only")
    trust: bool = option(False, TRUST, "--trust")
    pool: list[str] | None = option(
        None, "wide, narrow or (outer_cm, inner_cm); repeatable. [wide, or the parameters' pool]"
    )
    bw_s: list[float] | None = option(None, "Noise: backward duration in s; repeatable. [critical]")
    n_leaders: str | None = option(
        None, "Numbers of leaders, as in 0-4 or 1,3. [0-4; 1-4 with --env]", metavar="NUMBERS"
    )
    env: list[str] | None = option(
        None,
        "Option of the environment, as in target=alternate; repeatable.",
        metavar="NAME=VALUE",
    )
    episodes: int = option(64, "Seeds for each case.", min=2)
    minutes: float | None = option(
        None, "Length of an episode. [8; 16 for target=alternate]", min=0.0
    )
    seed: int = option(0, "First seed.", min=0)
    suite: str | None = option(
        None, "Score the policies on the frozen tasks of suite v2, or entries on the levels of v3."
    )
    task: list[str] | None = option(None, "One task or level of the suite; repeatable. [every one]")
    entry: list[str] | None = option(
        None, "With --suite v3: the file of an entry; repeatable.", metavar="FILE"
    )
    trial_flocks: int | None = option(
        None, "With --suite v3: score in fewer flocks, as a trial.", min=2
    )
    flock_hours: list[float] | None = option(
        None,
        "With --suite: flock-hours that made a policy of a file, searches of settings included; "
        "once for each such policy.",
        min=0.0,
    )
    full: bool = option(False, "Also print differences and slopes.", "--full")
    out: Path = option(Path("results/compare"), "Folder for tables and pictures.")


_OF_FLOCKS = (
    *("preset", "params", "n_boats", "changes", "pool", "bw_s"),
    *("n_leaders", "env", "episodes", "minutes", "seed", "only"),
)


@dataclass(frozen=True)
class Plan:
    """A comparison, checked before anything runs."""

    cases: list[Case]
    #: The policies of each case by name, the user's first.
    policies: dict[str, dict[str, Steers]]
    #: The names of the user's policies.
    own: list[str]
    #: Flock-hours that went into each of the user's policies, if a suite asks for them.
    spent: dict[str, float]

    @classmethod
    def parse(cls, options: CompareOptions) -> Self:
        """Return the plan of checked options; raise ParameterError for one that is not accepted."""
        for name in ("entry", "trial_flocks"):
            if getattr(options, name) is not None:
                words = f"is not accepted without --suite {LEVELS_SUITE}"
                raise ParameterError(f"{option_of(name)} {words}")
        cases = _tasks(options) if options.suite else _flocks(options)
        own = _own_policies(options)
        spent = _spent(options, own)
        policies = {case.name: _policies(case.parameters.pool, own, options) for case in cases}
        return cls(cases, policies, list(own), spent)

    @property
    def names(self) -> list[str]:
        """The names of all policies, the user's first."""
        return list(dict.fromkeys(name for policies in self.policies.values() for name in policies))

    @property
    def flock_hours(self) -> float:
        """Hours of simulated time."""
        return sum(case.flock_hours(len(self.policies[case.name])) for case in self.cases)


def _spent(options: CompareOptions, own: Mapping[str, Given]) -> dict[str, float]:
    """Return the flock-hours of each policy that is a file; a suite refuses files without them."""
    hours = options.flock_hours or []
    if not options.suite:
        if hours:
            raise ParameterError("--flock-hours is not accepted without --suite")
        return {}
    parts = {
        name: [*given.values()] if isinstance(given, Mapping) else [given]
        for name, given in own.items()
    }
    files = [name for name, names in parts.items() if any(map(_is_user_made, names))]
    if len(hours) != len(files):
        raise ParameterError(
            f"{len(hours)} --flock-hours for {len(files)} --policy of a file ({', '.join(files)}): "
            "say of each how many flock-hours made it, searches of settings included"
        )
    return dict(zip(files, hours, strict=True))


def _is_user_made(given: str) -> bool:
    """Return whether a policy is the user's own file or object, and so took flock-hours to make."""
    return given.endswith(FILES) or (":" in given and "=" not in given)


def _policies(pool: Pool, own: Mapping[str, Given], options: CompareOptions) -> dict[str, Steers]:
    """Return a case's policies by name, the user's first; print the names of those left out."""
    found: dict[str, Steers] = {
        name: _read(given, pool, options.trust) for name, given in own.items()
    }
    for name in (REFERENCE,) if options.suite else () if options.only else REFERENCES:
        if name in own.values() and not options.suite:  # The user gave it this name.
            continue
        try:
            found.setdefault(name, policy(name, pool))
        except ParameterError as error:
            echo(f"Left out, {name}: {error}", errors)
    if not found:
        raise ParameterError("--only is not accepted without --policy: nothing would be compared")
    return found


def _read(given: Given, pool: Pool, trust: bool) -> Steers:
    if isinstance(given, Mapping):
        return {leader: policy(own, pool, trust=trust) for leader, own in given.items()}
    return policy(given, pool, trust=trust)


def _tasks(options: CompareOptions) -> list[Case]:
    """Return the tasks of a suite; refuse options that would change a task."""
    refuse_all_but({field.name for field in fields(options)} - {*_OF_FLOCKS}, options)
    return tasks_named(str(options.suite), options.task or ())


def refuse_all_but(names: Iterable[str], options: CompareOptions) -> None:
    """Refuse options that a suite does not take."""
    taken = {*names}
    for field in fields(options):
        if field.name not in taken and getattr(options, field.name) != field.default:
            name = {"changes": "--set"}.get(field.name, option_of(field.name))
            raise ParameterError(
                f"{name} is not accepted with --suite {options.suite}, which fixes it: there is no "
                "score of an altered task"
            )


def _flocks(options: CompareOptions) -> list[Case]:
    """Return a case for each pool and backward duration."""
    if options.task:
        raise ParameterError("--task is not accepted without --suite")
    environment = changed_fields(options.env or (), "--env")
    leaders = _numbers(options.n_leaders or ("1-4" if environment else "0-4"))
    if options.policy and not any(leaders):
        raise ParameterError("--policy is not accepted with --n-leaders 0: nobody is steered")
    alternates = environment.get("target") == "alternate"
    minutes = options.minutes if options.minutes is not None else 16.0 if alternates else 8.0
    return [
        Case(
            name=f"{_pool_name(parameters.pool)}-bw-{parameters.bw_s!r}",
            parameters=parameters,
            leaders=leaders,
            seeds=range(options.seed, options.seed + options.episodes),
            episode_s=60.0 * minutes,
            environment=environment,
        )
        for parameters in dict.fromkeys(_parameters(options))
    ]


def _numbers(text: str) -> tuple[int, ...]:
    """Return the numbers of leaders that a text such as ``0-2,4`` names."""
    found: set[int] = set()
    for part in text.split(","):
        first, _, last = (end.strip() for end in part.partition("-"))
        ends = (first, last or first)
        if not all(end.isdecimal() for end in ends) or int(ends[0]) > int(ends[1]):
            raise ParameterError(f"--n-leaders {text} is not accepted: numbers, as in 0-4 or 1,3")
        if int(ends[1]) > _MOST_LEADERS:
            raise ParameterError(f"--n-leaders {text} is not accepted: at most {_MOST_LEADERS}")
        found.update(range(int(ends[0]), int(ends[1]) + 1))
    return tuple(sorted(found))


def _parameters(options: CompareOptions) -> list[FlockParameters]:
    """Return the parameters for each pool and backward duration.

    Fields that neither the file nor a change names are the preset's, except for 27 boats and
    the critical noise of each pool. `--pool` and `--bw-s` count before all of them.
    """
    given = options.fields()
    if "n_leaders" in changed_fields(options.changes or ()):
        raise ParameterError("--set n_leaders is not accepted: use --n-leaders")
    if isinstance(given.get("target"), list):
        raise ParameterError(
            f"target = {short_repr(given['target'])} is not accepted: here the number of leaders "
            "varies, so all have one target: cw or ccw"
        )
    base = options.parameters()
    base = base.replace(n_boats=given.get("n_boats", _BOATS))
    found = []
    pools: Sequence[Pool] = [*map(pool_of, options.pool or ())] or [base.pool]
    levels = options.bw_s or ([base.bw_s] if "bw_s" in given else [])
    preset = str(given.get("preset", "simulation"))
    if not levels and base.n_boats != _BOATS and not options.quiet:
        echo(
            f"{base.n_boats} boats at the critical noise of {_BOATS}, since theirs is not stored: "
            "--bw-s names another one, and `flockenv sweep` measures it",
            errors,
        )
    for pool in pools:
        for bw_s in levels or [FlockParameters.critical_bw_s(preset, pool)]:
            found.append(base.replace(pool=pool, bw_s=bw_s))
    return found


def _pool_name(pool: str | tuple[float, float]) -> str:
    """Return the name of a flock's pool in the names of files."""
    return pool if isinstance(pool, str) else f"{pool[0]:g}x{pool[1]:g}"


def _own_policies(options: CompareOptions) -> dict[str, Given]:
    """Return the user's policies by name: as given, or a dictionary of these by leader."""
    given, names = options.policy or [], options.name or []
    if names and len(names) != len(given):
        many = f"{len(names)} --name for {len(given)} --policy"
        raise ParameterError(f"{many}: name all of yours, in order, or none")
    own: dict[str, Given] = {}
    for index, text in enumerate(given):
        is_per_leader = text.startswith("leader_")
        is_file = text.endswith(FILES) and not is_per_leader
        name = printable(names[index] if names else Path(text).stem if is_file else text)
        if name in own or (name in REFERENCES and text != name):
            if names:
                raise ParameterError(f"--name {name} is not accepted: another policy has this name")
            name = printable(text)
        if name in own:
            raise ParameterError(f"--policy {text} is given twice: give one another --name")
        own[name] = text
        if is_per_leader:  # A number is refused like an unknown name.
            by_leader = changed_fields(text.split(","), "--policy").items()
            own[name] = {leader: str(given) for leader, given in by_leader}
    return own
