"""Law: a picture of a study was drawn from the committed data."""

import importlib
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from docs.scripts import dark
from studies import make

STUDIES = Path(__file__).parent
PLOTS = {
    name.partition("/")[0]: importlib.import_module(f"studies.{name.replace('/', '.')}").PLOTS
    for name in make.scripts()
    if name.endswith("/draw")
}
DARK = dict(dark.plots())
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
    pictures = [path for path in STUDIES.glob("*/pictures/*.png") if path not in DARK.values()]
    assert [path.name for path in pictures if f"pictures/{path.name}" not in text] == []


@pytest.mark.parametrize("light", DARK, ids=lambda path: path.stem)
def test_the_readmes_plots_on_dark_ground_are_those_on_light(light):
    with Image.open(DARK[light]) as picture:
        assert (np.asarray(picture) == dark.darkened(light)).all(), "`make pictures` draws it"
        ground = np.asarray(picture)[0, 0]
    assert ground.max() < 40


def test_every_plot_of_the_readme_has_one_on_dark_ground():
    readme = (STUDIES.parent / "README.md").read_text(encoding="utf-8")
    every = {STUDIES.parent / name for name in re.findall(r"studies/[\w/-]+\.png", readme)}
    assert every == {*DARK, *DARK.values()}
    assert set(STUDIES.glob("*/pictures/*-dark.png")) == {*DARK.values()}


README_PX = 830
"""Width of a README where a repository is read."""


def test_the_letters_of_the_readmes_pictures_have_nine_pixels():
    readme = (STUDIES.parent / "README.md").read_text(encoding="utf-8")
    shown = dict.fromkeys(re.findall(r"studies/[\w/]+\.png", readme), README_PX)
    sized = re.findall(r'src="(\S+\.png)".*?width="(\d+)"', readme)
    shown |= {name: int(width) for name, width in sized}
    assert len(shown) > len(sized) > 0
    for name, width in shown.items():
        with Image.open(STUDIES.parent / name) as file:
            letters = float(file.info["Letters"]) * min(width / file.width, 1.0)
        assert letters >= 9.0, name
