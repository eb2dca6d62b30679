"""Law: a plot of a page was drawn from the committed data."""

import pytest

pytest.importorskip("matplotlib")

from docs.scripts.pictures import PLOTS
from docs.scripts.plots import DOCS


@pytest.mark.parametrize("name", PLOTS)
def test_plots_show_the_committed_data(name):
    assert PLOTS[name].is_drawn(DOCS / name), "`make pictures` draws it again"


def test_every_plot_is_on_a_page():
    text = "".join(page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md"))
    assert [name for name in PLOTS if name not in text] == []
