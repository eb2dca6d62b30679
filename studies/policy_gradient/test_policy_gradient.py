"""Law: of slopes known on paper the squared gradient is their mean square, and of noise it is 0."""

import numpy as np
import pandas as pd
import pytest


@pytest.fixture
def made(script) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Offsets, features of a normal distribution, and the slopes 0.3·f₀ − 0.4·f₁."""
    random = np.random.default_rng(1)
    offsets = random.normal(0.0, script.OFFSET_RAD, size=(20000, 2, 3))
    features = random.normal(size=(20000, 2, 3, 4))
    slopes = features @ [0.3, -0.4, 0.0, 0.0]
    return offsets, features, (offsets * slopes).sum(axis=(1, 2))


def test_slopes_are_found_through_noise(script, made) -> None:
    """Features of unit variance: both metrics are the same."""
    offsets, features, y = made
    noisy = y + np.random.default_rng(2).normal(size=len(y))
    found = script.squared_gradient(offsets, features, noisy, np.arange(len(y)) % 100, 200)
    for value, spread, p in found.values():
        assert value == pytest.approx(0.3**2 + 0.4**2, abs=0.03)
        assert spread < 0.02
        assert p == 0.0


def test_a_feature_s_unit_counts_in_one_metric_alone(script, made) -> None:
    offsets, features, y = made
    large, flock = features * [10.0, 1.0, 1.0, 1.0], np.arange(len(y)) % 100
    plain = script.squared_gradient(offsets, features, y, flock, 10)
    found = script.squared_gradient(offsets, large, y, flock, 10)
    assert found["lean"][0] == pytest.approx(plain["lean"][0], rel=1e-6)
    assert found["weights"][0] == pytest.approx((10 * 0.3) ** 2 + 0.4**2, rel=0.1)


def test_of_noise_alone_nothing_is_found(script, made) -> None:
    """Nor of luck that all pairs of a flock share."""
    offsets, features = made[0][:2000], made[1][:2000]
    flock, found = np.arange(len(offsets)) % 100, []
    for seed in range(30):
        y = np.random.default_rng(seed).normal(size=len(offsets))
        found.append([*script.squared_gradient(offsets, features, y, flock, 50).values()])
    values, spreads, _ = np.array(found).transpose(2, 0, 1)
    assert (abs(values.mean(0)) < 3.5 * values.std(0, ddof=1) / np.sqrt(30)).all()
    assert values.std(0, ddof=1) == pytest.approx(spreads.mean(0), rel=0.5)


def test_branches_without_offsets_are_the_same(script, monkeypatch) -> None:
    monkeypatch.setattr(script, "OFFSET_RAD", 0.0)
    monkeypatch.setattr(script, "BEFORE_S", 2)
    offsets, features, y = script.pairs("wide", "learned", 2, 1)
    assert not offsets.any()
    assert not y.any()
    assert features.shape[:3] == (2, script.HOLDS, 3)


def test_it_writes_every_case(script, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(script, "BEFORE_S", 2)
    script.main(["--flocks", "32", "--rounds", "2", "--out", str(tmp_path / "found.csv")])
    table = pd.read_csv(tmp_path / "found.csv")
    cases = table[["pool", "policy", "features"]].drop_duplicates()
    assert [tuple(row) for row in cases.to_numpy()] == list(script.CASES)
    assert table["metric"].tolist() == ["lean", "weights"] * len(script.CASES)
    assert np.isfinite(table["squared_gradient"]).all()


def test_an_interrupted_command_resumes(script, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(script, "BEFORE_S", 2)
    given = ["--flocks", "2", "--rounds", "1", "--out", str(tmp_path / "found.csv")]
    script.main(given)
    whole = pd.read_csv(tmp_path / "found.csv")
    whole[:4].to_csv(tmp_path / "found.csv", index=False)
    monkeypatch.setattr(script, "pairs", only_narrow(script.pairs))
    script.main(given)
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "found.csv"), whole)


def only_narrow(pairs):
    def checked(pool, policy, *rest):
        assert (pool, policy) != ("wide", "tuned law"), "this case was there"
        return pairs(pool, policy, *rest)

    return checked
