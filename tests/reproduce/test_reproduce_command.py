"""`flockenv reproduce`, killed and resumed, writes the same bytes; what is not there is refused."""

import json
import signal
import time
from pathlib import Path

import pandas as pd
import pytest

import flockenv
from flockenv.reproduce.catalogue import load, names, resolve
from flockenv.reproduce.command import mark_where_short, plan, reproduce
from flockenv.reproduce.reproduction import Outcome, Settings
from flockenv.reproduce.style import column_figure, mark_short

SHORT = ["fig17", "--minutes", "0.4"]


def written(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "fig17").iterdir()}


@pytest.fixture(scope="module")
def uninterrupted(cli, follows, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("uninterrupted")
    done = cli("reproduce", *SHORT, "--out", str(folder), "--json")
    assert done.returncode == 0, done.stderr
    claims = json.loads(done.stdout)
    assert {row["figure"] for row in claims} == {"fig17"}
    assert claims
    assert all(follows(row) for row in claims)
    assert done.stderr == ""
    return folder


def test_claims_are_whole_in_80_columns(cli, uninterrupted: Path) -> None:
    """A block for each claim: nothing is cut off, and no line is too long."""
    done = cli("reproduce", *SHORT, "--out", str(uninterrupted), "--quiet")
    assert done.returncode == 0, done.stderr
    assert "…" not in done.stdout
    *blocks, last = done.stdout.strip().split("\n\n")
    assert max(map(len, "\n".join(blocks).splitlines())) <= 80
    assert last.startswith("Written to")
    claims = pd.read_csv(uninterrupted / "fig17" / "claims.csv", dtype=str, keep_default_na=False)
    assert len(blocks) == len(claims)
    for block, (_, row) in zip(blocks, claims.iterrows(), strict=True):
        text = " ".join(block.split())
        assert text.startswith(f"{row['verdict'].upper()} fig17: {row['claim']}")
        assert all(row[name] in text for name in ("section", "scope", "quantity", "note"))
        assert text.count(f"claimed {row['accepted']}") == 1


def test_short_runs_are_marked_in_the_picture(uninterrupted: Path) -> None:
    """The words stand in the SVG as text, and below all panels."""
    marked = "short runs: 0.4 min, 60 min in the paper"
    assert marked in (uninterrupted / "fig17" / "fig17.svg").read_text()
    figure = column_figure(6.0)
    axes = figure.subplots()
    axes.set_xlabel("x")
    mark_short(figure, 0.4, "60 min in the paper")
    figure.draw_without_rendering()
    (words,) = figure.texts
    assert words.get_text() == marked
    assert words.get_window_extent().y1 <= axes.get_tightbbox().y0


def test_runs_of_the_papers_length_are_not_marked(tmp_path: Path) -> None:
    for minutes, marked in ((None, False), (8.0, False), (7.9, True)):
        figure, specs = load("fig12"), load("fig12").runs(Settings(0, minutes))
        outcome = Outcome({}, {"fig12": column_figure(6.0)})
        mark_where_short(figure, Settings(0, minutes), specs, outcome)
        assert bool(outcome.pictures["fig12"].texts) == marked


def test_what_is_written(uninterrupted: Path) -> None:
    files = written(uninterrupted)
    assert files.keys() == {
        *(f"fig17.{suffix}" for suffix in ("png", "svg", "csv", "parquet")),
        *(f"fig17_states.{suffix}" for suffix in ("csv", "parquet")),
        *(f"claims.{suffix}" for suffix in ("csv", "parquet")),
    }
    folder = uninterrupted / "fig17"
    table = pd.read_csv(folder / "fig17.csv")
    width = table["bin_high"] - table["bin_low"]
    integral = (table["density"] * width).groupby(
        [table["preset"], table["n_boats"], table["quantity"]]
    )
    assert integral.sum().to_numpy() == pytest.approx(1.0, abs=1e-4)
    assert integral.ngroups == 2 * 31 * 2
    assert (table["density_low"] <= table["density_high"]).all()
    assert len(pd.read_parquet(folder / "fig17.parquet")) == len(table)


def interrupted(cli, folder: Path, how: signal.Signals) -> tuple[int, str]:
    """Start it, stop it after some runs; return the exit code and what it said."""
    with cli.start("reproduce", *SHORT, "--out", folder, "--quiet") as process:
        deadline = time.monotonic() + 120
        while len(list(folder.rglob("*.npz"))) < 10:
            assert process.poll() is None, "it ended before it could be stopped"
            assert time.monotonic() < deadline
            time.sleep(0.002)
        process.send_signal(how)
        _, said = process.communicate(timeout=60)
    assert 10 <= len(list(folder.rglob("*.npz"))) < 2 * 31 * 3
    assert not (folder / "fig17").exists()
    return process.returncode, said


def test_killed_and_resumed_it_writes_the_same_bytes(
    cli, uninterrupted: Path, tmp_path: Path
) -> None:
    code, _ = interrupted(cli, tmp_path, signal.SIGKILL)
    assert code == -signal.SIGKILL
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.npz")}
    done = cli("reproduce", *SHORT, "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert all(path.stat().st_mtime_ns == then for path, then in before.items())
    assert written(tmp_path) == written(uninterrupted)


def test_ctrl_c_says_that_work_can_be_resumed(cli, tmp_path: Path) -> None:
    code, said = interrupted(cli, tmp_path, signal.SIGINT)
    assert code == 130
    assert "the same command resumes from them" in said
    assert "Waiting for the runs under way" in said


def test_a_damaged_run_is_named_and_made_again(cli, uninterrupted: Path) -> None:
    before = written(uninterrupted)
    path = sorted((uninterrupted / "runs").rglob("*.npz"))[0]
    path.write_bytes(path.read_bytes()[:1000])
    done = cli("reproduce", *SHORT, "--out", str(uninterrupted))
    assert done.returncode == 0, done.stderr
    assert path.name in done.stderr
    assert "done again" in done.stderr
    assert written(uninterrupted) == before


def test_what_is_not_there_is_refused_before_anything_is_written(cli, tmp_path: Path) -> None:
    for arguments, words in (
        (["fig99"], "fig14, fig15, fig16, fig17"),
        (["fig17", "--engine", "slurm"], "local, joblib, ray"),
        (["fig17", "--minutes", "0"], "minutes = 0.0"),
        (["fig17", "--seed", str(2**64)], "seed"),
        (["fig17", "--summary", "page"], "ends in .md"),
        (["fig17", "--summary", "/dev/null/page.md"], "--summary: folder /dev/null"),
    ):
        done = cli("reproduce", *arguments, "--out", str(tmp_path / "out"))
        assert done.returncode == 2
        assert words in " ".join(done.stderr.split())
        assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_names() -> None:
    assert resolve(["fig17", "fig14", "fig17"]) == ["fig14", "fig17"]
    assert set(resolve(["all"])) <= set(names())
    with pytest.raises(flockenv.ParameterError, match="did you mean 'fig14'"):
        resolve(["fig14", "figg14"])
    for name in names():
        assert load(name).name == name
        assert load(name).runs(Settings(minutes=1.0))


def test_the_presets_share_runs_between_figures() -> None:
    settings = Settings(minutes=1.0)
    shared = plan(["fig14", "fig15", "fig16"], settings)
    assert len(shared.specs) == 2 * 2 * 2 * 25 * 3
    every = plan(["fig14", "fig17"], settings)
    # At bw = 0 and n = 20 and 50 figure 17 needs what figure 14 has.
    assert len(every.specs) == 600 + 2 * 31 * 3 - 2 * 2 * 3
    full = plan(["fig14", "fig15", "fig16", "fig17"], Settings())
    assert {spec.duration_s for spec in full.specs} == {3600.0}


def test_the_report_is_complete_in_itself(uninterrupted: Path, monkeypatch: object) -> None:
    from flockenv.reproduce import catalogue

    monkeypatch.setattr(  # type: ignore[attr-defined]
        catalogue, "_PAPER", {"fig17": "flockenv.reproduce.simulation.figures"}
    )
    work = plan(["all"], Settings(minutes=0.4))
    claims = reproduce(work, uninterrupted)
    page = (uninterrupted / "report.html").read_text("utf-8")
    assert page.count("<img ") == page.count("data:image/png;base64,") == 1
    assert "http" not in page
    for checked in claims["fig17"]:
        assert checked.claim.text in page
        assert checked.verdict in page
    assert flockenv.__version__ in page
    assert "gyration_radius_cm" in page
    summary = (uninterrupted / "summary.md").read_text("utf-8")
    assert all(checked.claim.quantity in summary for checked in claims["fig17"])
    assert "fig17/fig17.png" in summary
    table = pd.read_csv(uninterrupted / "claims.csv")
    assert len(table) == len(claims["fig17"])


def test_a_page_of_some_figures(uninterrupted: Path, tmp_path: Path) -> None:
    page = tmp_path / "docs" / "jamming.md"
    claims = reproduce(
        plan(["fig17"], Settings(minutes=0.4)), uninterrupted, summary=page, notify=pytest.fail
    )
    text = page.read_text("utf-8")
    title = load("fig17").title
    assert text.startswith(f"# {title}\n")
    assert "`flockenv reproduce fig17 --seed 0 --minutes 0.4`" in text
    assert "](jamming/fig17.png)" in text
    picture = page.parent / "jamming" / "fig17.png"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert all(checked.claim.quantity in text for checked in claims["fig17"])
