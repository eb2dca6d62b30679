"""Law: a table is whole, names the version of its runs, and is replaced by no other version."""

from pathlib import Path

import pandas as pd
import pytest

from studies import store, study


def test_long_tables_are_compressed_and_read_again(tmp_path: Path) -> None:
    many = study.Study(
        "few/many",
        lambda: [{"minutes": 1.0, "seed": seed} for seed in range(store.MOST_PLAIN + 1)],
        lambda row: {"twice": 2.0 * row["seed"]},
    )
    options = study.Options(out=tmp_path)
    made = many.results(options)
    (file,) = (tmp_path / "few" / "results").iterdir()
    assert file.name == "many.csv.gz"
    before = file.read_bytes()
    again = study.Study(many.name, many.design, lambda row: pytest.fail("it is there"))
    pd.testing.assert_frame_equal(again.results(options), made)
    assert store.version_of(file) == store.RESULTS_VERSION
    file.unlink()
    many.results(options)
    assert file.read_bytes() == before
    file.write_bytes(before[:100])
    with pytest.raises(store.StudyError, match="cannot be read"):
        many.results(options)


def test_a_command_goes_on_with_rows_of_its_version_alone(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    assert len(store.resumed(path)) == 0
    store.write_table(path, pd.DataFrame({"seed": [1, 2]}))
    assert store.resumed(path)["seed"].tolist() == [1, 2]
    later = store.RESULTS_VERSION + 1
    for text, why in (
        (f"seed,results_version\n1,{later}\n", f"has rows of results version {later}, and this"),
        ("seed\n1\n", "does not say which results version"),
        ("", "cannot be read"),
    ):
        path.write_text(text)
        with pytest.raises(store.StudyError, match=why):
            store.resumed(path)
        with pytest.raises(store.StudyError, match=why):
            store.write_table(path, pd.DataFrame({"seed": [1, 2]}))
        assert path.read_text() == text
    path.write_text("seed,results_version\n")
    store.write_table(path, pd.DataFrame({"seed": [1, 2]}))
    path.write_text("seed\n1\n")
    (tmp_path / "made.toml").write_text(
        f'[results_version]\n"rows.csv" = {store.RESULTS_VERSION}\n'
    )
    assert store.resumed(path)["seed"].tolist() == [1]


def test_a_full_disk_leaves_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "claims.csv"
    path.write_text("before")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store.os, "fsync", full)
    with pytest.raises(store.StudyError, match="No space left on device; it is as it was"):
        store.write(path, b"after")
    assert path.read_text() == "before"
    assert [each.name for each in tmp_path.iterdir()] == ["claims.csv"]
