"""`flockenv compare`: policies against each other, in flocks of one's own or on frozen tasks."""

import json
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.cli.compare_options import (
    REFERENCES,
    CompareOptions,
    cases_of,
    is_file,
    own_policies,
)
from flockenv.cli.console import console, errors, finished_in, print_json, progress_bar, say
from flockenv.cli.options import takes
from flockenv.cli.output import check_folder, keep, printable, refuse_overwriting
from flockenv.comparison.suite import REFERENCE
from flockenv.errors import ParameterError

if TYPE_CHECKING:
    import pandas as pd

    from flockenv.comparison.case import Case
    from flockenv.comparison.report import ComparisonReport

__all__ = ["compare"]

Policies = dict[str, dict[str, Any]]
"""What steers, as `compare_leaders` takes it, by case and by name."""


@takes(CompareOptions)
def compare(options: CompareOptions) -> None:
    """Print and plot order against the number of leaders, for your policies and others.

    Runs each policy on the same seeds: 27 boats in both pools, at the critical noise of each,
    unless the options say otherwise. Differences are those of your first policy from the others.
    Writes `runs.csv`, `means.csv`, `differences.csv`, `lines.csv`, `leader_curve.png`, `run.toml`
    (seeds, policies, environment), the parameters of each case, which `--params` reads, and the
    card of your first policy, `card.md`.

    With `--suite v2` policies are scored on frozen tasks: `scores.csv`, and `entry.toml` for yours.

    Example: `flockenv compare --policy mine.npz --name mine --pool narrow --leaders 0-3`
    """
    for package in ("matplotlib", "pandas", "scipy"):  # All of them before hours of runs.
        require(package, "plot")
    cases, own = cases_of(options), own_policies(options)
    policies = {case.name: _policies(case.parameters.pool, own, options) for case in cases}
    check_folder(options.out)
    written = [options.out / f"{case.name}.toml" for case in cases]
    refuse_overwriting(options.params, "--params", written)
    for given in filter(is_file, own.values()):
        refuse_overwriting(given, "--policy", written)
    result = _compared(options, cases, policies)
    scores = _scores(options, result, own, policies) if options.suite else None
    if own:
        _write_card(options, result, next(iter(own)), policies)
    _print(options, result, scores)


def _compared(
    options: CompareOptions, cases: "list[Case]", policies: Policies
) -> "ComparisonReport":
    """Run the cases and return their report; it is written whenever a case is finished."""
    from flockenv.comparison.report import joined, report

    names = list(dict.fromkeys(name for each in policies.values() for name in each))
    conditions = {"command": printable(shlex.join(["flockenv", *sys.argv[1:]]))}
    shown = {
        case.name: {name: str(steers) for name, steers in _made(case, policies).items()}
        for case in cases
    }
    finished: dict[str, Any] = {}
    with finished_in(options.out, finished), progress_bar(options.shows_nothing) as progress:
        hours = sum(case.flock_hours(len(policies[case.name])) for case in cases)
        bar = progress.add_task("simulating", total=3600 * hours)
        for case in cases:
            runs = case.run(policies[case.name], lambda seconds: progress.advance(bar, seconds))
            every = joined([*finished.values(), runs])
            done = cases[: len(finished) + 1]
            result = report(done, names, every, {**conditions, "policies": shown})
            keep(options.out, result.write)
            finished[case.name] = runs
    return result


def _made(case: "Case", policies: Policies) -> dict[str, Any]:
    from flockenv.comparison.episodes import steering

    pool = case.parameters.pool
    return {name: steering(policy, pool) for name, policy in policies[case.name].items()}


def _policies(pool: Any, own: Mapping[str, Any], options: CompareOptions) -> dict[str, Any]:
    """Return the policies of a case by name, the user's first; those not for its pool are told."""
    found = {name: _read(given, pool, options.trust) for name, given in own.items()}
    if options.suite:
        return found | {REFERENCE: _read(REFERENCE, pool, options.trust)}
    for name in () if options.only else REFERENCES:
        try:
            found.setdefault(name, _read(name, pool, options.trust))
        except ParameterError as error:
            say(f"Left out, {name}: {error}", errors)
    if not found:
        raise ParameterError("--only is not accepted without --policy: nothing would be compared")
    return found


def _read(given: Any, pool: Any, trust: bool) -> Any:
    from flockenv.policies.registry import named_policy

    if isinstance(given, Mapping):
        return {leader: _read(each, pool, trust) for leader, each in given.items()}
    try:
        return named_policy(given, pool, trust=trust)
    except OSError as error:
        raise ParameterError(f"--policy {given} cannot be read: {error.strerror}") from error


def _scores(
    options: CompareOptions, result: "ComparisonReport", own: Mapping[str, Any], policies: Policies
) -> "pd.DataFrame":
    """Write the scores, and an entry if the first policy is a file; return the scores."""
    from flockenv.comparison.suite import scores_table, write_entry

    scores = scores_table(result)
    path = options.out / "scores.csv"
    keep(path, lambda path: write_csv(path, scores, float_format="%.4f"))
    name, given = next(iter(own.items()), ("", None))
    hours = options.flock_hours
    if is_file(given) and hours is not None:
        provenance = getattr(_made(result.cases[0], policies)[name], "provenance", {})
        entry = (name, Path(given), hours, provenance)
        keep(options.out / "entry.toml", lambda path: write_entry(path.parent, *entry))
    return scores


def _write_card(
    options: CompareOptions, result: "ComparisonReport", name: str, policies: Policies
) -> None:
    from flockenv.comparison.model_card import model_card

    policy = _made(result.cases[0], policies)[name]
    card = model_card(name, policy, result, result.conditions["command"])
    keep(options.out / "card.md", lambda path: write_text(path, card))


def _print(
    options: CompareOptions, result: "ComparisonReport", scores: "pd.DataFrame | None"
) -> None:
    if options.as_json:
        tables = {"means": result.means, "differences": result.differences, "scores": scores}
        found = {name: table for name, table in tables.items() if table is not None}
        print_json({n: json.loads(table.to_json(orient="records")) for n, table in found.items()})
        return
    console.print(result.table())
    for row in [] if scores is None else scores.to_dict("records"):
        ends = f"{row['score']:+.3f} [{row['score_low']:+.3f}, {row['score_high']:+.3f}]"
        say(f"{row['policy']}, {row['task']}: {ends}")
    if options.full:
        say(result.in_words())
    say(f"Written to {options.out}")
