"""`flockenv evaluate`."""

import json
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from flockenv._io.atomic_write import write_text
from flockenv.cli.console import console, finished_in, print_json, progress_bar, say
from flockenv.cli.output import check_folder, keep, printable, refuse_overwriting
from flockenv.cli.parameters import ChangesOption, FileOption, PresetOption, TrustOption
from flockenv.cli.pools import PoolOption, compared_flocks, pool_name
from flockenv.cli.suite import evaluate_suite, refuse_altered
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy

__all__ = ["evaluate"]

REFERENCES = ("steering law", "tuned damped law")


def evaluate(
    context: typer.Context,
    policy: Annotated[
        str,
        typer.Argument(
            help="Name of a policy, the .npz file of a learned one, or the .zip file of an SB3 "
            "model (with --trust)."
        ),
    ],
    against: Annotated[
        list[str] | None,
        typer.Option(help="What to compare with, repeatable. [steering law, tuned damped law]"),
    ] = None,
    trust: TrustOption = False,
    pool: PoolOption = None,
    preset: PresetOption = None,
    params: FileOption = None,
    changes: ChangesOption = None,
    leaders: Annotated[
        list[int] | None, typer.Option(min=1, help="Number of leaders, repeatable. [1 to 4]")
    ] = None,
    bw_s: Annotated[
        list[float] | None,
        typer.Option(help="Noise: length of the backward phase in s, repeatable. [critical]"),
    ] = None,
    alternate: Annotated[
        bool, typer.Option("--alternate", help="Directions alternate, 4 x 4 minutes (figure 7).")
    ] = False,
    dropout_rate: Annotated[
        float, typer.Option(help="Chance that the camera does not see a boat in a frame.")
    ] = 0.0,
    episodes: Annotated[int | None, typer.Option(min=2, help="Seeds for each case. [512]")] = None,
    minutes: Annotated[
        float | None, typer.Option(min=0.0, help="Length of an episode. [8; 16 with --alternate]")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0,
    suite: Annotated[
        str | None, typer.Option(help="Score the policy on the frozen tasks of a suite: v1.")
    ] = None,
    task: Annotated[
        list[str] | None, typer.Option(help="Of the suite, one task, repeatable. [every task]")
    ] = None,
    flock_hours: Annotated[
        float | None, typer.Option(help="With --suite: what making the policy has simulated.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for tables, pictures and the card.")] = Path(
        "results/evaluate"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the differences as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Compare one policy with others on the same seeds and write its model card.

    Runs 27 boats in both pools, at the critical noise of each, unless the parameters say otherwise.
    Writes `card.md` and, for each pool and backward duration, a folder with tables, picture,
    `run.toml` and the exact parameters, as `flockenv compare` does.

    With `--suite v1` the policy is scored on frozen tasks instead, and the options of flocks and
    episodes are refused.

    Example: `flockenv evaluate learned --pool narrow --leaders 3`
    """
    if suite is not None:
        refuse_altered(context, suite)
        evaluate_suite(
            policy, suite, task or [], flock_hours, out, trust=trust, as_json=as_json, quiet=quiet
        )
        return
    for option, value in (("--task", task), ("--flock-hours", flock_hours)):
        if value is not None:
            raise ParameterError(f"{option} is not accepted without --suite")

    from flockenv.comparison.model_card import model_card
    from flockenv.comparison.report import ComparisonReport, report

    options: dict[str, Any] = {"dropout_rate": dropout_rate} if dropout_rate else {}
    if alternate:
        options["target"] = "alternate"
    duration_s = 60.0 * (minutes if minutes is not None else 16.0 if alternate else 8.0)
    numbers = sorted(set(leaders or (1, 2, 3, 4)))
    seeds = range(seed, seed + (512 if episodes is None else episodes))
    flocks = _by_folder(compared_flocks(preset, params, changes, pool, bw_s))
    pools = {each.pool for each in flocks.values()}
    name, policies = _policies(policy, against, pools, trust)
    check_folder(out)
    refuse_overwriting(params, "--params", [out / each / "parameters.toml" for each in flocks])
    results: dict[str, ComparisonReport] = {}
    with finished_in(out, results), progress_bar(quiet or as_json) as progress:
        work = len(numbers) * len(seeds) * duration_s
        work *= sum(len(policies[each.pool]) for each in flocks.values())
        bar = progress.add_task("simulating", total=work)
        for folder, parameters in flocks.items():
            result = report(
                parameters,
                numbers,
                policies[parameters.pool],
                seeds,
                duration_s,
                lambda seconds: progress.advance(bar, seconds),
                options,
            )
            keep(out / folder, result.write)
            results[folder] = result
    card = model_card(
        name,
        policies[next(iter(pools))][name](),
        results,
        command=printable(shlex.join(["flockenv", *sys.argv[1:]])),
        seeds=seeds,
        duration_s=duration_s,
    )
    keep(out / "card.md", lambda path: write_text(path, card))
    if as_json:
        tables = {each: result.differences for each, result in results.items()}
        print_json({each: json.loads(t.to_json(orient="records")) for each, t in tables.items()})
        return
    for result in results.values():
        console.print(result.table(console.width))
        say(result.differences_in_words())
    say(f"Written to {out}")


def _policies(
    policy: str, against: list[str] | None, pools: set[Any], trust: bool
) -> tuple[str, dict[Any, dict[str, Callable[[], LeaderPolicy | str]]]]:
    """Return the name by which a policy is shown, and by pool and name all that are compared."""
    from flockenv.policies.registry import FILES, POOL_POLICIES, named_policy

    references = against or [each for each in REFERENCES if each != policy]
    if policy in references:
        raise ParameterError(f"{policy!r} is both the policy and one of those it is compared with")
    if policy in POOL_POLICIES and len(pools) > 1:
        raise ParameterError(
            f"{policy!r} is another policy in each pool: name one pool with --pool"
        )
    name = printable(Path(policy).stem if policy.endswith(FILES) else policy)
    if name in references:
        name = printable(policy)
    given = {printable(each): each for each in references} | {name: policy}
    return name, {
        pool: {shown: named_policy(each, pool, trust=trust) for shown, each in given.items()}
        for pool in pools
    }


def _by_folder(flocks: list[FlockParameters]) -> dict[str, FlockParameters]:
    """Return parameters by the name of the folder that each flock has its results in."""
    found: dict[str, FlockParameters] = {}
    for parameters in flocks:
        name = f"{pool_name(parameters)}-bw-{parameters.bw_s:g}"
        if name in found:
            raise ParameterError(
                f"--bw-s {parameters.bw_s!r} is not accepted beside {found[name].bw_s!r}: "
                "backward durations that differ in six digits"
            )
        found[name] = parameters
    return found
