"""Law: a layout is guessed from the header of a table; what is not found is to be filled in."""

import pytest

import flockenv
from flockenv.tracks import guess_layout, read_layout, read_tracks

from .conftest import CENTER, FIELDS, but, check, guessed_of, read_and_counted
from .program_tables import motive

LAB = ("Frame", "RobotID", "X [px]", "Y [px]", "Theta [deg]")


@pytest.mark.parametrize(
    ("separator", "decimal", "encoding", "before"),
    [
        (",", ".", "utf-8", ""),
        (",", ".", "utf-8-sig", ""),
        (";", ",", "utf-8", ""),
        (";", ",", "cp1252", ""),
        (";", ".", "utf-16", "Experiment: 7\n\n"),
        ("\t", ",", "utf-8", "Kamera: oben links\nMaßstab: 2,5 mm\n"),
        ("|", ".", "utf-8", ""),
    ],
)
def test_a_table_of_a_lab_is_guessed(seen, tmp_path, separator, decimal, encoding, before):
    table = seen.table.set_axis(LAB, axis=1).astype({"X [px]": float, "Y [px]": float})
    if encoding == "cp1252":
        table = table.rename(columns={"Theta [deg]": "Theta [°]"})
    text = before + table.to_csv(index=False, sep=separator, decimal=decimal)
    (tmp_path / "lab.csv").write_bytes(text.encode(encoding))
    checks = guess_layout(tmp_path / "lab.csv")
    assert any("cm_per_unit = 1.0  # fill in" in line for line in checks)
    guessed = read_layout(tmp_path / "lab.toml")
    assert (guessed.frame, guessed.id, guessed.x, guessed.y) == LAB[:4]
    assert (guessed.separator or ",", guessed.decimal) == (separator, decimal)
    assert guessed.heading_unit == "deg"
    assert guessed.center == pytest.approx(CENTER, abs=40)
    layout = but(guessed, **FIELDS, fps=10.0)
    check(seen, *read_and_counted(tmp_path / "lab.csv", layout))


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ("time [ms];Robot;x (mm);y (mm);yaw [rad]", {"fps": 1000.0, "cm_per_unit": 0.1}),
        ("time_min;Robot;x (mm);y (mm);yaw [rad]", {"fps": 1 / 60, "frame": "time_min"}),
        ("time_s;robot_no;x_m;y_m;heading_deg", {"cm_per_unit": 100.0, "heading_unit": "deg"}),
        ("Timestamp;Tag ID;X;Y;Orientation", {"id": "Tag ID", "heading": "Orientation"}),
        ("step;fish;pos_x;pos_y;theta", {"frame": "step", "id": "fish", "x": "pos_x"}),
        ("Zeit [s];Boot;x [cm];y [cm];Winkel [°]", {"frame": "Zeit [s]", "id": "Boot"}),
        ("Bild;Fisch;x [cm];y [cm];Winkel [°]", {"fps": 25.0, "heading_unit": "deg"}),
        ("Time (Seconds);Body;X (m);Y (m);Yaw", {"fps": 1.0, "id": "Body", "cm_per_unit": 100.0}),
    ],
)
def test_units_in_a_header_are_taken(tmp_path, names, expected):
    rows = [f"{40 * k};{k % 2};{k % 7 + 0.5};{k % 5 + 1.5};0.1" for k in range(40)]
    (tmp_path / "lab.csv").write_text("\n".join([names, *rows]))
    found = guessed_of(tmp_path / "lab.csv")
    assert {name: getattr(found, name) for name in expected} == expected


def test_what_is_not_found_is_to_be_filled_in(tmp_path):
    (tmp_path / "odd.csv").write_text("frame,who,east,north\n0,a,1,2\n0,b,3,4\n")
    checks = guess_layout(tmp_path / "odd.csv")
    assert [line.split()[0] for line in checks if "fill in" in line] == ["x", "y", "id", "pool"]
    with pytest.raises(flockenv.ParameterError, match="x = '' is not accepted"):
        read_tracks(tmp_path / "odd.csv")
    with pytest.raises(flockenv.ParameterError, match="already exists"):
        guess_layout(tmp_path / "odd.csv")


@pytest.mark.parametrize(
    ("names", "x"),
    [
        ("frame,id,nose_x,nose_y,ear_x,ear_y", None),
        ("frame_idx,track,A.x,A.y,B.x,B.y", None),
        ("frame,cat.A_x,cat.A_y,cat.B_x,cat.B_y", None),
        ("frame,id,x1,y1,x2,y2", None),
        ("frame,id,nose_x,nose_y", "nose_x"),
        ("frame,id,nose_x,nose_y,tail_x,tail_y", ("tail_x", "nose_x")),
        ("frame,x1,y1,x2,y2", "x{id}"),
    ],
)
def test_a_center_is_guessed_only_if_it_is_known(tmp_path, names, x):
    """And not taken to be the first of several points, or a corner of a box to be a boat."""
    rows = [",".join([str(k), *["1.5"] * names.count(",")]) for k in range(20)]
    (tmp_path / "lab.csv").write_text("\n".join([names, *rows]))
    checks = guess_layout(tmp_path / "lab.csv")
    assert any(line.startswith('x = ""  # fill in') for line in checks) == (x is None)
    if x is not None:
        assert read_layout(tmp_path / "lab.toml").x == x


@pytest.mark.parametrize("text", ["w" * 300_000 + ",frame\n1,2\n", '"' + "a" * 300_000 + "\n1\n"])
def test_a_cell_as_long_as_a_book_is_named(tmp_path, text):
    (tmp_path / "lab.csv").write_text(text)
    with pytest.raises(
        flockenv.ParameterError, match=r"lab\.csv: it cannot be read as a table: field larger"
    ):
        guess_layout(tmp_path / "lab.csv")


def test_lost_points_are_no_part_of_a_guessed_pool(seen, tmp_path):
    table = seen.table.set_axis(LAB, axis=1)
    table.loc[::9, ["X [px]", "Y [px]"]] = -1
    table.to_csv(tmp_path / "lab.csv", index=False)
    guessed = guessed_of(tmp_path / "lab.csv")
    assert guessed.center == pytest.approx(CENTER, abs=40)
    assert guessed.lost == ((-1.0, -1.0),)


def test_a_header_in_levels_begins_below_a_longer_line(tmp_path):
    """With one rigid body, the line about the take has more cells than the table."""
    take, *lines = motive().splitlines()
    lines = [",".join(line.split(",")[:10]) for line in lines]
    (tmp_path / "take.csv").write_text("\n".join([take, *lines]))
    guessed = guessed_of(tmp_path / "take.csv")
    assert (guessed.skip, guessed.x) == (2, "{id}.Position_X")
