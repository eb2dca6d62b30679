"""Law: a plot of a page was drawn from the committed data."""

import importlib.util
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
sys.path.append(str(DOCS))  # as for the script
spec = importlib.util.spec_from_file_location("docs_plots", DOCS / "plots.py")
plots = importlib.util.module_from_spec(spec)
spec.loader.exec_module(plots)


@pytest.mark.parametrize("name", plots.PLOTS)
def test_plots_show_the_committed_data(name):
    assert plots.is_drawn(name), "`make tables` draws it again"


def test_a_plot_is_older_than_data_that_change(tmp_path, monkeypatch):
    name, plot = next(iter(plots.PLOTS.items()))
    for file in (name, *plot.data):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_bytes((DOCS / file).read_bytes())
    for module in ("docs_plots", "interval_plots"):
        monkeypatch.setattr(
            plots if module == "docs_plots" else sys.modules[module], "DOCS", tmp_path
        )
    assert plots.is_drawn(name)
    with (tmp_path / plot.data[0]).open("a", encoding="utf-8") as file:
        file.write("\n")
    assert not plots.is_drawn(name)


def test_every_plot_is_on_a_page():
    pages = [DOCS.parent / "README.md", *DOCS.rglob("*.md")]
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    assert [name for name in plots.PLOTS if name not in text] == []
