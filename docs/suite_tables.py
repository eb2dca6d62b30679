"""The tables of docs/suite.md: the tasks as declared, and the scores of docs/suite/v1.csv."""

from committed_data import interval, markdown, one, rows

from flockenv.comparison.suite import SUITES


def suite_tasks() -> str:
    """Return the tasks of suite v1."""
    body = [
        [
            f"`{task.name}`",
            task.meaning,
            str(task.parameters.n_boats),
            str(task.parameters.n_leaders),
            f"{task.parameters.bw_s:g}" if "bw_s" not in task.options else "drawn",
            f"{task.episode_s / 60:g}",
            f"{task.flock_hours:.0f}",
        ]
        for task in SUITES["v1"]
    ]
    header = ["task", "meaning", "boats", "leaders", "bw, s", "minutes per episode", "flock-hours"]
    return markdown(header, body)


def suite_scores() -> str:
    """Return the scores of every policy of suite v1."""
    file = "suite/v1.csv"
    policies = list(dict.fromkeys(row["policy"] for row in rows(file)))
    body = []
    for task in SUITES["v1"]:
        found = [one(file, policy=policy, task=task.name) for policy in policies]
        cells = [interval(row, "score", "score_low", "score_high", ".2f") for row in found]
        body.append([f"`{task.name}`", *cells])
    hours = [one(file, policy=policy, task=SUITES["v1"][0].name) for policy in policies]
    body.append(["flock-hours of making it", *(row["flock_hours"] for row in hours)])
    return markdown(["task", *policies], body)
