"""`flockenv compare`."""

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from flockenv import FlockParameters
from flockenv.cli.console import console, progress_bar

__all__ = ["compare"]


class PoolChoice(StrEnum):
    """Pools that a comparison can be run in."""

    BOTH = "both"
    FIVE_HUNDRED_BOATS = "500-boats"
    TABLE_1 = "table-1"


DEFAULT_POLICIES = ("steering law",)


def compare(
    pool: Annotated[PoolChoice, typer.Option(help="Which pool.")] = PoolChoice.BOTH,
    preset: Annotated[str, typer.Option(help="Preset of the scene.")] = "simulation",
    boats: Annotated[int, typer.Option(help="Boats, leaders included.")] = 27,
    most_leaders: Annotated[int, typer.Option(min=1, help="Runs 0 to this many leaders.")] = 4,
    episodes: Annotated[int, typer.Option(min=2, help="Seeds for each number.")] = 64,
    minutes: Annotated[float, typer.Option(help="Length of an episode.")] = 8.0,
    bw_s: Annotated[
        float | None, typer.Option(help="Noise: length of the backward phase in s. [critical]")
    ] = None,
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="Policy to compare, repeatable: a name, or the .npz file of a learned one; "
            "differences are taken from the first. [steering law]"
        ),
    ] = None,
    target: Annotated[str, typer.Option(help="Direction: cw or ccw.")] = "cw",
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for tables and pictures.")] = Path(
        "results/compare"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the means as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Print and plot order against the number of leaders (figure 12).

    Runs without leaders, and with leaders that follow each policy, on the same seeds, at the
    critical noise of the pool. Writes `runs.csv`, `means.csv`, `lines.csv`, `differences.csv`,
    `leader_curve.png` and `parameters.toml` for each pool.

    Example: `flockenv compare --pool table-1 --policy "steering law" --policy "damped law"`
    """
    from flockenv.comparison import named_policy
    from flockenv.comparison_report import report

    policies = {name: named_policy(name) for name in policy or DEFAULT_POLICIES}
    pools = [choice.value for choice in PoolChoice if choice != PoolChoice.BOTH]
    chosen = pools if pool == PoolChoice.BOTH else [pool.value]
    base = FlockParameters.preset(preset).replace(n_boats=boats, target=target)
    scenes = {
        name: base.replace(
            pool=name,
            bw_s=FlockParameters.critical_bw_s(preset, name) if bw_s is None else bw_s,
        )
        for name in chosen
    }
    runs = 1 + most_leaders * len(policies)
    work = len(scenes) * runs * episodes * minutes * 60
    results = {}
    with progress_bar(quiet or as_json) as progress:
        task = progress.add_task("simulating", total=work)
        for name, scene in scenes.items():
            results[name] = report(
                scene,
                range(most_leaders + 1),
                policies,
                range(seed, seed + episodes),
                minutes * 60,
                out / name,
                lambda seconds: progress.advance(task, seconds),
            )
    if as_json:
        means = {name: each.means.to_json(orient="records") for name, each in results.items()}
        console.print_json(data={name: json.loads(text) for name, text in means.items()})
        return
    for name, result in results.items():
        console.print(result.table())
        words = [result.lines_in_words(), result.differences_in_words()]
        console.print("\n".join(filter(None, words)), highlight=False, soft_wrap=True)
        console.print(f"Written to {out / name}\n", highlight=False, soft_wrap=True)
