"""Suite v1: frozen tasks, and scores in which the paper's law has 0 and the tuned damped law 1.

On paper: a policy whose signed order lies a quarter of the way from the law's to the tuned law's in
every episode has score 1/4, without any uncertainty.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flockenv
from flockenv.comparison import suite
from flockenv.comparison.suite import (
    EPISODES,
    REFERENCES,
    SUITES,
    Score,
    Task,
    budget_class,
    run_task,
    score,
    scores_table,
    tasks_named,
)
from flockenv.policies.registry import named_policy

V1 = {task.name: task for task in SUITES["v1"]}
EASY = V1["easy-narrow-k1"]


def reference(task: Task, name: str) -> Any:
    return suite._references()[task.name, name]


def test_the_easy_task_is_the_registered_environment() -> None:
    import gymnasium

    with gymnasium.make("flockenv/Circulate-easy-v0") as env:
        assert env.unwrapped.parameters == EASY.parameters  # type: ignore[attr-defined]


def test_every_task_has_references() -> None:
    for task in SUITES["v1"]:
        law, tuned = (reference(task, name) for name in REFERENCES)
        assert law.shape == tuned.shape == (EPISODES,)
        assert np.isfinite([law, tuned]).all()
        # Otherwise a score would be mostly noise.
        assert tuned.mean() - law.mean() > 2 * (tuned - law).std() / EPISODES**0.5


def test_references_have_scores_0_and_1() -> None:
    for task in SUITES["v1"]:
        for place, name in enumerate(REFERENCES):
            found = score(task, reference(task, name))
            assert (found.score, found.low, found.high) == pytest.approx((place, place, place))


def test_the_score_of_a_known_policy() -> None:
    law, tuned = (reference(EASY, name) for name in REFERENCES)
    quarter = score(EASY, law + 0.25 * (tuned - law))
    assert (quarter.score, quarter.low, quarter.high) == pytest.approx((0.25, 0.25, 0.25))
    assert quarter.signed_order == pytest.approx(0.75 * law.mean() + 0.25 * tuned.mean())
    shuffled = score(EASY, np.random.default_rng(1).permutation(tuned))
    assert shuffled.score == pytest.approx(1.0)
    assert shuffled.low < 0.9 < 1.1 < shuffled.high


FEW = 16


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tasks of the first episodes alone."""
    first = {key: values[:FEW] for key, values in suite._references().items()}
    monkeypatch.setattr(suite, "_references", lambda: first)
    monkeypatch.setattr(suite, "EPISODES", FEW)


@pytest.mark.usefixtures("few")
def test_references_are_what_the_policies_do() -> None:
    for task in (EASY, V1["camera-wide-k3"]):
        found = run_task(task, named_policy(REFERENCES[0], task.pool))
        assert found == pytest.approx(reference(task, REFERENCES[0]), abs=6e-6)
    found = run_task(EASY, named_policy(REFERENCES[1], EASY.pool))
    assert found == pytest.approx(reference(EASY, REFERENCES[1]), abs=6e-6)


def test_learned_leaders_are_those_of_the_pool(monkeypatch: pytest.MonkeyPatch) -> None:
    def run_episodes(parameters: Any, policy: Any, *rest: Any) -> Any:
        return {"signed_order": np.full(EPISODES, float("wide" in str(policy.provenance)))}

    monkeypatch.setattr(suite, "run_episodes", run_episodes)
    for name in ("circulate-wide-k1", "circulate-narrow-k1"):
        task = V1[name]
        found = run_task(task, named_policy("learned", task.pool))
        assert set(found) == {float("500" in name)}


def test_a_table_of_scores() -> None:
    table = scores_table("mine", {"a": Score(0.5, 1.2, 1.0, 1.4)})
    assert table.to_dict("records") == [
        {
            "policy": "mine",
            "task": "a",
            "signed_order": 0.5,
            "score": 1.2,
            "score_low": 1.0,
            "score_high": 1.4,
        }
    ]


def test_budgets() -> None:
    assert [budget_class(hours) for hours in (0.0, 100.0, 100.1, 10_000.0)] == [
        100,
        100,
        1000,
        10_000,
    ]
    for hours in (-1.0, 10_001.0, float("nan")):
        with pytest.raises(flockenv.ParameterError, match="flock_hours = "):
            budget_class(hours)


def test_unknown_names() -> None:
    with pytest.raises(flockenv.ParameterError, match="suite = 'v2' is not accepted: v1"):
        tasks_named("v2", [])
    with pytest.raises(flockenv.ParameterError, match="task = 'hard' is not accepted: circulate"):
        tasks_named("v1", ["hard"])
    assert tasks_named("v1", ["easy-narrow-k1"]) == [EASY]


def test_policies_that_are_refused() -> None:
    class Often(flockenv.policies.StraightAhead):
        control_hz = 20.0

    with pytest.raises(flockenv.ParameterError, match="outside of the environment"):
        run_task(EASY, named_policy("law", EASY.pool))
    with pytest.raises(flockenv.ParameterError, match="20 times per second is not accepted"):
        run_task(EASY, Often)


SUITE = ["evaluate", "straight ahead", "--suite", "v1", "--task", "easy-narrow-k1"]


@pytest.mark.usefixtures("few")
def test_the_command(cli: Any, tmp_path: Path) -> None:
    done = cli(*SUITE, "--flock-hours", "150", "--json", "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["scores"]
    assert (row["policy"], row["task"]) == ("straight ahead", "easy-narrow-k1")
    assert row["score_low"] < row["score"] < row["score_high"]
    scores = (tmp_path / "scores.csv").read_text().splitlines()
    assert scores[0] == "policy,task,signed_order,score,score_low,score_high"
    episodes = (tmp_path / "episodes.csv").read_text().splitlines()
    assert len(episodes) == 1 + FEW
    run = (tmp_path / "run.toml").read_text()
    assert "budget_flock_hours = 1000" in run
    assert "flock_hours = 150.0" in run


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--pool", "narrow"),
        ("--episodes", "512"),
        ("--set", "n_boats=9"),
        ("--minutes", "8"),
        ("--seed", "0"),
    ],
)
def test_an_altered_task_has_no_score(cli: Any, tmp_path: Path, option: str, value: str) -> None:
    done = cli(*SUITE, option, value, "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert f"{option} is not accepted with --suite v1" in " ".join(done.stderr.split())
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [("--task", "easy-narrow-k1"), ("--flock-hours", "3")])
def test_options_of_a_suite_need_one(cli: Any, option: tuple[str, str]) -> None:
    done = cli("evaluate", "straight ahead", *option)
    assert done.returncode == 2
    assert f"{option[0]} is not accepted without --suite" in " ".join(done.stderr.split())
