"""Law: of slopes known on paper the squared gradient is their mean square, and of noise it is 0."""

import numpy as np
import pandas as pd
import pytest


@pytest.fixture
def made() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Offsets, features of a normal distribution, and the slopes 0.3·f₀ − 0.4·f₁."""
    random = np.random.default_rng(1)
    offsets, features = random.normal(size=(2000, 2, 3)), random.normal(size=(2000, 2, 3, 4))
    slopes = features @ [0.3, -0.4, 0.0, 0.0]
    return offsets, features, (offsets * slopes).sum(axis=(1, 2))


def test_slopes_are_found_through_noise(script, made) -> None:
    offsets, features, y = made
    noisy = y + np.random.default_rng(2).normal(size=len(y))
    even = np.arange(len(y)) % 2 == 0
    value, scatter, p = script.squared_gradient(offsets, features, noisy, even, 200)
    assert value == pytest.approx(0.3**2 + 0.4**2, abs=0.03)
    assert scatter < 0.02
    assert p == 0.0


def test_of_noise_alone_nothing_is_found(script, made) -> None:
    offsets, features, _ = made
    even, found = np.arange(len(offsets)) % 2 == 0, []
    for seed in range(40):
        y = np.random.default_rng(seed).normal(size=len(offsets))
        found.append(script.squared_gradient(offsets, features, y, even, 50)[:2])
    values, scatters = np.transpose(found)
    assert abs(values.mean()) < 3.0 * values.std(ddof=1) / np.sqrt(40)
    assert values.std(ddof=1) == pytest.approx(scatters.mean(), rel=0.5)


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
    assert list(zip(table["pool"], table["policy"], table["features"], strict=True)) == list(
        script.CASES
    )
    assert np.isfinite(table["squared_gradient"]).all()
