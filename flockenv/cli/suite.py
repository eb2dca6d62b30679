"""`flockenv evaluate --suite`: the score of one policy on frozen tasks."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w
import typer
from rich.table import Table

from flockenv._core import __version__
from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.cli.console import console, finished_in, print_json, progress_bar, say
from flockenv.cli.output import check_folder, keep, printable
from flockenv.errors import ParameterError

if TYPE_CHECKING:
    from flockenv.comparison.suite import Score, Task

__all__ = ["evaluate_suite", "refuse_altered"]

_SUITE_PARAMETERS = ["policy", "trust", "suite", "task", "flock_hours", "out", "as_json", "quiet"]


def evaluate_suite(
    policy: str,
    suite: str,
    names: list[str],
    flock_hours: float | None,
    out: Path,
    *,
    trust: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run the tasks of a suite with one policy, print its scores and write them.

    Writes `scores.csv` (a row per task), `episodes.csv` (the signed order of each episode) and
    `run.toml` (policy, suite, flock-hours, versions and command).

    Raises
    ------
    ParameterError
        For an unknown suite, task or policy, and for flock-hours out of range; nothing is run then.
    """
    from flockenv.comparison.suite import budget_class, run_task, score, scores_table, tasks_named
    from flockenv.policies.model import as_policy
    from flockenv.policies.registry import named_policy

    require("pandas", "plot")
    tasks = tasks_named(suite, names)
    budget = None if flock_hours is None else budget_class(flock_hours)
    policies = {task.name: named_policy(policy, task.pool, trust=trust) for task in tasks}
    steering = {task.name: str(as_policy(policies[task.name]())) for task in tasks}
    check_folder(out)
    episodes: list[tuple[Task, Any]] = []
    scores: dict[str, Score] = {}
    with finished_in(out, scores), progress_bar(quiet or as_json) as progress:
        bar = progress.add_task("simulating", total=3600 * sum(each.flock_hours for each in tasks))
        for task in tasks:
            orders = run_task(task, policies[task.name], lambda s: progress.advance(bar, s))
            episodes.append((task, orders))
            scores[task.name] = score(task, orders)
            keep(out / "episodes.csv", lambda path: _write_episodes(path, episodes))
    table = scores_table(printable(policy), scores)
    keep(out / "scores.csv", lambda path: write_csv(path, table))
    run: dict[str, Any] = {"flockenv": __version__, "suite": suite, "policies": steering}
    if budget is not None:
        run |= {"flock_hours": float(flock_hours or 0.0), "budget_flock_hours": budget}
    run["command"] = printable(shlex.join(["flockenv", *sys.argv[1:]]))
    keep(out / "run.toml", lambda path: write_text(path, tomli_w.dumps(run)))
    if as_json:
        print_json({"suite": suite, "scores": table.to_dict(orient="records")})
        return
    console.print(_printed(printable(policy), suite, tasks, scores))
    say(f"Written to {out}")


def refuse_altered(context: typer.Context, suite: str) -> None:
    """Refuse options that would make another task of one in a suite.

    Raises
    ------
    ParameterError
        For the first option of the command that was given and is none of the suite's.
    """
    for each in context.command.params:
        source = context.get_parameter_source(str(each.name))
        is_given = source is not None and source.name == "COMMANDLINE"
        if is_given and each.name not in _SUITE_PARAMETERS:
            raise ParameterError(
                f"{each.opts[0]} is not accepted with --suite {suite}, whose tasks fix it: there "
                "is no score of an altered task"
            )


def _write_episodes(path: Path, episodes: "list[tuple[Task, Any]]") -> None:
    pandas = require("pandas", "plot")
    table = pandas.concat(
        [
            pandas.DataFrame({"task": task.name, "seed": task.seeds, "signed_order": orders})
            for task, orders in episodes
        ]
    )
    write_csv(path, table)


def _printed(policy: str, suite: str, tasks: "list[Task]", scores: "dict[str, Score]") -> Table:
    table = Table(title=f"{policy}, suite {suite}", title_justify="left", caption_justify="left")
    table.caption = "score 0: the paper's law; score 1: the tuned damped law"
    for column in ("task", "signed order", "score"):
        table.add_column(column, no_wrap=True)
    for task in tasks:
        each = scores[task.name]
        interval = f"{each.score:.2f} [{each.low:.2f}, {each.high:.2f}]"
        table.add_row(task.name, f"{each.signed_order:.3f}", interval)
    return table
