"""Law: entries that differ are told apart, the table is that of the rows, and rows stay."""

import shutil
from collections import Counter

import numpy as np
import pandas as pd
import pytest
import tomli_w

from flockenv.comparison.levels import LEVELS
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy
from flockenv.runs.store import RESULTS_VERSION
from studies.store import StudyError, existing

FLOCKS = 64


def orders(script, **means: float) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Rows and orders of entries of five trainings, with what flocks share."""
    random = np.random.default_rng(5)
    shared = random.normal(0.0, 0.3, FLOCKS)
    every = {"reference": np.array([shared, shared + 0.4])}
    for name, mean in means.items():
        trainings = mean + random.normal(0.0, 0.01, (5, 1)) + random.normal(0.0, 0.05, (5, FLOCKS))
        every[name] = shared + trainings
    parts = []
    for name, each in every.items():
        budget = "0" if name == "reference" else "30"
        for place, own in enumerate(each):
            part = pd.DataFrame({"flock": range(FLOCKS), "signed_order": own})
            parts.append(part.assign(level="order-easy", budget=budget, entry=name, policy=place))
    rows = pd.DataFrame({"level": "order-easy", "budget": "30", "entry": [*means], "trainings": 5})
    return rows, pd.concat(parts)


def test_a_difference_is_found_in_units_of_the_score(script) -> None:
    found = script.pairs(*orders(script, good=0.3, same=0.3, bad=0.1)).set_index("worse")
    assert found["better"].tolist() == ["good", "good", "same"]
    bad = found.loc["bad"].iloc[0]
    # 0.2 of order, of the 0.4 between the references.
    assert bad["difference"] == pytest.approx(0.5, abs=0.05)
    assert bad["difference_low"] > 0.4
    assert (bad["improvement"], bad["improvement_low"]) == (1.0, 1.0)
    # 2 of the 252 ways to deal ten trainings out are as far apart; three pairs are judged.
    assert bad["p"] == pytest.approx(2 / 252)
    assert bad["p_of_all_pairs"] == pytest.approx(6 / 252)
    same = found.loc["same"]
    assert same["difference_low"] < 0.0 < same["difference_high"]
    assert same["p"] > 0.05


def test_how_often_one_is_better_is_known_on_paper(script) -> None:
    assert script.better(np.array([1.0, 3.0]), np.array([2.0, 3.0, 0.0])) == pytest.approx(3.5 / 6)
    both = script.better(np.array([[1.0, 3.0]] * 2), np.array([[2.0, 2.0]] * 2))
    assert both.tolist() == [0.5, 0.5]


def test_the_most_entries_of_which_each_two_differ(script) -> None:
    """A chain: c is told from none of its neighbors, but a, d and e are told from each other."""
    rows = [
        ("a", "c", -0.1, 0.2), ("a", "d", 0.1, 0.3), ("a", "e", 0.1, 0.3),
        ("c", "d", -0.1, 0.2), ("c", "e", 0.1, 0.2), ("e", "d", -0.3, -0.1),
    ]  # fmt: skip
    columns = ["better", "worse", "difference_low", "difference_high"]
    pairs = pd.DataFrame(rows, columns=columns)
    assert script.told_apart(pairs) == ["a", "d", "e"]
    assert script.told_apart(pairs[3:4]) == []


def test_a_digit_is_a_difference(script) -> None:
    rows = pd.DataFrame({"level": ["a", "a"], "budget": ["30", "30"], "entry": ["x", "y"]})
    rows["score"], rows["searched_hours"] = [0.123456, 0.5], np.nan
    stored = script.rounded(rows.assign(results_version=6))
    assert script.differing(rows, stored) == []
    assert script.differing(rows.assign(score=[0.1234561, 0.5]), stored) == []
    assert script.differing(rows.assign(score=[0.123457, 0.5]), stored) == ["a, 30, x"]
    assert script.differing(rows[:1], stored) == ["a, 30, y"]


def test_entries_are_scored_compared_and_scored_again(script, monkeypatch, tmp_path) -> None:
    """From files of entries to the page, with two levels' laws as trainings."""
    scored = script.scored
    monkeypatch.setattr(script, "scored", lambda given, levels: scored(given, levels, 4))
    network = {"observation": LEVELS["order-easy"].observation, "mirror_to_target": True}
    size = len(observation_entries(network["observation"]))
    for place, seed in enumerate(range(4)):
        weights = np.random.default_rng(seed).normal(size=(size, 1))
        NetworkPolicy([weights], [[0.0]], **network).save(tmp_path / f"{place}.npz")
    for name, own in (("a", ["0.npz", "1.npz"]), ("b", ["2.npz", "3.npz"])):
        entry = {"suite": "v3", "name": name, "class": "none"}
        entry |= {"link": "studies/levels/README.md", "flock_hours": 0.0}
        entry |= {"training_seeds": [2**32, 2**32], "levels": {"order-easy": own}}
        (tmp_path / f"{name}.toml").write_text(tomli_w.dumps(entry), "utf-8")
    page = tmp_path / "page.md"
    page.write_text("Before.\n\n<!-- entries -->\n\nold\n\n<!-- end -->\n\nAfter.\n", "utf-8")
    given = ["--entries", str(tmp_path), "--out", str(tmp_path / "out"), "--page", str(page)]
    script.main(given)
    text = page.read_text("utf-8")
    assert text.startswith("Before.\n")
    assert text.endswith("\n\nAfter.\n")
    assert "old" not in text
    assert text.count("| order-easy | 30 |") == 2
    assert len(pd.read_csv(tmp_path / "out" / "pairs.csv")) == 1
    written, committed = tmp_path / "out" / "orders.csv", existing(script.RESULTS / "orders.csv")
    assert [*pd.read_csv(written, nrows=0)] == [*pd.read_csv(committed, nrows=0)]
    script.main([*given, "--check"])
    rows = tmp_path / "out" / "entries.csv"
    kept = rows.read_text("utf-8")
    rows.write_text(kept.replace(f",{RESULTS_VERSION}\n", f",{RESULTS_VERSION - 1}\n"), "utf-8")
    with monkeypatch.context() as patched:
        patched.setattr(script, "scored", None)
        with pytest.raises(StudyError, match=r"entries\.csv has rows of results version"):
            script.main(given)
    rows.write_text(kept, "utf-8")
    entry |= {"name": "c", "levels": {"order-easy": ["module:attribute"]}}
    (tmp_path / "a.0.toml").write_text(tomli_w.dumps(entry), "utf-8")
    for how in ([], ["--check"], ["--no-runs"]):
        with pytest.raises(SystemExit, match=r"not in the table: .*a\.0\.toml: .*--trust"):
            script.main([*given, *how])
        assert page.read_text("utf-8") == text
    (tmp_path / "a.0.toml").unlink()
    (tmp_path / "3.npz").write_bytes((tmp_path / "2.npz").read_bytes())
    with pytest.raises(SystemExit, match="order-easy, 30, b"):
        script.main([*given, "--check"])
    assert page.read_text("utf-8") == text


def test_curves_stay_where_the_trainings_are_of_another_version(
    script, monkeypatch, tmp_path
) -> None:
    """Their orders are of flocks with other bits than the laws that would scale them."""
    scored = script.scored
    monkeypatch.setattr(script, "scored", lambda given, levels: scored(given, levels, 2))
    network = {"observation": LEVELS["order-easy"].observation, "mirror_to_target": True}
    size = len(observation_entries(network["observation"]))
    made = {"curve_flock_hours": "6 30", "curve_signed_order": "0.1 0.2"}
    entry = {"suite": "v3", "name": "a", "class": "none", "link": "here", "flock_hours": 30.0}
    entry |= {"training_seeds": [2**32, 2**32], "levels": {"order-easy": ["a.npz"]}}
    (tmp_path / "a.toml").write_text(tomli_w.dumps(entry), "utf-8")
    page = tmp_path / "page.md"
    page.write_text("<!-- entries -->\n\nold\n\n<!-- end -->\n", "utf-8")
    given = ["--entries", str(tmp_path), "--out", str(tmp_path / "out"), "--page", str(page)]
    for version, has_curves in ((RESULTS_VERSION - 1, False), (RESULTS_VERSION, True)):
        made["results_version"] = str(version)
        weights = [np.zeros((size, 1))]
        NetworkPolicy(weights, [[0.0]], **network, provenance=made).save(tmp_path / "a.npz")
        script.main(given)
        assert (tmp_path / "out" / "areas.csv").exists() is has_curves


def test_committed_entries_are_scored_again_to_the_digit(script) -> None:
    """In four flocks, the policies without a hyperbolic tangent of NumPy, which machines round."""
    orders = pd.read_csv(existing(script.RESULTS / "orders.csv"))
    for entry in script.entries(script.ENTRIES):
        for level, trainings in entry.trainings.items():
            named = orders[(orders["level"] == level) & (orders["entry"] == entry.name)]
            assert {each.given for each in trainings} <= {*named["policy"]}
            for each in trainings[:1]:
                if isinstance(each.policy.source, NetworkPolicy) and "tanh" in repr(each.policy):
                    continue
                own = named[named["policy"] == each.given].sort_values("flock")[:4]
                found = LEVELS[level].run(each.policy, 4)["signed_order"]
                assert [f"{order:.6g}" for order in found] == [
                    f"{order:.6g}" for order in own["signed_order"]
                ]


def test_the_table_has_what_is_known_of_the_same_trainings_alone(script, tmp_path) -> None:
    """Scores in unlike flocks and areas."""
    entries, given = (
        pd.read_csv(script.RESULTS / "entries.csv")[:2],
        script.entered(script.ENTRIES)[0],
    )
    entries.to_csv(tmp_path / "entries.csv", index=False)

    def shown(column: str) -> list[str]:
        header, _, *lines = script.lines(script.joined(tmp_path, given, script.PAGE))
        at = header.split(" | ").index(column)
        return [line.split(" | ")[at] for line in lines]

    for column in ("unlike flocks", "area"):
        assert shown(column) == ["unknown"] * 2
    score = {"unlike": 0.5, "unlike_low": 0.25, "unlike_high": 0.75, "area": 0.5}
    found = entries[["level", "budget", "entry", "trainings", "results_version"]].assign(**score)
    for fewer, words in ((0, "{}"), (1, "unknown")):
        found.loc[0, "trainings"] -= fewer
        for name in ("unlike", "areas"):
            found.to_csv(tmp_path / f"{name}.csv", index=False)
        for column, full in (("unlike flocks", "0.500 (0.250 to 0.750)"), ("area", "0.500")):
            assert shown(column) == [words.format(full), full]


def test_a_row_links_its_entry_and_names_the_commits_of_its_policies(script) -> None:
    given = script.entered(script.ENTRIES)[0]
    rows = script.joined(script.RESULTS, given, script.PAGE)
    (files,) = rows[(rows["entry"] == "linear evolution") & (rows["budget"] == "100")]["files"]
    made = "[code](../studies/levels/train_levels.py) of 505508cc5d3f+"
    assert files == f"[entry](../studies/levels/entries/evolution-100.toml), {made}"
    commits = Counter(
        each.provenance["commit"]
        for entry in given.values()
        for own in entry.trainings.values()
        for each in own
    )
    named = {word for each in rows["files"] for word in each.split(" of ")[1].split(", ")}
    assert named == {*commits}
    lost, clean = (commits.pop(commit) for commit in ("4473632ad8c3", "505508cc5d3f+"))
    others = clean + sum(commits.values())
    assert all(commit.endswith("+") for commit in commits)
    text = script.PAGE.read_text("utf-8")
    assert f"{lost} policies of `order-easy` name a commit that is not in the history" in text
    assert f"the other {others} policies name a commit with +" in text


def test_ranks_are_known_on_paper(script) -> None:
    """Levels in which entries rank alike, in reverse, and with two neighbors exchanged."""
    means = {"order-easy": "abcd", "order-noisy": "abcd", "order-narrow": "dcba"}
    means["order-wide"] = "bacd"
    parts = []
    for level, places in means.items():
        for place, name in enumerate(places):
            for policy in (0, 1):
                own = pd.DataFrame({"flock": [0, 1], "signed_order": place + 0.1 * policy})
                parts.append(own.assign(level=level, budget="30", entry=name, policy=policy))
    found = script.ranks(pd.concat(parts)).set_index("level")
    assert found["rank_correlation"].to_dict() == pytest.approx(
        {"order-noisy": 1.0, "order-narrow": -1.0, "order-wide": 0.8}
    )
    # No draw of trainings that differ so little changes a rank.
    assert found["low"].tolist() == pytest.approx(found["high"].tolist())


def test_the_page_and_the_ranks_follow_from_the_committed_results(script, tmp_path) -> None:
    """Without a run; no results are lost on the way."""
    page, out = script.PAGE, tmp_path / "docs" / "levels.md"
    out.parent.mkdir()
    (tmp_path / "studies").symlink_to(page.parents[1] / "studies")
    begin, end = (page.read_text("utf-8").index(mark) for mark in (script.BEGIN, script.END))
    text = page.read_text("utf-8")
    out.write_text(text[: begin + len(script.BEGIN)] + text[end:], "utf-8")
    results = shutil.copytree(script.RESULTS, tmp_path / "results")
    (results / "ranks.csv").unlink()
    entries = tmp_path / "studies" / "levels" / "entries"
    script.main(["--no-runs", "--out", str(results), "--page", str(out), "--entries", str(entries)])
    assert out.read_text("utf-8") == text
    assert (results / "ranks.csv").read_bytes() == (script.RESULTS / "ranks.csv").read_bytes()
    rows = pd.read_csv(results / "entries.csv")
    given = {(entry.name, entry.budget) for entry in script.entries(script.ENTRIES)}
    assert given == {*zip(rows["entry"], rows["budget"].astype(str), strict=True)}


def test_the_page_names_what_the_tables_say(script) -> None:
    """The entries of which each two differ, the best one, and the areas under the curves."""
    folder = script.RESULTS
    pairs, entries, areas = (
        pd.read_csv(folder / f"{name}.csv", dtype={"budget": str})
        for name in ("pairs", "entries", "areas")
    )
    pairs, entries, areas = (
        table[(table["level"] == "order-easy") & (table["budget"] == "30")]
        for table in (pairs, entries, areas)
    )
    text = (script.HERE / "README.md").read_text("utf-8")
    *names, last = script.told_apart(pairs)
    assert f"{', '.join(names)} and {last} all differ from each other.**" in text
    assert f"- **Best.** {entries['entry'].iloc[0]} has " in text
    listed = (f"{row.entry} {row.area:.2f}" for row in areas.itertuples())
    assert ", ".join(listed).replace("-", "−") in text
    trained = (f"{row.entry} {row.trainings}" for row in entries.itertuples())
    assert f"{', '.join(trained)} trainings" in text


def test_the_page_says_by_how_much_chance_raises_the_scores_of_a_level(script) -> None:
    """The order without steering is 0 in the mean of all flocks, but not in the common ones."""
    laws, entries = (pd.read_csv(script.RESULTS / f"{name}.csv") for name in ("laws", "entries"))
    orders = laws[laws["level"] == "order-narrow"].set_index("policy")["signed_order"]
    low, high = orders["straight ahead"], orders["damped law"]
    scores = entries.loc[entries["level"] == "order-narrow", "score"]
    raised = scores - (low + scores * (high - low)) / high
    text = (script.HERE / "README.md").read_text("utf-8")
    assert f"lower by {raised.min():.2f} to {raised.max():.2f}." in text
