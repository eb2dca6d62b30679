"""Law: settings beside the scripts are accepted, start from nothing and count flock-hours."""

from pathlib import Path

import pytest

from flockenv.training import TrainingSettings

ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "baselines").glob("ppo_*.toml"))
OF_PAGES = sorted((ROOT / "docs" / "training" / "rudders").glob("*.toml"))


@pytest.mark.parametrize("path", [*FILES, *OF_PAGES], ids=lambda path: path.stem)
def test_settings_are_accepted(path: Path) -> None:
    settings = TrainingSettings.from_toml(path.read_text(encoding="utf-8"))
    assert settings.start == ""
    assert settings.flock_hours is not None


def test_there_is_one_for_each_pool() -> None:
    pools = [TrainingSettings.from_toml(path.read_text(encoding="utf-8")).pools for path in FILES]
    assert pools == [("narrow",), ("wide",)]
