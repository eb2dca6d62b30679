"""Law: a plot of a page was drawn from the committed data, and its letters can be read there."""

import pytest

pytest.importorskip("matplotlib")

from docs.scripts.pictures import PLOTS
from docs.scripts.plots import DESK_PX, DOCS, LEAST_LETTERS_PX, SCROLLED_PX, is_scrolled, letters_px

PICTURES = sorted(
    path
    for path in DOCS.rglob("*.png")
    if path.relative_to(DOCS).parts[0] in ("frame.png", "speed_vs_error", "throughput")
)


@pytest.mark.parametrize("name", PLOTS)
def test_plots_show_the_committed_data(name):
    assert PLOTS[name].is_drawn(DOCS / name), "`make pictures` draws it again"


def test_every_plot_is_on_a_page():
    text = "".join(page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md"))
    assert [name for name in PLOTS if name not in text] == []


@pytest.mark.parametrize("path", PICTURES, ids=lambda path: path.stem)
def test_letters_have_nine_pixels_on_a_desk_and_on_a_phone(path):
    assert letters_px(path, DESK_PX) >= LEAST_LETTERS_PX
    assert not is_scrolled(path) or letters_px(path, SCROLLED_PX) >= LEAST_LETTERS_PX


def test_every_plot_is_among_these_pictures():
    assert {DOCS / name for name in PLOTS} < {*PICTURES}


def test_the_site_has_the_widths_that_pictures_are_judged_by():
    """A phone scrolls a picture whose letters it could not show otherwise."""
    sheet = (DOCS / "static" / "phones.css").read_text(encoding="utf-8")
    assert f"article img.wide {{\n    width: {SCROLLED_PX // 16}rem;" in sheet
