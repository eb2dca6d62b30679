"""`flockenv compare`: policies against each other, in the user's flocks or on frozen tasks."""

import json
import math
import shlex
import sys
import time
from dataclasses import replace

from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.cli.compare_entries import compare_entries
from flockenv.cli.compare_plan import CompareOptions, Plan, refuse_all_but
from flockenv.cli.console import console, echo, errors, print_json, warn
from flockenv.cli.options import takes
from flockenv.cli.output import prepare, printable
from flockenv.cli.progress import progress
from flockenv.comparison.levels import SUITE as LEVELS_SUITE
from flockenv.comparison.report import ComparisonReport, overlap_notes, policy_title
from flockenv.comparison.suite import scores_table

_TRIAL_FLOCKS = 16
_TRIAL_S = 60.0
_OPTIONS_OF_ENTRIES = ("entry", "trial_flocks", "suite", "task", "trust", "out", "as_json", "quiet")


@takes(CompareOptions)
def compare(options: CompareOptions) -> None:
    """Print and plot order against the number of leaders, for your policies and others.

    Runs each policy on the same seeds: 27 boats in the pool `wide`, at its critical noise, unless
    the options say otherwise. Differences are each policy minus each later one, yours first.
    Writes `runs.csv`, `means.csv`, `differences.csv`, `lines.csv`, `leader_curve.png`, `run.toml`
    (seeds, policies, environment), the parameters of each case for `--params`, and the card of
    your first policy, `card.md`.

    `--suite v2` scores policies on frozen tasks, into `scores.csv`. For each policy of a file it
    needs the flock-hours that made it (`--flock-hours`). `--suite v3` scores entries (`--entry`),
    into `entries.csv`.

    Example: `flockenv compare --policy mine.npz --name mine --pool narrow --n-leaders 0-3`
    """
    for package in ("matplotlib", "pandas", "scipy"):
        require(package, "plot")  # A missing one is found before hours of runs.
    if options.suite == LEVELS_SUITE:
        refuse_all_but(_OPTIONS_OF_ENTRIES, options)
        files, levels = options.entry or (), options.task or ()
        compare_entries(
            files, levels, options.trial_flocks, options.out, options, trust=options.trust
        )
        return
    plan = Plan.parse(options)
    prepare(options.out / "runs.csv")
    if options.suite and not options.hides_progress:
        minutes = math.ceil(_estimated_seconds(plan) / 60)
        hours = f"{plan.flock_hours:.0f} flock-hours"
        echo(f"{len(plan.cases)} tasks, {hours}: about {minutes} min here", errors)
    report = _run_cases(options, plan)
    if plan.user_policies:
        first_name = plan.user_policies[0]
        first_policy = plan.policies[plan.cases[0].name][first_name]
        write_text(options.out / "card.md", report.card(first_name, first_policy))
    for line in overlap_notes(report.runs):
        warn(line)
    tables = {"means": report.means, "differences": report.differences}
    if options.suite:
        scores = scores_table(report)
        tables["scores"] = scores.assign(flock_hours=scores["policy"].map(plan.training_hours))
        write_csv(options.out / "scores.csv", tables["scores"], float_format="%.4f")
    if options.as_json:
        print_json({n: json.loads(table.to_json(orient="records")) for n, table in tables.items()})
        return
    console.print(report.table())
    for row in tables["scores"].to_dict("records") if options.suite else []:
        score = f"{row['score']:+.3f} [{row['score_low']:+.3f}, {row['score_high']:+.3f}]"
        echo(f"{row['policy']}, {row['task']}: {score}")
    if options.full:
        echo(report.in_words())
    echo(f"Written to {options.out}")


def _estimated_seconds(plan: Plan) -> float:
    """Estimate the seconds that the cases take here: time each policy in a minute of few flocks."""
    total = 0.0
    for name in plan.names:
        cases = [case for case in plan.cases if name in plan.policies[case.name]]
        trial = replace(cases[0], seeds=cases[0].seeds[:_TRIAL_FLOCKS], episode_s=_TRIAL_S)
        start = time.perf_counter()
        trial.run({name: plan.policies[trial.name][name]})
        seconds_per_flock_hour = (time.perf_counter() - start) / trial.flock_hours(1)
        total += seconds_per_flock_hour * sum(case.flock_hours(1) for case in cases)
    return total


def _run_cases(options: CompareOptions, plan: Plan) -> ComparisonReport:
    """Run the cases, write a report after each, and return the last report.

    After Ctrl-C the report covers the policies and numbers of leaders that were finished.
    """
    cases, policies = plan.cases, plan.policies
    command = printable(shlex.join(["flockenv", *sys.argv[1:]]))
    titles = {
        case.name: {name: policy_title(policy) for name, policy in policies[case.name].items()}
        for case in cases
    }
    conditions = {"command": command, "policies": titles}
    finished: list[object] = []

    def write_report(**more_conditions: object) -> ComparisonReport:
        runs = require("pandas", "plot").concat(finished, ignore_index=True)
        runs.insert(0, "case", runs.pop("case"))
        cases_with_runs = [case for case in cases if case.name in set(runs["case"])]
        report = ComparisonReport(cases_with_runs, plan.names, runs, conditions | more_conditions)
        report.write(options.out)
        return report

    with progress("simulating", 3600 * plan.flock_hours, options.hides_progress) as advance:
        try:
            for case in cases:
                case.run(policies[case.name], advance, finished.append)
                report = write_report()
        except KeyboardInterrupt:
            if not finished:
                raise
            write_report(interrupted=True)
            pairs = "pair" if len(finished) == 1 else "pairs"
            stored = f"{len(finished)} {pairs} of a policy and a number of leaders"
            raise KeyboardInterrupt(f"{options.out} holds what was finished: {stored}.") from None
    return report
