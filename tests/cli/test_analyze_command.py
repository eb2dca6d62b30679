"""`flockenv analyze` and `replay` take tracks where they take recordings, and write both."""

import gzip
import json

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

import flockenv
from flockenv.rendering.palette import PALETTE


@pytest.fixture
def run(tmp_path):
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=1, pool="narrow")
    flockenv.simulate(parameters, 2, 20.0).save(tmp_path / "run.npz")
    return tmp_path / "run.npz"


def test_tracks_have_the_numbers_of_the_run_they_are_of(cli, run, tmp_path):
    tracks = tmp_path / "tracks.csv"
    done = cli.succeeds("analyze", run, "--out", tracks)
    assert "tracks.csv" in done.stdout
    assert "tracks.toml" in done.stdout
    files = ["--plot", str(tmp_path / "order.png"), "--out", str(tmp_path / "again.npz")]
    analyzed = cli.succeeds("analyze", tracks, *files)
    assert "1206 poses of 6 boats in 201 frames" in analyzed.stderr
    assert "mean Ψ_o 0." in analyzed.stdout
    pixels = imread(tmp_path / "order.png")[..., :3]
    # The lines, and in the first frame the boats and the leader.
    for color in ("C0", "C1", "C2", PALETTE["normal"], PALETTE["leader"]):
        assert (abs(pixels - to_rgb(color)).max(axis=-1) < 0.02).sum() > 100
    recording = flockenv.Recording.load(tmp_path / "again.npz")
    assert recording.ids.tolist() == ["0", "1", "2", "3", "4", "5"]
    summaries = [
        json.loads(cli("analyze", path, "--json").stdout)
        for path in (tmp_path / "again.npz", tracks)
    ]
    report = summaries[1].pop("tracks")
    assert (report["samples"], report["left_out"]) == (1206, {})
    assert summaries[0] == summaries[1]
    assert summaries[0]["psi_o_mean"] == pytest.approx(recording.analyzed().order.psi_o.mean())


def test_means_say_which_samples_count(cli, run, tracks, tmp_path):
    """A table has no phases, so that its means are others than those of the run it is of."""
    words = "phases are unknown: all samples after the first tenth count"
    means = {}
    for path in (run, tracks):
        said = cli.succeeds("analyze", path).stdout
        assert (words in said) == (path == tracks)
        assert words not in cli.succeeds("analyze", path, "--quiet").stdout
        means[path] = json.loads(cli("analyze", path, "--json").stdout)["psi_v_mean"]
    recording = flockenv.Recording.load(run)
    late = recording.time_s > 2.0
    psi_v = recording.order.psi_v
    assert means[run] == pytest.approx(psi_v[late & recording.in_analysis_window].mean())
    assert means[tracks] == pytest.approx(psi_v[late].mean(), abs=0.02)
    assert abs(means[tracks] - means[run]) > 0.04


@pytest.fixture
def tracks(cli, run, tmp_path):
    cli.succeeds("analyze", run, "--out", tmp_path / "tracks.csv")
    return tmp_path / "tracks.csv"


def test_tracks_play_beside_the_model(cli, run, tracks, tmp_path):
    cli.succeeds("replay", tracks, run, "--html", tmp_path / "both.html")
    assert (tmp_path / "both.html").exists()


def test_the_first_frame_shows_which_way_is_up(cli, tmp_path):
    """One boat at the top right that heads up: mirrored by y_down, it is drawn at the bottom."""
    rows = "".join(f"{k},a,60.0,{40 + k}.0,90\n" for k in range(10))
    (tmp_path / "t.csv").write_text("frame,id,x,y,heading\n" + rows)
    for down in ("false", "true"):
        (tmp_path / "t.toml").write_text(
            f'pool = [90, 0]\nfps = 10\nheading_unit = "deg"\ny_down = {down}\n'
        )
        done = cli.succeeds("analyze", tmp_path / "t.csv", "--plot", tmp_path / f"{down}.png")
        assert "mean cosine between heading and motion: 1.00" in done.stderr
        pixels = imread(tmp_path / f"{down}.png")[..., :3]
        boat = abs(pixels - to_rgb(PALETTE["normal"])).max(axis=-1) < 0.02
        height, width = boat.shape
        place = np.argwhere(boat[:, : width // 2]).mean(axis=0) / (height, width // 2)
        assert (place[0] < 0.5) == (down == "false")
        assert place[1] > 0.6


def test_what_was_left_out_is_said_by_boat(cli, tracks):
    lines = tracks.read_text().splitlines()
    place = [lines[0].split(",").index(name) for name in ("x_cm", "y_cm")]
    for number in range(300, 330):
        cells = lines[number].split(",")
        for each in place:
            cells[each] = "0.0"
        lines[number] = ",".join(cells)
    tracks.write_text("\n".join(lines))
    done = cli.succeeds("analyze", tracks)
    assert "missing: 30 of 1206 boat-frames" in done.stderr
    assert (
        "left out: 30 rows (30 outside the water: 5 5, 4 5, 3 5, 2 5, 1 5, 1 more boats)"
        in done.stderr
    )
    assert "gaps: 6, the longest 0.6 s" in done.stderr
    named = json.loads(cli("analyze", tracks, "--json", "--quiet").stdout)["tracks"]
    counted = {"5": 5, "4": 5, "3": 5, "2": 5, "1": 5, "0": 5}
    assert named.pop("left_out") == {"outside the water": counted}
    cosine = named.pop("cosine")
    assert f"mean cosine between heading and motion: {cosine:.2f}" in done.stderr
    assert named.pop("longest_gap_s") == pytest.approx(0.6)
    assert named.pop("stuck") == {}
    counts = [named[each] for each in ("frames", "boats", "samples", "missing", "gaps")]
    assert counts == [201, 6, 1176, 30, 6]
    assert named["broken"] == named["lone"] == 0


def test_a_report_by_name_has_no_cosine_of_what_stands_still(cli, tmp_path):
    rows = "".join(f"{k},a,60.0,40.0,90\n" for k in range(30))
    (tmp_path / "t.csv").write_text("frame,id,x,y,heading\n" + rows)
    (tmp_path / "t.toml").write_text('pool = [90, 0]\nfps = 10\nheading_unit = "deg"\n')
    named = json.loads(cli("analyze", tmp_path / "t.csv", "--json").stdout)["tracks"]
    assert named["cosine"] is None
    assert named["stuck"] == {"a": [60.0, 40.0, 30]}


def test_gsd(cli, run, tmp_path):
    pytest.importorskip("gsd.hoomd")
    done = cli.succeeds("analyze", run, "--out", tmp_path / "run.gsd")
    assert "run.toml" not in done.stdout


def test_mistakes_are_one_line_with_exit_code_2(cli, run, tmp_path):
    (tmp_path / "alone.csv").write_text("frame,id,x,y,heading\n0,0,0,0,0\n")
    (tmp_path / "nameless.csv").write_text("frame,who,x,y\n0,0,0,0\n")
    (tmp_path / "words.csv").write_text("frame,id,x,y\n0,0,left,0\n")
    (tmp_path / "layout.toml").write_text('pool = "narrow"\nx = "x_cm"\n')
    for name in ("film.xlsx", "README.md", "film"):
        (tmp_path / name).write_text("no table")
    for arguments, words in (
        (["analyze", "nameless.csv"], "fill in: one of the columns frame, who, x, y"),
        (["analyze", "words.csv"], "column 'x' holds other things than numbers"),
        (["analyze", "alone.csv", "--layout", "layout.toml"], "column 'x_cm' is missing"),
        (["analyze", "absent.npz"], "absent.npz cannot be read"),
        (["analyze", "nothere.csv"], "nothere.csv cannot be read: No such file or directory"),
        (["replay", "nothere.tsv"], "nothere.tsv cannot be read: No such file or directory"),
        (
            ["analyze", "film.xlsx"],
            "film.xlsx is not a table of tracks: its name ends in none of .csv",
        ),
        (["analyze", "README.md"], ".parquet, .pq (recordings end in .npz)"),
        (["analyze", "film"], "film is not a table of tracks"),
        (["analyze", "run.npz", "--out", "run.xlsx"], ".npz, .csv, .parquet, .gsd"),
        (
            ["analyze", "run.npz", "--plot", "order.xyz"],
            "order.xyz is not accepted: a name that ends in .eps",
        ),
        (["analyze", "run.npz", "--out", "alone.csv"], "--force overwrites it"),
        (["analyze", "run.npz", "--out", "layout.csv"], "layout.toml already exists"),
        (["analyze", "absent.npz", "--out", "new.csv"], "absent.npz cannot be read"),
    ):
        paths = [
            str(tmp_path / each) if "." in each or each == "film" else each for each in arguments
        ]
        done = cli(*paths)
        assert done.returncode == 2, arguments
        assert words in done.stderr, arguments
        assert "Traceback" not in done.stderr


def test_a_table_without_a_description_gets_one_to_check(cli, tmp_path):
    """Two robots that go around a circle of 90 pixels, as a camera sees it: y points down."""
    rows = []
    for frame in range(151):
        for name, start in (("r1", 0.0), ("r2", np.pi)):
            angle = start + 0.05 * frame
            x, y = 300 + 90 * np.cos(angle), 200 + 90 * np.sin(angle)
            rows.append(f"{frame},{name},{x:.3f},{y:.3f},{np.degrees(angle) + 90:.3f}")
    (tmp_path / "robots.csv").write_text("\n".join(["frame,robot,x,y,theta", *rows]))
    done = cli.succeeds("analyze", tmp_path / "robots.csv", "--json")
    assert json.loads(done.stdout)["milling_mean"] == pytest.approx(1.0, abs=0.01)
    text = (tmp_path / "robots.toml").read_text()
    for field in ("pool", "center", "cm_per_unit", "y_down", "fps", "heading_unit"):
        assert f"  {field} = " in done.stderr
        assert any(line.startswith(field) and "# check: " in line for line in text.splitlines())
    layout = flockenv.tracks.read_layout(tmp_path / "robots.toml")
    assert (layout.id, layout.heading, layout.heading_unit) == ("robot", "theta", "deg")
    assert layout.y_down
    assert layout.center == pytest.approx((300, 200), abs=2)
    again = cli("analyze", tmp_path / "robots.csv")
    assert "guess" not in again.stderr, "a description that is there is not written over"
    (tmp_path / "turns.csv").write_text("frame,robot,x,y,heading_rad\n0,a,1,2,50.0\n")
    checks = flockenv.tracks.guess_layout(tmp_path / "turns.csv")
    assert [each.split(" =")[0] for each in checks][-1] == "wrapped"
    (tmp_path / "small.csv").write_text("frame,robot,x,y,heading_deg\n0,a,1,2,5.0\n")
    flockenv.tracks.guess_layout(tmp_path / "small.csv")
    assert flockenv.tracks.read_layout(tmp_path / "small.toml").heading_unit == "deg"


@pytest.mark.parametrize("name", ["t.tsv", "t.txt", "t.csv.gz", "t.tsv.gz"])
def test_tables_of_other_endings_are_read_and_described(cli, name, tmp_path):
    separator = "," if "csv" in name else "\t"
    rows = [f"{k},a,{60 + 0.1 * k},40.5,0" for k in range(60)]
    text = "\n".join(["frame,id,x,y,heading", *rows]).replace(",", separator)
    path = tmp_path / name
    path.write_bytes(gzip.compress(text.encode()) if name.endswith(".gz") else text.encode())
    done = cli.succeeds("analyze", path)
    assert "t.toml is a guess" in done.stderr.replace("\n", " ")
    assert "60 poses of 1 boats in 60 frames" in done.stderr
    assert (tmp_path / "t.toml").exists()
    again = cli.succeeds("analyze", path)
    assert "guess" not in again.stderr
