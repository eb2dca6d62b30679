"""`flockenv signal`."""

import csv
import io
import shlex
import sys
import time
from pathlib import Path
from typing import Annotated, Any

import tomli_w
import typer
from rich.table import Table

from flockenv._io.atomic_write import write_text
from flockenv._io.provenance import provenance_of
from flockenv.cli.console import console, finished_in, print_json, progress_bar, say
from flockenv.cli.output import check_folder, keep, printable, refuse_overwriting
from flockenv.cli.parameters import ChangesOption, FileOption, PresetOption, TrustOption
from flockenv.cli.pools import PoolOption, compared_flocks
from flockenv.errors import ParameterError

__all__ = ["signal"]


def signal(
    reward: Annotated[
        list[str] | None,
        typer.Option(
            help='Reward, repeatable: a term, or weights such as "jam=1,signed_order=2". '
            "[signed_order]"
        ),
    ] = None,
    horizon: Annotated[
        list[float] | None,
        typer.Option(help="Time in s over which returns are discounted, repeatable. [8, 30]"),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="Policy that explores, or a number for a constant action. [steering law; 0 for "
            "leans and headings]",
        ),
    ] = None,
    towards: Annotated[
        str | None,
        typer.Option(
            "--to", help="Where the direction goes. [tuned damped law; 1 for leans and headings]"
        ),
    ] = None,
    action_mode: Annotated[
        str, typer.Option(help='What actions stand for: "rudder", "heading" or "lean".')
    ] = "rudder",
    deviation: Annotated[
        float, typer.Option(help="Standard deviation of the exploration, in units of the action.")
    ] = 0.3,
    shared: Annotated[
        bool, typer.Option("--shared", help="All leaders of a flock explore with one noise.")
    ] = False,
    weights: Annotated[
        bool,
        typer.Option(
            "--weights",
            help="The noise perturbs the weights of the last layer of the network that --to "
            "names (an .npz file of a training), and not the action (gSDE).",
        ),
    ] = False,
    hold_s: Annotated[
        float | None, typer.Option(help="Time in s that a noise is held. [one decision]")
    ] = None,
    decision_period_s: Annotated[
        float | None, typer.Option(help="Time in s between decisions. [one control step]")
    ] = None,
    control_hz: Annotated[float, typer.Option(help="Control steps per second.")] = 10.0,
    pool: PoolOption = None,
    preset: PresetOption = None,
    params: FileOption = None,
    changes: ChangesOption = None,
    physics: Annotated[
        str, typer.Option(help='"training" steps coarser and cheaper, "default" as it is.')
    ] = "training",
    leaders: Annotated[int, typer.Option(min=1, help="Number of leaders.")] = 3,
    flocks: Annotated[int, typer.Option(min=4, help="Flocks at a time, an even number.")] = 64,
    rounds: Annotated[int, typer.Option(min=1, help="How often as many flocks start.")] = 2,
    minutes: Annotated[float, typer.Option(min=0.0, help="Length of an episode.")] = 4.0,
    seed: Annotated[int, typer.Option(min=0, help="Number of the measurement.")] = 0,
    trust: TrustOption = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder for `signals.csv`. [nothing is written]")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the signals as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Measure how clearly samples show the policy gradient along a direction.

    Leaders explore about one policy. The significance z of the gradient along the direction to the
    other policy is printed per million samples, a sample being one leader's decision: positive
    where the reward grows that way, and 2 where a million samples just show it. Every reward and
    horizon is measured on the same flocks: 27 boats in both pools, at the critical noise of each,
    unless the parameters say otherwise.

    Example: `flockenv signal --pool table-1 --reward leader_velocity --reward signed_order`
    """
    from flockenv.comparison.signal import SignalSettings, measured_signals

    started = time.perf_counter()
    settings = SignalSettings(
        rewards=dict(_weights(text) for text in reward or ["signed_order"]),
        horizons_s=horizon or [8.0, 30.0],
        deviation=deviation,
        hold_s=hold_s,
        shared=shared,
        weights=weights,
        flocks=flocks,
        rounds=rounds,
        duration_s=60.0 * minutes,
        options={
            "action_mode": action_mode,
            "decision_period_s": decision_period_s,
            "control_hz": control_hz,
            "physics": physics,
        },
        seed=seed,
    )
    laws = action_mode == "rudder"
    names = (
        start or ("steering law" if laws else "0"),
        towards or ("tuned damped law" if laws else "1"),
    )
    found = compared_flocks(preset, params, changes, pool)
    if out is not None:
        check_folder(out)
        refuse_overwriting(params, "--params", [out / "signals.csv", out / "run.toml"])
    signals: list[Any] = []
    finished: dict[str, Any] = {}
    with finished_in(out or Path(), finished), progress_bar(quiet or as_json) as bar:
        work = len(found) * rounds * flocks * settings.duration_s
        task = bar.add_task("simulating", total=work)
        for parameters in found:
            start_policy, end_policy = (
                _policy(name, action_mode, parameters.pool, trust) for name in names
            )
            signals += measured_signals(
                parameters.replace(n_leaders=leaders),
                start_policy,
                end_policy,
                settings,
                lambda seconds: bar.advance(task, seconds),
            )
    rows = [each.row() for each in signals]
    if out is not None:
        command = printable(shlex.join(["flockenv", *sys.argv[1:]]))
        samples = sum({(each.pool, each.samples): each.samples for each in signals}.values())
        wall_s = time.perf_counter() - started
        provenance = provenance_of(command, seed=seed, samples=samples, wall_s=wall_s)
        keep(out / "signals.csv", lambda path: write_text(path, _as_csv(rows)))
        keep(out / "run.toml", lambda path: write_text(path, tomli_w.dumps(provenance)))
    if as_json:
        print_json(rows)
        return
    console.print(_table(rows))
    if out is not None:
        say(f"Written to {out}")


def _weights(text: str) -> tuple[str, dict[str, float]]:
    """Return a reward's name and weights: `text` is a term, or terms with their weights."""
    weights = {}
    for part in text.split(","):
        name, given, value = part.partition("=")
        try:
            weights[name.strip()] = float(value) if given else 1.0
        except ValueError as error:
            raise ParameterError(
                f"--reward {text} is not accepted: {value!r} is no weight"
            ) from error
    return text, weights


def _policy(name: str, action_mode: str, pool: Any, trust: bool) -> Any:
    """Return a policy by name or file, or the constant action of a number."""
    from flockenv.comparison.signal import ConstantAction
    from flockenv.policies.model import as_policy
    from flockenv.policies.registry import named_policy

    try:
        value = float(name)
    except ValueError:
        policy = named_policy(name, pool, trust=trust)()
        if isinstance(policy, str):
            raise ParameterError(
                f"{name!r} is not accepted: it steers at every substep, outside of the environment"
            ) from None
        return as_policy(policy)
    return ConstantAction(value, action_mode)


def _as_csv(rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _table(rows: list[dict[str, Any]]) -> Table:
    table = Table("pool", "action", "reward", "horizon", "z per million samples", "samples")
    for row in rows:
        table.add_row(
            str(row["pool"]),
            row["action_mode"],
            row["reward"],
            f"{row['horizon_s']:g} s",
            f"{row['z_per_million']:+.2f} ± {row['error']:.2f}",
            str(row["samples"]),
        )
    return table
