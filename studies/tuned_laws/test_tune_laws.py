"""Tuning: what the search keeps, that it climbs, and that the same seed means the same gains."""

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

SEARCHES = Path(__file__).parent / "results"
TINY = ["--episodes", "2", "--minutes", "0.2", "--flocks", "1", "--leaders", "3", "--quiet"]


def test_it_keeps_every_candidate(script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    judged = {"signed_order": 0.4, "low": 0.3, "high": 0.5, "beyond": 0.01}
    monkeypatch.setattr(script, "judged", lambda *_: judged)
    for name in ("one", "other"):
        script.main([*TINY, "--generations", "2", "--out", str(tmp_path / name)])
    found, again = (pd.read_csv(tmp_path / name / "gains.csv") for name in ("one", "other"))
    pd.testing.assert_frame_equal(found, again)
    assert list(found) == ["pool", "leaders", *script.RANGES, *judged, "results_version"]
    assert list(found["pool"]) == list(script.POOLS)
    made = tomllib.loads((tmp_path / "one" / "gains.toml").read_text())
    assert made["command"].startswith("python -m studies.tuned_laws.tune_laws --episodes 2")
    for pool, row in found.set_index("pool").iterrows():
        table = pd.read_csv(tmp_path / "one" / f"damped-law-{pool}-3.csv")
        columns = ["generation", *script.RANGES, "signed_order", "search", "results_version"]
        assert list(table) == columns
        ends = table[table["generation"] == -1]
        candidates = table.drop(ends.index)
        assert list(ends["search"]) == [0, 1]
        assert set(candidates["generation"]) == {0, 1}
        assert np.isfinite(candidates["signed_order"]).all()
        for gain in script.RANGES:
            assert row[gain] == pytest.approx(np.exp(np.log(ends[gain]).mean()), rel=0.005)


def test_it_climbs(script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On scores that are known instead of the flock's, and by seeds of trainings alone."""
    seen: dict[bool, list[int]] = {True: [], False: []}

    def known(parameters, policy, seeds, duration_s, options=None):
        seen[options is not None].extend(seeds)
        return {"signed_order": np.full(len(seeds), -(np.log(policy.gains["gain"] / 7.0) ** 2))}

    monkeypatch.setattr(script, "run_episodes", known)
    arguments = ["--pool", "narrow", "--generations", "25"]
    script.main([*TINY, *arguments, "--out", str(tmp_path)])
    found = pd.read_csv(tmp_path / "gains.csv").loc[0]
    assert found["gain"] == pytest.approx(7.0, rel=0.05)
    assert min(seen[True]) >= 2**32 > max(seen[False])


def test_gains_are_judged_against_the_tuned_law(script) -> None:
    tuned = script.DampedLaw.tuned("wide").gains
    found = script.judged("wide", 3, tuned, 2, 60.0)
    assert found["beyond"] == found["beyond_low"] == found["beyond_high"] == 0.0
    other = script.judged("wide", 3, {**tuned, "gain": 9.0}, 2, 60.0)
    assert other["beyond"] == pytest.approx(other["signed_order"] - found["signed_order"])
    assert other["beyond"] != 0.0


def test_a_finished_search_is_not_made_again(
    script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(script, "judged", lambda *_: {"signed_order": 0.4})
    arguments = [*TINY, "--generations", "1", "--pool", "wide", "--out", str(tmp_path)]
    script.main(arguments)
    first = (tmp_path / "gains.csv").read_bytes()
    monkeypatch.setattr(script, "search", None)
    script.main(arguments)
    assert (tmp_path / "gains.csv").read_bytes() == first


@pytest.mark.parametrize("pool", ["wide", "narrow"])
def test_the_tuned_law_follows_from_the_scores_of_its_search(script, pool: str) -> None:
    middle, widths = np.array(list(script.RANGES.values())).T
    cma = script.CMA(mean=np.zeros(len(middle)), sigma=0.5, seed=0)
    for _, own in pd.read_csv(SEARCHES / f"damped-law-{pool}.csv").groupby("generation"):
        asked = [cma.ask() for _ in own.index]
        gains = pd.DataFrame([script.law(np.log(middle) + widths * each) for each in asked])
        assert (own[list(gains)].to_numpy() == gains.to_numpy()).all()
        cma.tell(list(zip(asked, -own["signed_order"], strict=True)))
    found = script.law(np.log(middle) + widths * cma.mean)
    assert found == script.DampedLaw.tuned(pool).gains
