"""`flockenv compare`."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from flockenv.cli.console import console, errors, finished_in, print_json, progress_bar, say
from flockenv.cli.output import check_folder, keep, printable, refuse_overwriting
from flockenv.cli.parameters import ChangesOption, FileOption, PresetOption, TrustOption
from flockenv.cli.pools import PoolOption, compared_flocks, pool_name
from flockenv.errors import ParameterError
from flockenv.policies.base import LeaderPolicy

__all__ = ["compare"]

DEFAULT_POLICIES = ("steering law", "tuned damped law", "learned")


def compare(
    pool: PoolOption = None,
    preset: PresetOption = None,
    params: FileOption = None,
    changes: ChangesOption = None,
    most_leaders: Annotated[int, typer.Option(min=1, help="Runs 0 to this many leaders.")] = 4,
    episodes: Annotated[int, typer.Option(min=2, help="Seeds for each number.")] = 64,
    minutes: Annotated[float, typer.Option(min=0.0, help="Length of an episode.")] = 8.0,
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="Policy to compare, repeatable: a name, the .npz file of a learned one, or the "
            ".zip file of an SB3 model (with --trust); differences are taken from the first. "
            "[steering law, tuned damped law, learned]"
        ),
    ] = None,
    trust: TrustOption = False,
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for tables and pictures.")] = Path(
        "results/compare"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the means as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Print and plot order against the number of leaders (figure 12).

    Runs without leaders, and with leaders that follow each policy, on the same seeds: 27 boats in
    both pools, at the critical noise of each, unless the parameters say otherwise. Writes
    `runs.csv`, `means.csv`, `lines.csv`, `differences.csv`, `leader_curve.png`, `run.toml` (seeds,
    policies, environment) and the exact parameters, which `--params` reads, for each pool.

    Example: `flockenv compare --pool narrow --policy "damped law" --set bw_s=0.4`
    """
    from flockenv.comparison.report import ComparisonReport, report
    from flockenv.policies.registry import named_policy

    found = compared_flocks(preset, params, changes, pool)
    policies = {
        pool_name(parameters): {
            printable(name): named_policy(name, parameters.pool, trust=trust) for name in policy
        }
        if policy
        else _default_policies(parameters.pool)
        for parameters in found
    }
    check_folder(out)
    refuse_overwriting(params, "--params", [out / name / "parameters.toml" for name in policies])
    runs = sum(1 + most_leaders * len(each) for each in policies.values())
    work = runs * episodes * minutes * 60
    results: dict[str, ComparisonReport] = {}
    with finished_in(out, results), progress_bar(quiet or as_json) as progress:
        task = progress.add_task("simulating", total=work)
        for parameters in found:
            name = pool_name(parameters)
            result = report(
                parameters,
                range(most_leaders + 1),
                policies[name],
                range(seed, seed + episodes),
                minutes * 60,
                lambda seconds: progress.advance(task, seconds),
            )
            keep(out / name, result.write)
            results[name] = result
    if as_json:
        means = {name: each.means.to_json(orient="records") for name, each in results.items()}
        print_json({name: json.loads(text) for name, text in means.items()})
        return
    for name, result in results.items():
        console.print(result.table(console.width))
        words = [result.lines_in_words(), result.differences_in_words()]
        say("\n".join(filter(None, words)))
        say(f"Written to {out / name}\n")


def _default_policies(pool: Any) -> dict[str, Callable[[], LeaderPolicy | str]]:
    """Return the default policies: those made for a pool only where there are such."""
    from flockenv.policies.registry import named_policy

    policies = {}
    for name in DEFAULT_POLICIES:
        try:
            policies[name] = named_policy(name, pool)
        except ParameterError as error:
            say(f"Left out, {name}: {error}", errors)
    return policies
