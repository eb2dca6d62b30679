"""Law: a picture of a study was drawn from the committed data."""

import importlib
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from docs.scripts import dark
from docs.scripts.plots import (
    DESK_PX,
    LEAST_LETTERS_PX,
    PHONE_PX,
    SCROLLED_PX,
    is_scrolled,
    letters_px,
)
from studies import make
from studies.picture import DENSITIES
from studies.plots import grouped, levels

STUDIES = Path(__file__).parent
PLOTS = {
    name.partition("/")[0]: importlib.import_module(f"studies.{name.replace('/', '.')}").PLOTS
    for name in make.scripts()
    if name.endswith("/draw")
}
DARK = dict(dark.plots())
LAWS = ("damped law", "paper's law", "tuned law")
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
        assert letters_px(STUDIES.parent / name, width) >= LEAST_LETTERS_PX, name


LIGHT = [path for path in sorted(STUDIES.glob("*/pictures/*.png")) if path not in DARK.values()]


@pytest.mark.parametrize("path", LIGHT, ids=lambda path: path.stem)
def test_letters_have_nine_pixels_on_a_desk_and_on_a_phone(path):
    assert letters_px(path, DESK_PX) >= LEAST_LETTERS_PX
    assert not is_scrolled(path) or letters_px(path, SCROLLED_PX) >= LEAST_LETTERS_PX


def test_a_phone_scrolls_no_picture_of_the_first_page():
    home = (STUDIES.parent / "docs" / "index.md").read_text(encoding="utf-8")
    shown = re.findall(r"\.\./studies/([\w/]+\.png)", home)
    assert len(shown) == 2
    for name in shown:
        assert letters_px(STUDIES / name, PHONE_PX) >= LEAST_LETTERS_PX, name


def luminance(rgb: np.ndarray) -> float:
    """Return the relative luminance of a color as WCAG 2 defines it."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("count", [2, 12])
def test_rows_of_a_name_leave_the_next_name_free(count):
    axes = Figure().subplots()
    names = ("first", "second", "third")
    series = {f"{place}": dict.fromkeys(names, (0.5, 0.4, 0.6)) for place in range(count)}
    grouped(axes, series)
    at = np.array([each.lines[0].get_ydata() for each in axes.containers])
    assert at.shape == (count, 3)
    apart = np.diff(np.sort(at.ravel()))
    assert apart.min() > 0.05
    assert (abs(at - np.arange(3)) < 0.5 - 0.05).all()
    if count == 2:
        assert at[:, 0].tolist() == pytest.approx([-0.1, 0.1])


@pytest.mark.parametrize("turned", [False, True], ids=["light", "dark"])
def test_names_of_laws_are_read_on_light_ground_and_on_dark(tmp_path, turned):
    """The orange of the tuned law had a contrast of 2.2 on paper, and of 3.5 in the dark."""
    figure = Figure()
    levels(
        figure.subplots(),
        [{"policy": name, "signed_order": "0.4", "low": "0.3", "high": "0.5"} for name in LAWS],
    )
    names = figure.axes[0].texts
    assert [each.get_text() for each in names] == [*LAWS]
    for each in names:
        inks = np.array([[mpl.colors.to_rgb(each.get_color()), (1.0, 1.0, 1.0)]])
        file = tmp_path / "inks.png"
        Image.fromarray((255 * inks).round().astype(np.uint8)).save(file)
        shown = dark.darkened(file)[0] / 255 if turned else inks[0]
        faint, bright = sorted(luminance(color) for color in shown)
        assert (bright + 0.05) / (faint + 0.05) > 4.5, each.get_text()


def test_densities_begin_at_the_ground_in_light_and_in_dark(tmp_path):
    shades = mpl.colormaps[DENSITIES](np.linspace(0.0, 1.0, 32))[:, :3]
    file = tmp_path / "shades.png"
    Image.fromarray((255 * shades[None]).round().astype(np.uint8)).save(file)
    light, dark_ = (255 * shades).mean(axis=1), dark.darkened(file)[0].mean(axis=1)
    assert light[0] > 220
    assert dark_[0] < 45
    assert (np.diff(light) < 0).all()
    assert (np.diff(dark_) > 0).all()
