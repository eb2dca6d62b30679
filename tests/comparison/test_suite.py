"""Law: a task never changes, and a score is a difference from the tuned law on the same flocks."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.comparison import suite
from flockenv.comparison.report import ComparisonReport
from flockenv.comparison.suite import (
    EPISODES,
    REFERENCE,
    TASK_IDS,
    TASKS,
    aggregate,
    scores_table,
    tasks_named,
)
from flockenv.errors import ParameterError
from flockenv.policies import policy
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds

FIELDS = ("n_boats", "n_leaders", "pool", "bw_s", "target", "scheme", "noise_scheme", "dt_s")
IMPROVED = "probability of improvement"
FROZEN = "f9efa0640fa636e7"
"""Of all that makes the tasks; another digest is another suite."""


def test_tasks_never_change() -> None:
    frozen = [
        (
            task.name,
            {name: str(getattr(task.parameters, name)) for name in FIELDS},
            task.leaders,
            (task.seeds[0], len(task.seeds)),
            task.episode_s,
            {name: str(value) for name, value in task.environment.items()},
            task.targets,
        )
        for task in TASKS
    ]
    digest = hashlib.sha256(json.dumps(frozen, sort_keys=True).encode()).hexdigest()
    assert digest[:16] == FROZEN


@pytest.mark.parametrize(("name", "env_id"), TASK_IDS.items())
def test_an_id_gives_what_the_suite_scores(name: str, env_id: str) -> None:
    """Bit for bit, from the first observation to the summary, alone and as a vector of flocks."""
    (task,) = tasks_named("v2", [name])
    seeds, targets = task.seeds[:2], task.targets or (task.parameters.target,) * 2
    scored = replace(task, seeds=seeds).run({REFERENCE: REFERENCE})["signed_order"].tolist()
    law = policy(REFERENCE, task.parameters.pool)

    env = gymnasium.make(env_id)
    options = {"target": targets[0], **task.environment, "episode_s": task.episode_s}
    own = flockenv.LeadersEnv(params=task.parameters, **options)
    assert env.unwrapped.parameters == own.parameters
    assert env.unwrapped._batch.settings == own._batch.settings
    observation, _ = env.reset(seed=seeds[0])
    over, info = False, {}
    while not over:
        observation, _, _, over, info = env.step(law.predict(observation)[0])
    assert info["episode_summary"]["signed_order"] == scored[0]

    many = gymnasium.make_vec(env_id, num_envs=2)
    exchanged = {"target": list(targets)} if task.targets else None
    observation, _ = many.reset(seed=seeds[0], options=exchanged)
    ends = np.zeros(2, bool)
    while not ends.any():
        observation, _, _, ends, info = many.step(law.predict(observation)[0])
    assert info["episode_summary"]["signed_order"].tolist() == scored


def test_the_seeds_are_those_of_the_release_and_judge_policies() -> None:
    seeds = release_seeds("v0.1.0", EPISODES)
    # SHA-256 of the tag, written out: 8 bytes modulo 2^32 - 256.
    assert seeds[0] == int("8c807b66253a6143", 16) % (2**32 - EPISODES)
    assert all(task.seeds == seeds for task in TASKS)
    assert all(seed in POLICY_SEEDS["evaluation"].every for seed in seeds)
    assert release_seeds("v0.2.0", EPISODES)[0] not in seeds
    with pytest.raises(ParameterError, match="count = 0"):
        release_seeds("v0.1.0", 0)


def test_flocks_that_follow_the_reference_score_nothing() -> None:
    """Scores: 0 for the reference, and the shift for orders that are shifted."""
    rng = np.random.default_rng(1)
    rows = []
    for case in ("a", "b"):
        theirs = rng.normal(0.4, 0.2, 200)
        for name, orders in ((REFERENCE, theirs), ("same", theirs), ("better", theirs + 0.1)):
            rows += [
                {"case": case, "policy": name, "seed": seed, "signed_order": order}
                for seed, order in enumerate(orders)
            ]
    result = ComparisonReport((), (), pd.DataFrame(rows))
    found = scores_table(result).set_index(["policy", "task"])
    for task in ("a", "b", "interquartile mean"):
        assert found.loc[("same", task), ["score", "score_low"]].tolist() == [0.0, 0.0]
        assert found.loc[("better", task), "score"] == pytest.approx(0.1)
    assert found.loc[("same", "probability of improvement"), "score"] == 0.5
    assert found.loc[("better", "probability of improvement"), "score"] == 1.0
    assert REFERENCE not in found.index.get_level_values("policy")


def test_the_aggregate_is_of_the_middle_and_has_an_interval_that_holds() -> None:
    # On paper: the middle half of 0, 1, ..., 7 is 2, 3, 4 and 5, whatever the greatest is.
    tasks = [np.array([0.0, 7e9, 2.0, 4.0]), np.array([1.0, 3.0, 5.0, 6.0])]
    assert aggregate(tasks)["interquartile mean"][0] == 3.5
    assert aggregate(tasks)[IMPROVED][0] == pytest.approx((0.875 + 1.0) / 2)
    rng = np.random.default_rng(3)
    covered = 0
    for _ in range(60):
        drawn = [rng.normal(0.1 * task, 1.0, 40) for task in range(2)]
        _, low, high = aggregate(drawn)[IMPROVED]
        # P(x > 0) of normal values about 0 and 0.1 is 1/2 and 0.5398.
        covered += low <= 0.5199 <= high
    # Binomial with n = 60 and 0.95: 49 or fewer has a chance of about 1e-4.
    assert covered >= 50


def test_a_policy_is_scored_on_every_task(cli, tmp_path: Path, monkeypatch) -> None:
    small = [
        replace(task, parameters=task.parameters.replace(n_boats=6), seeds=task.seeds[:4])
        for task in TASKS
    ]
    monkeypatch.setattr(suite, "TASKS", tuple(replace(task, episode_s=20.0) for task in small))
    words = ["--suite", "v2", "--policy", "damped law", "--name", "mine", "--out", str(tmp_path)]
    done = cli.succeeds("compare", *words)
    assert "mine, interquartile mean: " in done.stdout
    names = pd.read_csv(tmp_path / "scores.csv")["task"].tolist()
    assert names == [*(task.name for task in TASKS), "interquartile mean", IMPROVED]
