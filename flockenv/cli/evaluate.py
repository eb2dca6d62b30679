"""`flockenv evaluate`."""

import json
import shlex
import sys
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

__all__ = ["evaluate"]

REFERENCES = ("steering law", "tuned damped law")


def evaluate(
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

    Example: `flockenv evaluate learned --pool table-1 --leaders 3`
    """
    if suite is not None:
        altered: dict[str, object] = {
            "--against": against,
            "--pool": pool,
            "--preset": preset,
            "--params": params,
            "--set": changes,
            "--leaders": leaders,
            "--bw-s": bw_s,
            "--alternate": alternate,
            "--dropout-rate": dropout_rate,
            "--episodes": episodes,
            "--minutes": minutes,
            "--seed": seed,
        }
        refuse_altered(suite, altered)
        names = task or []
        evaluate_suite(
            policy, suite, names, flock_hours, out, trust=trust, as_json=as_json, quiet=quiet
        )
        return
    for option, value in (("--task", task), ("--flock-hours", flock_hours)):
        if value is not None:
            raise ParameterError(f"{option} is not accepted without --suite")

    from flockenv.comparison.model_card import model_card
    from flockenv.comparison.report import ComparisonReport, report
    from flockenv.policies.registry import FILES, POOL_POLICIES, named_policy

    references = list(against or (each for each in REFERENCES if each != policy))
    if policy in references:
        raise ParameterError(f"{policy!r} is both the policy and one of those it is compared with")
    name = printable(Path(policy).stem if policy.endswith(FILES) else policy)
    if name in references:
        name = printable(policy)
    named = {printable(each): each for each in references} | {name: policy}
    options: dict[str, Any] = {"dropout_rate": dropout_rate} if dropout_rate else {}
    if alternate:
        options["target"] = "alternate"
    duration_s = 60.0 * (minutes if minutes is not None else 16.0 if alternate else 8.0)
    numbers = sorted(set(leaders or (1, 2, 3, 4)))
    count = 512 if episodes is None else episodes
    seeds = range(seed, seed + count)
    found = _by_folder(compared_flocks(preset, params, changes, pool, bw_s))
    pools = {each.pool for each in found.values()}
    if policy in POOL_POLICIES and len(pools) > 1:
        raise ParameterError(
            f"{policy!r} is another policy in each pool: name one pool with --pool"
        )
    policies = {
        each: {shown: named_policy(given, each, trust=trust) for shown, given in named.items()}
        for each in pools
    }
    check_folder(out)
    refuse_overwriting(params, "--params", [out / each / "parameters.toml" for each in found])
    results: dict[str, ComparisonReport] = {}
    with finished_in(out, results), progress_bar(quiet or as_json) as progress:
        work = len(found) * len(numbers) * len(named) * count * duration_s
        bar = progress.add_task("simulating", total=work)
        for folder, parameters in found.items():
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
        data = {
            folder: json.loads(each.differences.to_json(orient="records"))
            for folder, each in results.items()
        }
        print_json(data)
        return
    for each in results.values():
        console.print(each.table(console.width))
        say(each.differences_in_words())
    say(f"Written to {out}")


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
