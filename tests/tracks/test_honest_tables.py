"""Law: tables as the programs of the field write them are read, and give back the flock.

Each table is written from one simulated flock by a description of a convention: a program's
columns, an order of rows, a clock, a spelling, a convention of headings, marks of lost animals.
"""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray

from flockenv.tracks import TrackLayout, guess_layout, read_layout, read_tracks

from .corpus import CORPUS
from .honest import FRAMES, HZ, PLACE, Honest, rows, truth
from .programs import PROGRAMS


def write(honest: Honest, folder: Path) -> Path:
    """Write a table of a convention as its program does."""
    table, options = honest.table(), dict(honest.options)
    change, encoding = options.pop("bytes", bytes), options.pop("encoding", "utf-8")
    if not isinstance(table, str):
        table = table.to_csv(**{"index": False, "lineterminator": "\n", **options})
    path = folder / honest.name
    path.write_bytes(change(table.encode(encoding)))
    return path


def check(honest: Honest, source: Any) -> None:
    reports: list[Any] = []
    found = read_tracks(source, TrackLayout(**honest.layout), reports.append)
    assert str(reports[0])
    left_out = {reason: sum(boats.values()) for reason, boats in reports[0].left_out.items()}
    assert honest.left_out.items() <= left_out.items()
    if not honest.boats:  # Another flock than that of the truth, or other points of it.
        assert len(found) > 50
        assert reports[0].broken == 0
        return
    places = found.ids.tolist()
    assert len(places) == len(honest.boats)
    boats = [boat - 1 for boat in honest.boats]
    own, pose = truth().pose[: len(found), boats], found.pose
    assert len(own) == len(pose)
    there = ~np.isnan(pose[..., 0])
    assert there.mean() > 0.9
    assert np.abs((pose - own)[there][:, :2]).max() < 0.01
    if honest.has_headings:
        turn = (pose - own)[there][:, 2]
        assert np.cos(turn).min() > 1 - 1e-6
    speed = np.hypot(*truth().velocity[:, boats, :2].T)
    assert reports[0].median_speed_cm_s == pytest.approx(np.median(speed), rel=0.1)
    assert reports[0].duration_s == pytest.approx(FRAMES / HZ, rel=0.01)


@pytest.mark.parametrize("name", CORPUS)
def test_an_honest_table_is_read(name, tmp_path):
    honest = CORPUS[name]
    source = honest.table()
    if isinstance(source, xarray.Dataset):
        check(honest, source)
        return
    check(honest, write(honest, tmp_path))
    if isinstance(source, pd.DataFrame) and not {"skip", "header"} & honest.layout.keys():
        plain = {n: v for n, v in honest.layout.items() if n not in ("separator", "decimal")}
        table = source.rename(columns=str.upper) if name.endswith("large names") else source
        check(Honest(honest.table, plain, **_rest(honest)), table)


def test_the_corpus_is_as_large_as_it_is_said_to_be():
    assert len(CORPUS) >= 150


#: Of these the columns have names that nobody could know.
UNKNOWN = {"BioTracker", "UMATracker", "DLTdv", "VGG Image Annotator", "Fiji's manual tracking"}


@pytest.mark.parametrize("name", [name for name in PROGRAMS if name not in UNKNOWN])
def test_the_columns_of_a_program_are_guessed(name, tmp_path):
    """The guess has what no table says filled in, and then gives back the flock."""
    honest = PROGRAMS[name]
    path = write(honest, tmp_path)
    guess_layout(path)
    guessed = read_layout(path.with_suffix(".toml"))
    said = {n: v for n, v in honest.layout.items() if n in PLACE}
    fields = {n: getattr(guessed, n) for n in TrackLayout.__dataclass_fields__}
    for field_name in ("x", "y", "id", "heading", "quaternion", "box", "separator", "skip"):
        wanted = honest.layout.get(field_name)
        if wanted is not None and field_name not in ("id", "separator"):
            assert fields[field_name] == getattr(TrackLayout(**honest.layout), field_name)
    said = {"center": (0.0, 0.0), **said}
    said |= {"fps": HZ} if guessed.fps == 25.0 else {}  # To be checked, says the guess.
    turns = {n: v for n, v in honest.layout.items() if n.startswith("heading_")}
    check(Honest(honest.table, {**fields, **said, **turns}, **_rest(honest)), path)


def _rest(honest: Honest) -> dict[str, Any]:
    return {name: getattr(honest, name) for name in ("has_headings", "boats", "left_out")}


def test_unknown_columns_are_listed(tmp_path):
    names = ["Ruta", "Farkost", "Bort [px]", "Upp [px]", "Vinkel [deg]"]
    text = rows()[["frame", "id", "x", "y", "angle"]].to_csv(
        index=False, sep=";", decimal=",", header=names
    )
    (tmp_path / "kamera.csv").write_text(text)
    checks = guess_layout(tmp_path / "kamera.csv")
    assert any(all(name in line for name in names) for line in checks)
    assert [line.split(" ")[0] for line in checks if "fill in" in line] == [
        "frame", "x", "y", "id", "pool",
    ]  # fmt: skip
    assert io.StringIO(text).readline().strip() == ";".join(names)


def test_columns_of_a_german_export_are_guessed(tmp_path):
    names = {"frame": "Zeit [s]", "id": "Boot", "x": "x", "y": "y", "heading": "Winkel [°]"}
    table = rows()[["frame", "id", "x", "y", "angle"]].assign(frame=lambda t: t["frame"] / HZ)
    table.to_csv(
        tmp_path / "kamera.csv", index=False, sep=";", decimal=",", header=[*names.values()]
    )
    checks = guess_layout(tmp_path / "kamera.csv")
    guessed = read_layout(tmp_path / "kamera.toml")
    assert {name: getattr(guessed, name) for name in names} == names
    assert not any("fill in" in line for line in checks)
