"""Plans of comparisons: the options of `flockenv compare`, checked before anything runs."""

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

TypedPolicy = str | Mapping[str, str]
"""A policy as the user types it, or one for each leader by name."""

Steering = Policy | Mapping[str, Policy]
"""A policy of all leaders, or one for each leader by name."""

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


_FLOCK_OPTIONS = (
    *("preset", "params", "n_boats", "changes", "pool", "bw_s"),
    *("n_leaders", "env", "episodes", "minutes", "seed", "only"),
)


@dataclass(frozen=True)
class Plan:
    """A comparison, checked before anything runs."""

    cases: list[Case]
    #: The policies of each case by name, the user's first.
    policies: dict[str, dict[str, Steering]]
    #: The names of the user's policies.
    user_policies: list[str]
    #: With a suite, the flock-hours that made each policy of a file.
    training_hours: dict[str, float]

    @classmethod
    def parse(cls, options: CompareOptions) -> Self:
        """Return the plan of options; raise ParameterError for an option that is not accepted."""
        for name in ("entry", "trial_flocks"):
            if getattr(options, name) is not None:
                raise ParameterError(
                    f"{option_of(name)} is not accepted without --suite {LEVELS_SUITE}"
                )
        cases = _suite_cases(options) if options.suite else _flock_cases(options)
        typed = _user_policies(options)
        hours = _training_hours(options, typed)
        policies = {
            case.name: _case_policies(case.parameters.pool, typed, options) for case in cases
        }
        return cls(cases, policies, list(typed), hours)

    @property
    def names(self) -> list[str]:
        """The names of all policies, the user's first."""
        return list(dict.fromkeys(name for policies in self.policies.values() for name in policies))

    @property
    def flock_hours(self) -> float:
        """Simulated hours of all flocks together."""
        return sum(case.flock_hours(len(self.policies[case.name])) for case in self.cases)


def _training_hours(options: CompareOptions, typed: Mapping[str, TypedPolicy]) -> dict[str, float]:
    """Return the flock-hours that made each policy of a file, by the policy's name.

    A suite needs them for every such policy; without a suite they are refused.
    """
    hours = options.flock_hours or []
    if not options.suite:
        if hours:
            raise ParameterError("--flock-hours is not accepted without --suite")
        return {}
    texts = {
        name: [*policy.values()] if isinstance(policy, Mapping) else [policy]
        for name, policy in typed.items()
    }
    files = [name for name in typed if any(map(_is_user_made, texts[name]))]
    if len(hours) != len(files):
        raise ParameterError(
            f"{len(hours)} --flock-hours for {len(files)} --policy of a file ({', '.join(files)}): "
            "say of each how many flock-hours made it, searches of settings included"
        )
    return dict(zip(files, hours, strict=True))


def _is_user_made(text: str) -> bool:
    """Return whether a text names a file or a Python object, whose training took flock-hours."""
    return text.endswith(FILES) or (":" in text and "=" not in text)


def _case_policies(
    pool: Pool, typed: Mapping[str, TypedPolicy], options: CompareOptions
) -> dict[str, Steering]:
    """Return a case's policies by name, the user's first.

    Prints which references are left out because they are not made for the pool.
    """
    policies = {name: _load(text, pool, options.trust) for name, text in typed.items()}
    if options.suite:
        references: tuple[str, ...] = (REFERENCE,)
    else:
        references = () if options.only else REFERENCES
    for name in references:
        # One of the user's policies may be the same. A suite needs the reference by its name.
        if name in typed.values() and not options.suite:
            continue
        try:
            policies.setdefault(name, policy(name, pool))
        except ParameterError as error:
            echo(f"Left out, {name}: {error}", errors)
    if not policies:
        raise ParameterError("--only is not accepted without --policy: nothing would be compared")
    return policies


def _load(typed: TypedPolicy, pool: Pool, trust: bool) -> Steering:
    """Read a policy, or those of a dictionary by leader."""
    if isinstance(typed, Mapping):
        return {leader: policy(text, pool, trust=trust) for leader, text in typed.items()}
    return policy(typed, pool, trust=trust)


def _suite_cases(options: CompareOptions) -> list[Case]:
    """Return the tasks of a suite; refuse options that would change a task."""
    refuse_all_but({field.name for field in fields(options)} - {*_FLOCK_OPTIONS}, options)
    return tasks_named(str(options.suite), options.task or ())


def refuse_all_but(names: Iterable[str], options: CompareOptions) -> None:
    """Refuse options that differ from their defaults and are not among these names."""
    accepted = {*names}
    for field in fields(options):
        if field.name not in accepted and getattr(options, field.name) != field.default:
            spelling = {"changes": "--set"}.get(field.name, option_of(field.name))
            raise ParameterError(
                f"{spelling} is not accepted with --suite {options.suite}, which fixes it: there "
                "is no score of an altered task"
            )


def _flock_cases(options: CompareOptions) -> list[Case]:
    """Return a case for each pool and backward duration."""
    if options.task:
        raise ParameterError("--task is not accepted without --suite")
    environment = changed_fields(options.env or (), "--env")
    leaders = _leader_counts(options.n_leaders or ("1-4" if environment else "0-4"))
    if options.policy and not any(leaders):
        raise ParameterError("--policy is not accepted with --n-leaders 0: nobody is steered")
    alternates = environment.get("target") == "alternate"
    default_minutes = 16.0 if alternates else 8.0
    minutes = default_minutes if options.minutes is None else options.minutes
    return [
        Case(
            name=f"{_pool_name(parameters.pool)}-bw-{parameters.bw_s!r}",
            parameters=parameters,
            leaders=leaders,
            seeds=range(options.seed, options.seed + options.episodes),
            episode_s=60.0 * minutes,
            environment=environment,
        )
        for parameters in dict.fromkeys(_parameter_sets(options))
    ]


def _leader_counts(text: str) -> tuple[int, ...]:
    """Return the numbers of leaders, ascending, that a text such as ``0-2,4`` names."""
    counts: set[int] = set()
    for part in text.split(","):
        first, _, last = (end.strip() for end in part.partition("-"))
        last = last or first
        if not (first.isdecimal() and last.isdecimal()) or int(first) > int(last):
            raise ParameterError(f"--n-leaders {text} is not accepted: numbers, as in 0-4 or 1,3")
        if int(last) > _MOST_LEADERS:
            raise ParameterError(f"--n-leaders {text} is not accepted: at most {_MOST_LEADERS}")
        counts.update(range(int(first), int(last) + 1))
    return tuple(sorted(counts))


def _parameter_sets(options: CompareOptions) -> list[FlockParameters]:
    """Return the parameters for each pool and backward duration.

    Fields that neither the file nor `--set` names are the preset's, except for 27 boats and
    the critical noise of each pool. `--pool` and `--bw-s` override all of them.
    """
    named_fields = options.fields()
    if "n_leaders" in changed_fields(options.changes or ()):
        raise ParameterError("--set n_leaders is not accepted: use --n-leaders")
    if isinstance(named_fields.get("target"), list):
        raise ParameterError(
            f"target = {short_repr(named_fields['target'])} is not accepted: here the number of "
            "leaders varies, so all have one target: cw or ccw"
        )
    base = options.parameters()
    base = base.replace(n_boats=named_fields.get("n_boats", _BOATS))
    pools: Sequence[Pool] = [*map(pool_of, options.pool or ())] or [base.pool]
    noises = options.bw_s or ([base.bw_s] if "bw_s" in named_fields else [])
    preset = str(named_fields.get("preset", "simulation"))
    if not noises and base.n_boats != _BOATS and not options.quiet:
        echo(
            f"{base.n_boats} boats at the critical noise of {_BOATS}, since theirs is not stored: "
            "--bw-s names another one, and `flockenv sweep` measures it",
            errors,
        )
    return [
        base.replace(pool=pool, bw_s=bw_s)
        for pool in pools
        for bw_s in noises or [FlockParameters.critical_bw_s(preset, pool)]
    ]


def _pool_name(pool: str | tuple[float, float]) -> str:
    """Return a pool's name for the names of cases and files, such as ``wide`` or ``100x20``."""
    return pool if isinstance(pool, str) else f"{pool[0]:g}x{pool[1]:g}"


def _user_policies(options: CompareOptions) -> dict[str, TypedPolicy]:
    """Return the user's policies by name, as typed or by leader.

    Without `--name` a policy is called like its file without the ending. If that name is taken, it
    is called like the typed text.
    """
    texts, names = options.policy or [], options.name or []
    if names and len(names) != len(texts):
        counts = f"{len(names)} --name for {len(texts)} --policy"
        raise ParameterError(f"{counts}: name all of yours, in order, or none")
    policies: dict[str, TypedPolicy] = {}
    for index, text in enumerate(texts):
        is_per_leader = text.startswith("leader_")
        is_file = text.endswith(FILES) and not is_per_leader
        name = printable(names[index] if names else Path(text).stem if is_file else text)
        # Only a reference itself may have a reference's name.
        if name in policies or (name in REFERENCES and text != name):
            if names:
                raise ParameterError(f"--name {name} is not accepted: another policy has this name")
            name = printable(text)
        if name in policies:
            raise ParameterError(f"--policy {text} is given twice: give one another --name")
        policies[name] = text
        if is_per_leader:
            by_leader = changed_fields(text.split(","), "--policy")
            # A number becomes a text, so that it is refused like an unknown policy.
            policies[name] = {leader: str(value) for leader, value in by_leader.items()}
    return policies
