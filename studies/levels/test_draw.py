"""Law: pictures have room for more entries than there are, and each entry a mark of its own."""

import matplotlib as mpl
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from docs.scripts.plots import page_style

TWELVE = [f"an algorithm {letter}" for letter in "ABCDEFGHIJKL"]
KEY = ["level", "budget"]


def copied(table: pd.DataFrame) -> pd.DataFrame:
    """Rows of twelve entries in each level and budget, from those of its first one."""
    table = table[table["entry"] != "reference"]
    first = table.groupby(KEY)["entry"].transform("first") == table["entry"]
    return pd.concat(table[first].assign(entry=name) for name in TWELVE)


@pytest.fixture
def twelve(script, monkeypatch, tmp_path) -> None:
    """Tables of twelve entries in place of the committed ones."""
    for name in ("ENTRIES", "UNLIKE", "CURVES", "AREAS"):
        copied(pd.read_csv(getattr(script, name))).to_csv(tmp_path / f"{name}.csv", index=False)
        monkeypatch.setattr(script, name, tmp_path / f"{name}.csv")
    orders = pd.read_csv(script.ORDERS)
    orders = orders[orders["flock"] < 2]
    every = pd.concat([orders[orders["entry"] == "reference"], copied(orders)])
    every.to_csv(tmp_path / "orders.csv", index=False)
    every = script.trainings(tmp_path)
    monkeypatch.setattr(script, "trainings", lambda: every)
    pair = pd.read_csv(script.PAIRS)[:1]
    pairs = [
        pair.assign(better=better, worse=worse)
        for place, better in enumerate(TWELVE)
        for worse in TWELVE[place + 1 :]
    ]
    pd.concat(pairs).to_csv(tmp_path / "pairs.csv", index=False)
    monkeypatch.setattr(script, "PAIRS", tmp_path / "pairs.csv")


def drawn(script, name: str) -> Figure:
    plot = script.PLOTS[name]
    with mpl.rc_context(page_style()):
        size = plot.size() if callable(plot.size) else plot.size
        figure = Figure(figsize=size, layout="constrained")
        plot.draw(figure)
        figure.draw_without_rendering()
    return figure


def meet(texts: list[Text]) -> list[tuple[str, str]]:
    """Texts that overlap."""
    boxes = [(each.get_text(), each.get_window_extent()) for each in texts if each.get_text()]
    return [
        (words, others)
        for place, (words, box) in enumerate(boxes)
        for others, other in boxes[place + 1 :]
        if box.overlaps(other)
    ]


def test_names_of_twelve_entries_do_not_meet(script, twelve) -> None:
    figure = drawn(script, "scores")
    shown = [axes for axes in figure.axes if axes.get_visible()]
    for axes in shown:
        low, high = axes.get_ylim()[::-1]
        assert low <= -0.5
        assert high >= 11.5
    left = [axes for axes in shown if axes.get_subplotspec().is_first_col()]
    assert len(left) > 1
    for axes in left:
        labels = axes.get_yticklabels()
        assert [each.get_text() for each in labels] == TWELVE
        assert meet(labels) == []


def test_cells_of_twelve_entries_hold_their_numbers(script, twelve) -> None:
    (axes,) = drawn(script, "matrix").axes
    assert len(axes.texts) == 12 * 11
    assert meet([*axes.texts]) == []
    assert meet(axes.get_yticklabels()) == []


def test_twelve_entries_have_marks_of_their_own(script, twelve) -> None:
    figure = drawn(script, "unlike")
    (legend,) = figure.legends
    assert [each.get_text() for each in legend.texts] == TWELVE
    marks = {
        (line.get_marker(), line.get_markerfacecolor())
        for line in (handle.lines[0] for handle in figure.axes[0].containers)
    }
    assert len(marks) == 12
    assert meet([*legend.texts]) == []


def test_twelve_entries_have_a_panel_of_curves_and_a_line_of_the_profile(script, twelve) -> None:
    titles = [each.title for each in drawn(script, "curves").axes]
    assert [each.get_text() for each in titles] == TWELVE
    assert meet(titles) == []
    (axes,) = drawn(script, "profile").axes
    assert len({(line.get_color(), line.get_linestyle()) for line in axes.lines}) == 12
