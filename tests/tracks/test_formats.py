"""Tables are read as trackers, spreadsheets and pandas leave them; what cannot be read is named."""

import io

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, read_tracks

from .conftest import FIELDS, LAYOUT, but, check, guessed_of, read_and_counted


def key_points(seen):
    """Nose and tail of each boat, 20 pixels ahead and behind."""
    angle = np.radians(seen.table["angle"])
    ahead = 20 * np.cos(angle), 20 * np.sin(angle)
    return seen.table.assign(
        nose_x=seen.table["x_px"] + ahead[0],
        nose_y=seen.table["y_px"] + ahead[1],
        tail_x=seen.table["x_px"] - ahead[0],
        tail_y=seen.table["y_px"] - ahead[1],
    )


def deeplabcut(seen):
    """The columns of a project with several animals, and the numbers of frames as index."""
    table = key_points(seen)
    columns = {}
    for name, rows in table.set_index("frame").groupby("track"):
        for part, stem in (("nose", "nose_"), ("tail", "tail_"), ("center", "")):
            for coord in "xy":
                column = rows[f"{stem}{coord}" if stem else f"{coord}_px"]
                columns["DLC_resnet50", name, part, coord] = column
            columns["DLC_resnet50", name, part, "likelihood"] = 0.99 + 0 * column
    wide = pd.DataFrame(columns).reindex(range(601))
    wide.columns.names = ["scorer", "individuals", "bodyparts", "coords"]
    return wide


def test_deeplabcut(seen, tmp_path):
    wide = deeplabcut(seen)
    wide.loc[300, (slice(None), "boat7", slice(None), "likelihood")] = 0.1
    layout = TrackLayout(
        **FIELDS,
        fps=10.0,
        x="{id}.center_x",
        y="{id}.center_y",
        heading=("{id}.tail_x", "{id}.tail_y", "{id}.nose_x", "{id}.nose_y"),
        confidence=("{id}.nose_likelihood", "{id}.tail_likelihood"),
        least_confidence=0.6,
    )
    wide.to_csv(tmp_path / "dlc.csv")
    assert (tmp_path / "dlc.csv").read_text().startswith("scorer,DLC_resnet50,")
    for source in (wide, tmp_path / "dlc.csv"):
        _, report = read_and_counted(source, layout)
        assert report.left_out["with too little confidence"] == {"boat7": 1}
        assert report.left_out["without a position"]["boat7"] > 0
        assert report.missing == seen.missing + 1
    guessed = guessed_of(tmp_path / "dlc.csv")
    assert (guessed.x, guessed.y, guessed.heading) == (layout.x, layout.y, layout.heading)
    assert (guessed.id, guessed.frame, guessed.least_confidence) == (None, "frame", 0.6)


def test_deeplabcut_of_one_animal(seen, tmp_path):
    wide = deeplabcut(seen).xs("boat7", axis=1, level="individuals")
    wide.to_csv(tmp_path / "dlc.csv")
    layout = guessed_of(tmp_path / "dlc.csv")
    assert (layout.id, layout.x, layout.heading[2]) == (None, "center_x", "nose_x")
    found, _ = read_and_counted(tmp_path / "dlc.csv", but(layout, fps=10.0))
    assert (found.ids.tolist(), len(found)) == (["0"], 601)


def test_sleap(seen, tmp_path):
    points = key_points(seen)
    table = pd.DataFrame({"track": points["track"], "frame_idx": points["frame"]})
    table["instance.score"] = 0.9
    for part in ("nose", "tail"):
        table[f"{part}.x"], table[f"{part}.y"] = points[f"{part}_x"], points[f"{part}_y"]
        table[f"{part}.score"] = 0.8
    # What is assigned to no track has no name.
    table = pd.concat([table, table[::50].assign(track="")]).sort_values("frame_idx", kind="stable")
    table.to_csv(tmp_path / "sleap.csv", index=False)
    guessed = guessed_of(tmp_path / "sleap.csv")
    # Without a part in the middle, the center is between the two ends.
    assert (guessed.x, guessed.y) == (("tail.x", "nose.x"), ("tail.y", "nose.y"))
    assert (guessed.id, guessed.frame) == ("track", "frame_idx")
    found, report = read_and_counted(
        tmp_path / "sleap.csv", but(guessed, **but_units(), fps=10.0, leaders=FIELDS["leaders"])
    )
    assert report.left_out == {"without a name": {"": len(seen.table[::50])}}
    check(seen, found, report)


def but_units():
    names = ("pool", "cm_per_unit", "center", "y_down")
    return {name: FIELDS[name] for name in names}


@pytest.mark.parametrize("columns", ["x{}", "X_{}", "x{} [px]"])
def test_wide_tables_of_idtracker(seen, tmp_path, columns):
    wide = seen.table.assign(n=seen.table["track"].str.removeprefix("boat"))
    wide = wide.pivot(index="frame", columns="n")
    table = pd.DataFrame({"seconds": wide.index / 10.0})
    for name in wide["x_px"]:
        table[columns.format(name)] = wide["x_px"][name].to_numpy()
        table[columns.format(name).replace("x", "y").replace("X", "Y")] = wide["y_px"][
            name
        ].to_numpy()
        table[f"angle{name}"] = wide["angle"][name].to_numpy()
    table.to_csv(tmp_path / "trajectories.csv", index=False)
    guessed = guessed_of(tmp_path / "trajectories.csv")
    assert guessed.x == columns.format("{id}")
    assert (guessed.id, guessed.frame, guessed.fps, guessed.heading) == (
        None, "seconds", None, "angle{id}",
    )  # fmt: skip
    layout = but(guessed, **but_units(), leaders=("1", "2"), heading_unit="deg")
    found, report = read_and_counted(tmp_path / "trajectories.csv", layout)
    found_ids = [f"boat{each}" for each in found.ids]
    assert (report.samples, report.missing) == (len(seen.table), seen.missing)
    expected = read_tracks(seen.table, LAYOUT)
    assert found_ids == expected.ids.tolist()
    assert np.allclose(found.order.psi_o, expected.order.psi_o, equal_nan=True)


def test_trex(seen, tmp_path):
    """One file per individual, with infinities where it is lost, joined as docs/tracks.md says."""
    names = []
    for name, rows in seen.table.groupby("track"):
        whole = rows.set_index("frame").reindex(range(601))
        table = pd.DataFrame({"frame": whole.index, "missing": whole["x_px"].isna() * 1})
        table["time"] = table["frame"] / 10.0
        for column, values in (("X (cm)", "x_px"), ("Y (cm)", "y_px")):
            table[column.replace(" ", "#wcentroid ")] = whole[values].fillna(np.inf).to_numpy()
        table["ANGLE"] = np.radians(whole["angle"]).fillna(np.inf).to_numpy()
        table.to_csv(tmp_path / f"film_{name}.csv", index=False)
        names.append(name)
    paths = sorted(tmp_path.glob("film_*.csv"))
    joined = pd.concat([pd.read_csv(p).assign(id=p.stem.rpartition("_")[2]) for p in paths])
    joined.to_csv(tmp_path / "all.csv", index=False)
    guessed = guessed_of(tmp_path / "all.csv")
    assert (guessed.x, guessed.y, guessed.heading, guessed.id) == (
        "X#wcentroid (cm)", "Y#wcentroid (cm)", "ANGLE", "id",
    )  # fmt: skip
    assert guessed.cm_per_unit == 1.0
    layout = but(guessed, **but_units(), fps=10.0, frame="frame", leaders=FIELDS["leaders"])
    found, report = read_and_counted(tmp_path / "all.csv", layout)
    check(seen, found, report)
    assert sum(report.left_out["without a position"].values()) == seen.missing


def test_trackmate(seen, tmp_path):
    """Spots with three more lines of header; ID is the spot's, TRACK_ID the boat's."""
    table = seen.table.assign(LABEL="ID1", ID=np.arange(len(seen.table)) + 7)
    table = table.rename(
        columns={"track": "TRACK_ID", "x_px": "POSITION_X", "y_px": "POSITION_Y", "frame": "FRAME"}
    )
    lines = table.to_csv(index=False).splitlines()
    more = [
        "Frame,Track ID,X,Y,Angle,Label,Spot ID",
        "Frame,Track ID,X,Y,A,Label,Spot ID",
        ",,(pixel),(pixel),(deg),,",
    ]
    (tmp_path / "spots.csv").write_text("\n".join([lines[0], *more, *lines[1:]]))
    guessed = guessed_of(tmp_path / "spots.csv")
    assert (guessed.id, guessed.x, guessed.frame) == ("TRACK_ID", "POSITION_X", "FRAME")
    layout = but(guessed, **FIELDS, fps=10.0)
    check(seen, *read_and_counted(tmp_path / "spots.csv", layout))


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


def test_ethovision(seen, tmp_path):
    """One animal: lines before the header, units below it, "-" for a lost one, UTF-16."""
    rows = seen.table[seen.table["track"] == "boat5"]
    cells = rows.assign(frame=rows["frame"] / 10).drop(columns="track").astype(object)
    cells.iloc[5] = [cells.iloc[5, 0], "-", "-", "-"]
    lines = cells.to_csv(index=False, sep=";", header=False)
    before = '"Number of header lines:";"5"\n"Start time";"05/04/2026 10:00:00"\n\n'
    header = '"Trial time";"X center";"Y center";"Direction"\n"s";"px";"px";"deg"\n'
    (tmp_path / "etho.csv").write_bytes((before + header + lines).encode("utf-16"))
    guessed = guessed_of(tmp_path / "etho.csv")
    assert (guessed.frame, guessed.x, guessed.heading) == ("Trial time", "X center", "Direction")
    assert (guessed.separator, guessed.skip, guessed.id) == (";", 3, None)
    found, report = read_and_counted(
        tmp_path / "etho.csv", but(guessed, **but_units(), heading_unit="deg")
    )
    assert report.left_out == {"without a position": {"0": 1}}
    assert len(found) == len(rows)


def test_names_of_spots_are_no_names_of_boats(seen):
    """Each row has a name of its own, so that nothing moves: it is said."""
    table = seen.table[:2000].assign(track=np.arange(2000))
    _, report = read_and_counted(table, but(LAYOUT, leaders=()))
    assert report.lone == report.samples
    assert "no boat is there in two frames one after another" in str(report)
