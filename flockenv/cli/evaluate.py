"""`flockenv evaluate`."""

import json
import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from flockenv import FlockParameters, ParameterError
from flockenv.cli.compare import PoolChoice
from flockenv.cli.console import console, progress_bar

__all__ = ["evaluate"]

REFERENCES = ("steering law", "damped law")


def evaluate(
    policy: Annotated[
        str, typer.Argument(help="Name of a policy, or the .npz file of a learned one.")
    ],
    against: Annotated[
        list[str] | None,
        typer.Option(help="What to compare with, repeatable. [steering law, damped law]"),
    ] = None,
    pool: Annotated[PoolChoice, typer.Option(help="Which pool.")] = PoolChoice.BOTH,
    preset: Annotated[str, typer.Option(help="Preset of the scene.")] = "simulation",
    boats: Annotated[int, typer.Option(help="Boats, leaders included.")] = 27,
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
        float, typer.Option(help="Chance that the camera misses a boat in a frame.")
    ] = 0.0,
    episodes: Annotated[int, typer.Option(min=2, help="Seeds for each case.")] = 512,
    minutes: Annotated[
        float | None, typer.Option(help="Length of an episode. [8; 16 with --alternate]")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for tables, pictures and the card.")] = Path(
        "results/evaluate"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the differences as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Compare one policy with others on the same seeds and write its model card.

    Writes `card.md` and, for each pool and noise level, a folder with the tables and the picture of
    `flockenv compare`.

    Example: `flockenv evaluate baselines/policies/table-1.npz --pool table-1 --leaders 3`
    """
    from flockenv.comparison import named_policy
    from flockenv.comparison_report import report
    from flockenv.model_card import model_card
    from flockenv.whole_file import whole_file

    references = list(against or REFERENCES)
    if policy in references:
        raise ParameterError(f"{policy!r} is both the policy and one of those it is compared with")
    name = Path(policy).stem if policy.endswith(".npz") else policy
    policies = {each: named_policy(each) for each in references} | {name: named_policy(policy)}
    options: dict[str, Any] = {"dropout_rate": dropout_rate} if dropout_rate else {}
    if alternate:
        options["target"] = "alternate"
    duration_s = 60.0 * (minutes if minutes is not None else 16.0 if alternate else 8.0)
    numbers = sorted(set(leaders or (1, 2, 3, 4)))
    seeds = range(seed, seed + episodes)
    scenes = _scenes(preset, pool, boats, bw_s)
    results = {}
    with progress_bar(quiet or as_json) as progress:
        work = len(scenes) * len(numbers) * len(policies) * episodes * duration_s
        task = progress.add_task("simulating", total=work)
        for scene_name, scene in scenes.items():
            results[scene_name] = report(
                scene,
                numbers,
                policies,
                seeds,
                duration_s,
                out / scene_name,
                lambda seconds: progress.advance(task, seconds),
                options,
            )
    card = model_card(
        name,
        policies[name](),
        results,
        command=shlex.join(["flockenv", *sys.argv[1:]]),
        seeds=seeds,
        duration_s=duration_s,
    )
    with whole_file(out / "card.md") as file:
        file.write(card.encode())
    if as_json:
        found = {
            scene: json.loads(each.differences.to_json(orient="records"))
            for scene, each in results.items()
        }
        console.print_json(data=found)
        return
    for each in results.values():
        console.print(each.table())
        console.print(each.differences_in_words(), highlight=False, soft_wrap=True)
    console.print(f"Written to {out}", highlight=False, soft_wrap=True)


def _scenes(
    preset: str, pool: PoolChoice, boats: int, bw_s: list[float] | None
) -> dict[str, FlockParameters]:
    pools = [each.value for each in PoolChoice if each != PoolChoice.BOTH]
    base = FlockParameters.preset(preset).replace(n_boats=boats)
    return {
        f"{name}-bw-{noise:g}": base.replace(pool=name, bw_s=noise)
        for name in (pools if pool == PoolChoice.BOTH else [pool.value])
        for noise in bw_s or [FlockParameters.critical_bw_s(preset, name)]
    }
