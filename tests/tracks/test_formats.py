"""Tables are read as trackers, spreadsheets and pandas leave them; what cannot be read is named."""

import io

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, read_tracks

from .conftest import LAYOUT, but, read_and_counted


def written(seen, tmp_path, change):
    text = change(seen.table.to_csv(index=False))
    (tmp_path / "tracks.csv").write_text(text)
    return tmp_path / "tracks.csv"


def cells(change):
    """What changes a CSV text line by line, all but its header."""

    def changed(text):
        header, *lines = text.splitlines()
        return "\n".join([header, *map(change, lines)]) + "\n"

    return changed


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("frame,track", " Frame , Track").replace("x_px", "X_PX"),
        lambda text: text.replace(",", ", "),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("\n", "\n\n") + "\n\n,,,,\n",
        lambda text: "# " + text,
        cells(lambda line: line + ","),
        lambda text: text.replace("\n", ",\n"),
        lambda text: text.replace("angle\n", "angle\nno,,px,px,deg\n", 1),
        cells(lambda line: '"' + line.replace(",", '","') + '"'),
        cells(lambda line: line.replace(",", ".0,", 1)),
    ],
)
def test_spellings_of_a_table(seen, tmp_path, change):
    found, report = read_and_counted(written(seen, tmp_path, change), LAYOUT)
    assert found == read_tracks(seen.table, LAYOUT)
    assert report.left_out == {}


@pytest.mark.parametrize(
    "mark", ["-", "--", "N/A", "NULL", "None", "nan", "inf", "-Inf", "lost", "-99"]
)
def test_what_stands_for_no_number(seen, tmp_path, mark):
    table = seen.table.astype(object)
    table.loc[::40, ["x_px", "y_px", "angle"]] = mark
    table.to_csv(tmp_path / "tracks.csv", index=False)
    layout = but(LAYOUT, missing=("lost", "-99"))
    _, report = read_and_counted(tmp_path / "tracks.csv", layout)
    assert sum(report.left_out["without a position"].values()) == len(table[::40])
    if mark == "lost":
        with pytest.raises(flockenv.ParameterError, match="things than numbers: 'lost' in line 2"):
            read_tracks(tmp_path / "tracks.csv", LAYOUT)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (cells(lambda line: line + ",0.93"), "names 5 columns, and line 2 holds 6 values"),
        (cells(lambda line: "1," + line), "names 5 columns, and line 2 holds 6 values"),
        (lambda text: text.replace("\n7,", "\n7,8,", 1), "Expected 5 fields in line"),
        (lambda text: text.replace(",", ";"), "separator = ';'"),
        (lambda text: text.replace(",", "\t"), r"separator = '\t'"),
        (lambda text: text.replace("angle", "x_px"), "several columns 'x_px'"),
        (lambda text: text.replace("angle", "X_PX "), "'angle' is missing"),
        (lambda text: text + text, "other things than numbers: 'x_px' in line 11984"),
        (lambda _: "", "there is no header"),
        (lambda text: "# made by a tracker\n" + text, "`skip` leaves out lines before the header"),
        (lambda text: "\n" + text, "there is no header"),
        (lambda text: text.split("\n", 1)[1], "`header` names the columns of a file"),
        (
            lambda text: text.replace(",", ";").replace("\n", ",5\n").replace("le,5", "le", 1),
            "separator = ';'",
        ),
    ],
)
def test_tables_that_cannot_be_read_are_named(seen, tmp_path, change, words):
    with pytest.raises(flockenv.ParameterError) as raised:
        read_tracks(written(seen, tmp_path, change), LAYOUT)
    assert words in str(raised.value)


def test_decimal_commas_are_named(seen, tmp_path):
    table = seen.table.assign(x_px=seen.table["x_px"] + 0.5)
    table.to_csv(tmp_path / "tracks.csv", index=False, sep=";", decimal=",")
    with pytest.raises(flockenv.ParameterError, match=r"'1015,5' in line 2; is decimal = ','\?"):
        read_tracks(tmp_path / "tracks.csv", but(LAYOUT, separator=";"))
    # Cells with decimal commas in a file that commas separate are quoted.
    table.assign(x_px=table["x_px"].astype(str).str.replace(".", ",")).to_csv(
        tmp_path / "quoted.csv", index=False
    )
    found = read_tracks(tmp_path / "quoted.csv", but(LAYOUT, decimal=","))
    assert found == read_tracks(table, LAYOUT)
    # Beside a word for a lost boat, too, where pandas leaves texts.
    lost = table.assign(x_px=table["x_px"].mask(table.index == 7))
    lost.to_csv(tmp_path / "lost.csv", index=False, sep=";", decimal=",", na_rep="-")
    found = read_tracks(tmp_path / "lost.csv", but(LAYOUT, separator=";", decimal=","))
    assert found == read_tracks(lost, LAYOUT)


@pytest.mark.parametrize(
    "shape",
    [
        lambda table: table.set_index("frame"),
        lambda table: table.set_index(["frame", "track"]),
        lambda table: table.set_index("frame", drop=False),
        lambda table: table.rename_axis(index="track_no"),
        lambda table: table.set_index(np.zeros(len(table))),
        lambda table: table.astype({"track": "category"}),
        lambda table: table.astype({"x_px": "Float32", "frame": "Int64"}),
        lambda table: table.convert_dtypes(dtype_backend="pyarrow"),
        lambda table: table.astype(str),
        lambda table: table.astype(object),
    ],
)
def test_shapes_that_pandas_leaves(seen, shape):
    assert read_tracks(shape(seen.table), LAYOUT) == read_tracks(seen.table, LAYOUT)


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (lambda table: table[::-1].rename_axis(index="frame"), "both called 'frame', and differ"),
        (lambda table: table.pivot(index="frame", columns="track"), "columns have 2 levels"),
        (lambda table: pd.concat([table, table[["x_px"]]], axis=1), "several columns 'x_px'"),
        (lambda table: table.assign(x_px=1j * table["x_px"]), "'x_px' holds other things"),
        (lambda table: table.assign(angle=pd.Timestamp(0)), "'angle' holds other things"),
        (lambda table: table.assign(y_px=table["y_px"] > 3), "'y_px' holds other things"),
    ],
)
def test_shapes_that_are_no_table_of_tracks(seen, shape, words):
    with pytest.raises(flockenv.ParameterError, match=words):
        read_tracks(shape(seen.table), LAYOUT)


def test_a_table_of_one_boat_needs_no_names(seen):
    table = seen.table[seen.table["track"] == "boat3"].drop(columns="track")
    layout = but(LAYOUT, id=None, leaders=())
    assert read_tracks(table, layout).ids.tolist() == ["0"]
    with pytest.raises(flockenv.ParameterError, match="id is missing"):
        read_tracks(seen.table.drop(columns="track"), layout)


def test_text_is_not_executed():
    table = pd.read_csv(io.StringIO("frame,id,x,y,heading\n0,=1+1,1,1,0\n1,=1+1,2,1,0\n"))
    found = read_tracks(table, TrackLayout(pool=(90.0, 0.0), fps=1.0))
    assert found.ids.tolist() == ["=1+1"]


def test_names_of_spots_are_no_names_of_boats(seen):
    """Each row has a name of its own, so that nothing moves: it is said."""
    table = seen.table[:2000].assign(track=np.arange(2000))
    _, report = read_and_counted(table, but(LAYOUT, leaders=()))
    assert report.lone == report.samples
    assert "no boat appears in two successive frames" in str(report)


def test_boats_beside_each_other_have_all_columns_of_a_layout():
    """Blanks around names do not matter, and a column that only looks like one is not a boat's."""
    k = np.arange(30.0)
    table = pd.DataFrame({"frame": k, " x1 ": k, "y1": 5.0, "x2": k, "Y2": 20.0, "xtra": "good"})
    layout = TrackLayout(pool=(90.0, 0.0), fps=10.0, x="x{id}", y="y{id}", heading=None)
    assert read_tracks(table, layout).ids.tolist() == ["1", "2"]
    # A comment mark before the first column is no part of its name.
    marked = table[[" x1 ", "y1", "x2", "Y2", "frame"]].rename(columns={" x1 ": "# x1"})
    assert read_tracks(marked, layout).ids.tolist() == ["1", "2"]
