"""Law: a study runs as a trial, resumes where it ended, and refuses what it cannot use."""

import csv
import importlib
import signal
import threading
from pathlib import Path

import pytest

from docs.scripts.plots import Plot
from studies import make, plots, store, study


@pytest.mark.parametrize("name", make.scripts())
def test_a_trial_of_every_file(name: str, tmp_path: Path) -> None:
    script = importlib.import_module(f"studies.{name.replace('/', '.')}").script
    study.main(script, ["--trial", "--workers", "1", "--out", str(tmp_path)])
    folder = tmp_path / name.partition("/")[0]
    pictures = list((folder / "pictures").glob("*.png"))
    assert pictures
    assert all(picture.stat().st_size > 5000 for picture in pictures)
    if (folder / "claims.csv").exists():
        lines = list(csv.DictReader((folder / "claims.csv").read_text().splitlines()))
        assert lines
        assert {line["verdict"] for line in lines} <= {"holds", "fails", "open"}


def _counted(calls: list[int]) -> study.Study:
    def measure(row: dict[str, int]) -> dict[str, float]:
        calls.append(row["seed"])
        if row["seed"] == 3:
            raise KeyboardInterrupt
        return {"twice": 2.0 * row["seed"]}

    return study.Study(
        "few/counted", lambda: [{"minutes": 1.0, "seed": s} for s in range(5)], measure
    )


def test_a_killed_study_goes_on(tmp_path: Path) -> None:
    calls: list[int] = []
    with pytest.raises(KeyboardInterrupt):
        _counted(calls).results(study.Options(workers=1, out=tmp_path))
    there = _counted(calls).results(study.Options(out=tmp_path, runs=False))
    assert set(there["seed"]) == set(calls) - {3} >= {0, 1, 2}
    again: list[int] = []
    with pytest.raises(KeyboardInterrupt):
        _counted(again).results(study.Options(workers=1, out=tmp_path))
    assert again[0] == 3
    assert not set(again) & set(there["seed"])


@pytest.mark.usefixtures("_ignored_sigterm")
def test_a_terminated_study_keeps_its_runs(tmp_path: Path) -> None:
    def measure(row: study.Row) -> study.Row:
        if row["seed"] == 3:
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
        return {"twice": 2.0 * row["seed"]}

    ended = study.Study(
        "few/ended", lambda: [{"minutes": 1.0, "seed": s} for s in range(5)], measure
    )
    options = study.Options(workers=1, out=tmp_path)
    with pytest.raises(SystemExit, match="Interrupted: the same command makes the runs that are"):
        study.run(lambda: ended.results(options))
    there = ended.results(study.Options(out=tmp_path, runs=False))
    assert {0.0, 1.0, 2.0, 3.0} <= set(there["seed"])


@pytest.mark.usefixtures("_ignored_sigterm")
def test_an_interrupted_script_says_whether_it_resumes() -> None:
    for resumes, end in ((True, "makes the runs that are missing"), (False, "starts from the")):
        with pytest.raises(SystemExit, match=f"Interrupted: the same command {end}"):
            study.run(lambda: signal.raise_signal(signal.SIGTERM), resumes)


def test_a_store_of_another_design(tmp_path: Path) -> None:
    (tmp_path / "few" / "results").mkdir(parents=True)
    file = tmp_path / "few" / "results" / "counted.csv"
    file.write_text("length,seed,twice\n1,0,0\n")
    with pytest.raises(store.StudyError, match="a store of another design"):
        _counted([]).results(study.Options(out=tmp_path))
    assert file.read_text() == "length,seed,twice\n1,0,0\n"


def test_a_design_that_was_changed_after_its_runs(tmp_path: Path) -> None:
    options = study.Options(out=tmp_path, runs=False)
    with pytest.raises(KeyboardInterrupt):
        _counted([]).results(study.Options(out=tmp_path))
    changed = study.Study("few/counted", lambda: [{"minutes": 2.0, "seed": 0}], lambda row: {})
    with pytest.raises(store.StudyError, match=r"another design: .* was it changed after its runs"):
        changed.results(options)


def test_a_store_of_another_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    options = study.Options(out=tmp_path)
    with pytest.raises(KeyboardInterrupt):
        _counted([]).results(options)
    file = tmp_path / "few" / "results" / "counted.csv"
    before = file.read_text()
    monkeypatch.setattr(store, "RESULTS_VERSION", store.RESULTS_VERSION + 1)
    with pytest.raises(store.StudyError, match=r"holds runs of results version \d+, and \d are"):
        _counted([]).results(options)
    assert file.read_text() == before
    judged = _counted([]).results(study.Options(out=tmp_path, runs=False))
    assert set(judged["results_version"]) == {store.RESULTS_VERSION - 1}


def test_a_store_of_two_versions(tmp_path: Path) -> None:
    (tmp_path / "few" / "results").mkdir(parents=True)
    file = tmp_path / "few" / "results" / "counted.csv"
    for text in (
        "minutes,seed,twice\n1.0,0,0\n",
        "minutes,seed,twice,results_version\n1.0,0,0,4\n1.0,1,2,5\n",
    ):
        file.write_text(text)
        with pytest.raises(store.StudyError, match="does not say which results version"):
            _counted([]).results(study.Options(out=tmp_path))
        assert file.read_text() == text


def test_a_tree_without_results(tmp_path: Path) -> None:
    script = importlib.import_module("studies.section4.fig08").script
    with pytest.raises(SystemExit, match=r"section4.results.section4\.csv is missing or empty"):
        study.main(script, ["--no-runs", "--out", str(tmp_path)])
    draw = plots.drawing(__name__, {"means": Plot([tmp_path / "means.csv"], lambda figure: None)})
    with pytest.raises(store.StudyError, match=r"means\.csv is missing: its folder's README"):
        draw(study.Options(out=tmp_path))
    assert list(tmp_path.iterdir()) == []
