"""Law: a policy has the same color in every figure, whatever it is compared with."""

import itertools
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from flockenv.cli.compare_options import REFERENCES
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


def test_no_two_policies_of_a_figure_look_alike() -> None:
    """Distances of colors are those of CIELAB, in which 2 to 3 are just seen apart."""
    shown = policy_colors(["mine.npz", "yours.npz", *REFERENCES, NO_LEADERS])
    for one, other in itertools.combinations(shown.values(), 2):
        assert np.linalg.norm(lab(one) - lab(other)) > 25, (one, other)


def lab(color: str) -> NDArray[np.float64]:
    """The color in CIELAB under D65, from sRGB (IEC 61966-2-1)."""
    value = np.array(to_rgb(color))
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(np.array(to_xyz) @ linear / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_the_curve_has_the_colors_of_the_policies(tmp_path: Path, colors_in) -> None:
    names = ["learned", "straight ahead", "mine.npz"]
    rows = [("a", name, k) for name in names for k in (1, 2)]
    means = pd.DataFrame(rows, columns=["case", "policy", "leaders"])
    for place, quantity in enumerate(QUANTITIES):
        means[quantity] = means[f"{quantity}_low"] = means[f"{quantity}_high"] = 0.1 * place
    means["signed_order"] += means["policy"].map({name: i for i, name in enumerate(names)})
    means["signed_order_low"] = means["signed_order"] - 0.2
    means["signed_order_high"] = means["signed_order"] + 0.2
    leader_curve(means, tmp_path / "curve.png", titles={"a": "a $title"})
    assert colors_in(tmp_path / "curve.png") == {*policy_colors(names).values()}
