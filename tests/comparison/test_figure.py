"""Law: a policy has the same color in every figure, whatever it is compared with."""

import itertools
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb

from flockenv.comparison import figure
from flockenv.comparison.episodes import NO_LEADERS, QUANTITIES
from flockenv.comparison.figure import POLICY_COLORS, leader_curve, policy_colors
from flockenv.policies.registry import POLICIES, POOL_POLICIES


def test_every_named_policy_has_a_color_of_its_own() -> None:
    assert POLICY_COLORS.keys() == {NO_LEADERS, *POLICIES, *POOL_POLICIES}
    assert len(set(POLICY_COLORS.values())) == len(POLICY_COLORS)


def test_colors_do_not_depend_on_the_company() -> None:
    names = [*POLICIES, *POOL_POLICIES]
    for pair in itertools.permutations(names, 2):
        assert policy_colors(pair) == {name: POLICY_COLORS[name] for name in pair}


def test_other_policies_have_colors_that_no_named_one_has() -> None:
    colors = policy_colors(["mine.npz", "learned", "yours.npz", "mine.npz"])
    assert list(colors) == ["mine.npz", "learned", "yours.npz"]
    assert len(set(colors.values())) == 3
    assert {colors["mine.npz"], colors["yours.npz"]}.isdisjoint(POLICY_COLORS.values())


def test_the_curve_has_the_colors_of_the_table(tmp_path: Path, monkeypatch) -> None:
    drawn = {}

    def draw(axes, shown, line, shift, color):
        drawn[shown.label] = color
        axes.plot([0], [0], color=color, label=shown.label)

    monkeypatch.setattr(figure, "_draw_policy", draw)
    names = ["learned", "tuned damped law", "mine.npz"]
    rows = [(name, k) for name in names for k in (1, 2)]
    runs = pd.DataFrame(rows, columns=["policy", "leaders"])
    for quantity in QUANTITIES:
        runs[quantity] = runs[f"{quantity}_low"] = runs[f"{quantity}_high"] = 0.5
    leader_curve(runs, runs, {}, "a title", tmp_path / "curve.png")
    assert drawn == policy_colors(names)
    assert np.allclose(to_rgb(drawn["learned"]), to_rgb(POLICY_COLORS["learned"]))
