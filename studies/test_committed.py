"""Law: committed statements follow from committed runs, and a table names what made it."""

import importlib
import shutil
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from flockenv.runs.store import RESULTS_VERSION
from studies import make, store, study

TABLES = [
    path
    for path in sorted(study.HERE.rglob("*.csv*"))
    if "results" in path.relative_to(study.HERE).parts
]
KEY = ["figure", "claim", "section", "reading", "quantity", "least", "most"]


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the committed results alone."""
    out = tmp_path_factory.mktemp("studies")
    for folder in study.HERE.glob("*/results"):
        shutil.copytree(folder, out / folder.parent.name / "results")
    return out


@pytest.mark.parametrize("name", [each for each in make.scripts() if not each.endswith("/draw")])
def test_statements_follow_from_the_runs(name: str, copied: Path) -> None:
    script = importlib.import_module(f"studies.{name.replace('/', '.')}").script
    folder = name.partition("/")[0]
    (copied / folder / "claims.csv").unlink(missing_ok=True)
    study.main(script, ["--no-runs", "--out", str(copied)])
    if not (copied / folder / "claims.csv").exists():
        return
    found, committed = (
        pd.read_csv(each / folder / "claims.csv", dtype=str) for each in (copied, study.HERE)
    )
    committed = committed[committed["figure"].isin(found["figure"])].reset_index(drop=True)
    assert found[KEY].equals(committed[KEY])
    assert found["verdict"].tolist() == committed["verdict"].tolist()
    for column in ("n_runs", "measured", "low", "high"):
        ours, theirs = (pd.to_numeric(each[column]) for each in (found, committed))
        pd.testing.assert_series_equal(ours, theirs, rtol=0.02, atol=1e-3)


@pytest.mark.parametrize("path", TABLES, ids=lambda path: str(path.relative_to(study.HERE)))
def test_a_table_names_its_version_and_is_compressed_if_long(path: Path) -> None:
    assert 1 <= store.version_of(path) <= RESULTS_VERSION
    assert (path.suffix == ".gz") == (len(pd.read_csv(path)) > store.MOST_PLAIN)


def test_no_name_is_of_a_table_that_is_gone() -> None:
    for made in study.HERE.rglob(store.MADE):
        versions = tomllib.loads(made.read_text("utf-8"))[store.VERSION]
        assert [name for name in versions if not (made.parent / name).exists()] == []
