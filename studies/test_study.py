"""Law: a study runs as a trial, resumes where it ended, and refuses what it cannot use."""

import contextlib
import csv
import importlib
import math
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import numpy as np
import pandas as pd
import pytest

from docs.scripts.plots import Plot
from studies import claim, counts, make, plots, store, study
from studies.transition import transition, transition_runs


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


@pytest.fixture
def _ignored_sigterm() -> Iterator[None]:
    """Where SIGTERM is not taken for Ctrl-C, it does nothing."""
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    yield
    assert signal.signal(signal.SIGTERM, before) == signal.SIG_IGN


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


def test_an_unknown_study() -> None:
    with pytest.raises(SystemExit, match="'fig99' is no study of this folder: "):
        make.main(["fig99"])


class _Process(contextlib.AbstractContextManager):
    """A script that ends at once, or at the second wait if the first is interrupted."""

    made: ClassVar[list[str]] = []
    waits: ClassVar[list[BaseException | signal.Signals | None]] = []
    terminated: ClassVar[int] = 0

    def __init__(self, command: list[str], **_: object) -> None:
        self.made.append(command[2].removeprefix("studies.").replace(".", "/"))

    def __exit__(self, *_: object) -> None:
        pass

    def wait(self) -> int:
        if self.waits and (happens := self.waits.pop(0)):
            if isinstance(happens, signal.Signals):
                signal.raise_signal(happens)
            else:
                raise happens
        return 0

    def terminate(self) -> None:
        type(self).terminated += 1


def test_what_make_does_not_run_is_listed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(make.subprocess, "Popen", _Process)
    monkeypatch.setattr(_Process, "made", made := [])
    make.main([])
    listed = capsys.readouterr().out.partition("not here: ")[2].strip().split(", ")
    assert made == make.scripts()
    runs = [path for path in study.HERE.glob("*/*.py") if "__main__" in path.read_text("utf-8")]
    assert sorted(made + listed) == sorted(f"{path.parent.name}/{path.stem}" for path in runs)
    make.main(["critical_noise"])
    assert capsys.readouterr().out.endswith("not here: critical_noise/critical_noise\n")


@pytest.mark.usefixtures("_ignored_sigterm")
@pytest.mark.parametrize(("happens", "passed_on"), [(KeyboardInterrupt(), 0), (signal.SIGTERM, 1)])
def test_an_interruption_waits_for_what_a_script_writes(
    monkeypatch: pytest.MonkeyPatch,
    happens: BaseException | signal.Signals,
    passed_on: int,
) -> None:
    monkeypatch.setattr(make.subprocess, "Popen", _Process)
    monkeypatch.setattr(_Process, "terminated", 0)
    monkeypatch.setattr(_Process, "waits", waits := [happens, None])
    with pytest.raises(KeyboardInterrupt):
        make.main(["worth"])
    assert waits == []
    assert _Process.terminated == passed_on


@pytest.mark.parametrize(
    ("found", "verdict", "decide"),
    [
        ((1.0, 0.6, 1.4), "holds", ""),
        ((0.0, -0.4, 0.4), "fails", ""),
        # Half as wide with four times the runs.
        ((1.0, 0.0, 2.0), "open", "96"),
        ((0.5, 0.0, 1.0), "open", "more than 10000"),
        ((math.nan,) * 3, "open", ""),
    ],
)
def test_verdicts(found: tuple[float, float, float], verdict: str, decide: str) -> None:
    judged = claim.Claim("", "", "", "", claim.Interval(found, 24), least=0.5)
    assert (judged.verdict, judged.would_decide) == (verdict, decide)


def test_existence_has_one_bound() -> None:
    claims = claim.Claims("", "")
    for count, runs in ((0, 24), (1, 24), (5, 24), (0, 100), (12, 100)):
        claims.exists("it happens", "", count, runs)
    # One run of 24 may be one in a thousand: the bound does not move to what was found.
    assert [each.verdict for each in claims] == ["open", "open", "holds", "fails", "holds"]
    assert {each.least for each in claims} == {claim.OCCURS}


def test_runs_are_those_that_bear_the_interval() -> None:
    # 24 seeds at four noises each, whose means over the noises are averaged.
    assert claim.mean(np.arange(24.0)).runs == 24
    pairs = np.random.default_rng(0).normal(size=(24, 2))
    assert claim.bca([pairs, pairs], lambda *each: sum(g[..., 0].mean(-1) for g in each)).runs == 48
    assert claim.proportion(3, 7).runs == 7


def test_critical_noise_of_a_straight_fall() -> None:
    noises = [0.0, 0.1, 0.2, 0.3, 0.4]
    fall = [0.9, 0.9, 0.6, 0.3, 0.1]
    groups = [np.full((4, 2), level) for level in fall]
    # The middle of 0.9 and 0.1 is 0.5, a third of the way from 0.6 to 0.3.
    assert claim.fall(noises, groups) == pytest.approx(0.2 + 0.1 / 3)
    jam = [np.array([[level, 0.2]] * 4) for level in fall]
    assert math.isnan(claim.critical_bw(noises, jam)[0])


def test_a_jam_that_splits_lasts_by_the_second_rule() -> None:
    # Start, whether and when its largest jam fell below half, and what its last minutes were.
    runs = pd.DataFrame(
        [
            ("one-jam", 1, 30.0, 0.1, 0.9),  # Split: still in jams when its run ended.
            ("one-jam", 1, 110.0, 0.1, 0.9),
            ("one-jam", 1, 30.0, 0.8, 0.6),  # Came to rotate.
            ("one-jam", 1, 30.0, 0.1, 0.2),  # Dissolved.
            ("one-jam", 0, 119.7, 0.0, 1.0),
            ("rotating", 0, 119.7, -0.9, 0.0),
            ("rotating", 1, 10.0, 0.2, 0.7),
        ],
        columns=["start", "exited", "stayed_min", "m", "in_jams"],
    ).assign(minutes=120.0)
    found = transition.second(runs)
    assert list(found["exited"]) == [0, 0, 1, 1, 0, 0, 1]
    assert list(found["stayed_min"]) == [50.0, 120.0, 30.0, 30.0, 119.7, 119.7, 10.0]


def test_answers_of_a_map() -> None:
    claims = claim.Claims("", "")
    for cell, large, drift in (("A", 24, -0.01), ("B", 24, -0.5), ("C", 2, 0.0)):
        claims.reading = cell
        for n, stay in ((100, 0), (200, large)):
            found = claim.proportion(stay, 24)
            claims.add("stays", "share of runs that stay", found, least=0.5, n=f"{n}")
        found = claim.Interval((drift,) * 3, 24)
        claims.add("shrinks", "drift of the largest jam", found, least=-0.05, n="200")
        found = claim.Interval((0.5, 0.4, 0.6), 48)
        claims.add("longer", "factor of exits", found, most=1.0, n="100, 200")
    found = transition.answers({"first": claims}).set_index("cell")["first rule"].to_dict()
    # The largest size counts; a jam that shrinks keeps the answer open.
    assert found == {"A": "for", "B": "open", "C": "against"}


def test_wall_slots() -> None:
    # Six discs of 5 cm touch around a circle of 10 cm; their hulls' bows are 10 cm further out.
    assert transition_runs.outer_radius_cm(6, 1.0) == pytest.approx(20.0)


def test_the_page_counts_the_statements() -> None:
    assert counts.table() in (study.HERE / "README.md").read_text(encoding="utf-8")


def test_a_statement_counts_once() -> None:
    """Two presets agree, two do not, one is open; what is ours does not count."""
    lines = [
        ("paper", "a", "holds"),
        ("paper", "a", "holds"),
        ("paper", "b", "holds"),
        ("paper", "b", "fails"),
        ("paper", "c", "fails"),
        ("paper", "c", "open"),
        ("ours", "d", "fails"),
    ]
    claims = pd.DataFrame(lines, columns=["of", "claim", "verdict"])
    assert dict(zip(counts.ANSWERS, counts.counted(claims), strict=True)) == {
        "holds": 1,
        "fails": 0,
        "depends": 1,
        "open": 1,
    }


def test_a_line_that_more_runs_judged_counts_as_they_judge_it(tmp_path: Path) -> None:
    """One of two open lines was judged again; another study's line stays away from the count."""
    names = ["figure", "of", "claim", "reading", "quantity", "verdict"]
    first = [["fig10", "paper", claim, "", "", "open"] for claim in ("a", "b")]
    again = [["fig10", "paper", "b", "", "", "holds"], ["fig07", "paper", "c", "", "", "fails"]]
    for folder, lines in (("section4", first), ("decided", again)):
        (tmp_path / folder).mkdir()
        pd.DataFrame(lines, columns=names).to_csv(tmp_path / folder / "claims.csv", index=False)
    found = counts.judged(tmp_path / "section4")
    assert counts.counted(found[found["figure"] == "fig10"]) == [1, 0, 0, 1]
    (tmp_path / "decided" / "claims.csv").unlink()
    assert counts.counted(counts.judged(tmp_path / "section4")) == [0, 0, 0, 2]


def test_a_fall_is_where_a_line_crosses_the_level() -> None:
    """Of two draws: one rises again before it falls, and one never is above the level."""
    y = np.array([[0.9, 0.2], [0.1, 0.1], [0.5, 0.1], [0.1, 0.0]])
    found = claim.crossing([0.0, 1.0, 2.0, 3.0], y, 0.3)
    assert found[0] == pytest.approx(2.5)
    assert math.isnan(found[1])
    assert claim.crossing([0.0, 1.0], np.array([[0.9], [0.8]]), 0.3) == [1.0]


def test_order_that_is_not_lost_has_no_noise_at_which_it_is() -> None:
    random = np.random.default_rng(0)
    falls = [level + 0.01 * random.normal(size=(24, 1)) for level in (0.9, 0.5, 0.1)]
    stays = [level + 0.01 * random.normal(size=(24, 1)) for level in (0.9, 0.5, 0.4)]
    levels = [1.0, 2.0, 3.0]
    assert claim.disorder(levels, [falls])[0] == pytest.approx(2.5, abs=0.02)
    shift = claim.disorder(levels, [falls, falls], (1.0, -1.0))
    assert shift[0] == pytest.approx(0.0, abs=1e-9)
    assert all(map(math.isnan, claim.disorder(levels, [falls, stays], (1.0, -1.0))))


def test_few_runs_print_one_digit_and_ties_are_ties() -> None:
    def last_digits(runs: np.ndarray) -> np.ndarray:
        means = runs[..., 0].mean(-1)
        return np.asarray(means * (1.0 + 1e-15 * np.sign(np.sin(1e6 * means))))

    few = np.array([[0.0], [0.0], [1.0], [1.0], [1.0], [0.0], [0.0], [1.0]])
    found = claim.bca([few], last_digits)
    assert found == claim.bca([few], lambda runs: runs[..., 0].mean(-1))
    assert found.texts()[0] == "0.5"
    assert claim.bca([np.repeat(few, 3, axis=0)], last_digits).digits == 3
    assert claim.Interval((0.1234, 0.01, 1.26), 8, 1).texts() == ["0.1", "0.01", "1"]
