"""Law: no steering has the score 0 in unlike flocks, and the damped law 1."""

import numpy as np
import pandas as pd
import pytest

from flockenv.comparison.levels import LEVELS, NO_STEERING, REFERENCE
from flockenv.comparison.suite_entry import SuiteEntry, Training
from flockenv.policies import NetworkPolicy, policy
from studies.levels import score_levels
from studies.study import Options


def entry(name: str, **policies: object) -> SuiteEntry:
    """An entry with trainings in the easy flock, by the names of their files."""
    own = tuple(Training(given, policy(each), {}) for given, each in policies.items())
    return SuiteEntry(name, "none", "", 30.0, 0.0, {"order-easy": own})


def linear(seed: int) -> NetworkPolicy:
    """Weights that nobody trained."""
    weights = np.random.default_rng(seed).normal(size=(18, 1))
    observation = LEVELS["order-easy"].observation
    return NetworkPolicy([weights], [[0.0]], observation=observation, mirror_to_target=True)


@pytest.fixture
def few(script, monkeypatch) -> None:
    """Three flocks, all of which count."""
    monkeypatch.setattr(script, "LAW_FLOCKS", 3)
    monkeypatch.setattr(script, "LED_FLOCKS", 3)
    monkeypatch.setattr(script, "MARGIN", -9.0)


def test_conditions_are_the_cells_that_differ_from_the_level(script) -> None:
    for name, level in LEVELS.items():
        cells = [each.cell for each in script.conditions(level)]
        left_out = [each.what for each in script.CELLS if each not in cells]
        assert left_out == ["as trained"] + ["n_leaders"] * (name in ("order-easy", "order-noisy"))


def test_a_condition_changes_what_its_cell_names_alone(script) -> None:
    level = LEVELS["order-narrow"]
    for each in script.conditions(level):
        own, other = level.parameters.to_dict(), each.flock.to_dict()
        changed = {name for name in own if own[name] != other[name]}
        if each.cell.preset == "paper":
            assert changed >= {"scheme", "noise_scheme", "bw_s", "dt_s"}
            assert other["bw_s"] == script.FlockParameters.critical_bw_s("paper", "narrow")
            assert not changed & {"pool", "n_boats", "n_leaders"}
        else:
            assert changed == {*each.cell.parameters}
        assert {**each.options} == {**level.environment, **each.cell.options}


def test_laws_have_the_scores_0_and_1_in_every_condition(script, few, tmp_path) -> None:
    options = Options(out=tmp_path, study="levels")
    found = script.gains(script.led_by_laws(options, ["order-easy"]))
    assert len(found) == 18
    given = [entry("law", a="damped law", b="damped law"), entry("none", a="straight ahead")]
    led = script.led_by_entries(options, given, found)
    for _, each in led.groupby(script.PLACE):
        scores = script.scored(each, found)
        law, none = (scores["order-easy", "30", name].to_numpy() for name in ("law", "none"))
        assert law.mean() == pytest.approx(1.0)
        assert none.mean() == pytest.approx(0.0, abs=1e-12)
    table = script.column(script.scored(led, found), found).set_index("entry")
    assert table["unlike"].tolist() == pytest.approx([1.0, 0.0], abs=1e-12)
    assert table["conditions"].tolist() == [18, 18]
    # The trainings are one, but not all flocks are led alike.
    assert table.loc["law", "unlike_low"] < 1.0 < table.loc["law", "unlike_high"]


def test_a_policy_leads_a_condition_once_and_another_in_its_place_leads_it_anew(
    script, few, monkeypatch, tmp_path
) -> None:
    monkeypatch.setattr(script, "CELLS", script.CELLS[:3])
    options = Options(out=tmp_path, study="levels")
    found = script.gains(script.led_by_laws(options, ["order-easy"]))
    script.led_by_entries(options, [entry("a", first=linear(0))], found)
    asked, measured = [], script.measured

    def watched(row: dict[str, object], steers: object) -> dict[str, object]:
        asked.append(row["training"])
        return measured(row, steers)

    monkeypatch.setattr(script, "measured", watched)
    both = [entry("a", first=linear(0), second=linear(1))]
    script.led_by_entries(options, both, found)
    assert asked == ["second"] * 2
    led = script.led_by_entries(options, [entry("a", first=linear(2))], found)
    assert asked == ["second"] * 2 + ["first"] * 2
    assert [len(orders) for orders in led["orders"]] == [3, 3]


def test_a_condition_counts_if_the_whole_interval_of_the_gain_is_above_the_margin(script) -> None:
    random = np.random.default_rng(1)
    shared = random.normal(0.0, 0.3, 128)
    rows = []
    for value, gain, spread in (("none", 0.0, 0.01), ("some", 0.06, 0.01), ("luck", 0.06, 0.2)):
        orders = {NO_STEERING: shared, REFERENCE: shared + gain + random.normal(0.0, spread, 128)}
        place = {"level": "order-easy", "what": "bw_s", "value": value}
        rows += [{**place, "policy": name, "orders": own} for name, own in orders.items()]
    found = script.gains(pd.DataFrame(rows)).set_index("value")
    assert found["counts"].to_dict() == {"none": False, "some": True, "luck": False}
    assert found["gain"].to_dict() == pytest.approx(
        {"none": 0, "some": 0.06, "luck": 0.06}, abs=0.03
    )


def test_ranks_agree_are_reversed_or_half_agree(script) -> None:
    ordered = [np.array([value, value + 0.1]) for value in (0.0, 1.0, 2.0)]
    every = [np.arange(2.0)] * 3
    for unlike, known in (
        (ordered, 1.0),
        (ordered[::-1], -1.0),
        (ordered[1::-1] + ordered[2:], 0.5),
    ):
        assert script.correlation(ordered, unlike)(*every) == pytest.approx(known)
    # Drawn trainings are the same ones on both sides, and each draw has its own ranks.
    apart = [np.array([0.0, 5.0]), np.array([1.0, 1.0]), np.array([2.0, 2.0])]
    drawn = np.array([[0, 0], [1, 1]])
    found = script.correlation(ordered, apart)(drawn, drawn, drawn, axis=-1)
    assert found.tolist() == pytest.approx([1.0, -0.5])


def committed(script) -> tuple[Options, pd.DataFrame]:
    """What the laws did in the levels that were scored, without a run."""
    options = Options(runs=False, study="levels")
    stored = pd.read_csv(script.CONDITIONS)
    return options, script.gains(script.led_by_laws(options, [*stored["level"].unique()]))


def test_the_committed_column_follows_from_the_orders(script) -> None:
    """No run is missing, and the tables say what the orders say."""
    options, found = committed(script)
    given = score_levels.entries(score_levels.ENTRIES)
    led = script.led_by_entries(options, given, found)
    entered = {own.given for each in given for own in each.trainings["order-easy"]}
    assert {*led[led["level"] == "order-easy"]["training"]} == entered
    scores = script.scored(led, found)
    own = script.trainings().astype({"budget": str})
    for name, table in (
        ("_conditions", found),
        ("", script.column(scores, found)),
        ("_ranks", script.ranks(scores, own)),
    ):
        file = options.folder / "results" / f"unlike{name}.csv"
        stored = pd.read_csv(file, dtype={"budget": str, "value": str})
        same = stored.drop(columns="results_version")
        pd.testing.assert_frame_equal(table, same, rtol=1e-3, atol=1e-3)


def test_committed_policies_lead_again_to_the_digit(script) -> None:
    """Two flocks of a condition, led by a policy without a tangent, which machines round."""
    options, found = committed(script)
    given = score_levels.entries(score_levels.ENTRIES)
    (own,) = (each for each in given if (each.name, each.budget) == ("linear evolution", "30"))
    led = script.led_by_entries(options, [own], found)
    for level, runs in led.groupby("level"):
        for row in runs.iloc[[0, len(runs) // 2, -1]].to_dict("records"):
            (steers,) = (
                each.policy for each in own.trainings[level] if each.given == row["training"]
            )
            again = script.measured({**row, "flocks": 2}, steers)["orders"]
            assert [float(text) for text in again.split()] == row["orders"][:2].tolist()


def test_the_page_names_the_algorithms_that_are_best_on_both_sides(script) -> None:
    ranks = pd.read_csv(script.CONDITIONS.with_name("unlike_ranks.csv"))
    text = (score_levels.HERE / "README.md").read_text("utf-8")
    ranks = ranks.set_index("level")
    same = ranks["best_own"] == ranks["best_unlike"]
    assert list(ranks.index[~same]) == ["order-narrow"]
    words = "that ranks best in the level's own flocks ranks best in unlike ones, too"
    best, narrow = ranks["best_own"], ranks.loc["order-narrow"]
    assert (
        f"{words}: {best['order-easy']} in `order-easy` and `order-noisy`, and "
        f"{best['order-wide']} in `order-wide`. In `order-narrow` {narrow['best_own']} ranks best "
        f"in the level's own flocks, and {narrow['best_unlike']} in unlike ones.**"
    ) in text
    assert best["order-easy"] == best["order-noisy"]
