"""Law: a picture of a study was drawn from the committed data."""

import importlib
from pathlib import Path

import pytest

from studies import make

STUDIES = Path(__file__).parent
PLOTS = {
    name.partition("/")[0]: importlib.import_module(f"studies.{name.replace('/', '.')}").PLOTS
    for name in make.scripts()
    if name.endswith("/draw")
}
EVERY = [(folder, name) for folder, plots in PLOTS.items() for name in plots]


def picture(folder: str, name: str) -> Path:
    return STUDIES / folder / "pictures" / f"{name}.png"


@pytest.mark.parametrize(("folder", "name"), EVERY)
def test_pictures_show_the_committed_data(folder, name):
    plot = PLOTS[folder][name]
    assert plot.is_drawn(picture(folder, name)), f"`make studies STUDIES_ARGS={folder}` draws it"


def test_a_picture_is_older_than_data_that_change(tmp_path):
    folder, name = EVERY[0]
    plot = PLOTS[folder][name]
    (tmp_path / "data.csv").write_bytes(b"".join(file.read_bytes() for file in plot.data))
    same = type(plot)([tmp_path / "data.csv"], plot.draw)
    assert same.is_drawn(picture(folder, name))
    with (tmp_path / "data.csv").open("a", encoding="utf-8") as file:
        file.write("\n")
    assert not same.is_drawn(picture(folder, name))


def test_every_picture_is_on_a_page():
    root = STUDIES.parent
    pages = [root / "README.md", *(root / "docs").glob("*.md"), *STUDIES.rglob("*.md")]
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    pictures = STUDIES.glob("*/pictures/*.png")
    assert [path.name for path in pictures if f"pictures/{path.name}" not in text] == []
