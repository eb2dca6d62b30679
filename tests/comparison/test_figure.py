"""Law: the colors of policies are distinguishable, and a reference has its own in every figure."""

import itertools
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from flockenv.comparison.episodes import QUANTITIES
from flockenv.comparison.figure import COLORS, OWN_COLORS, leader_curve, policy_colors


def test_other_policies_have_colors_that_no_reference_has() -> None:
    colors = policy_colors(["mine.npz", "learned", "yours.npz"])
    assert list(colors.values()) == [OWN_COLORS[0], COLORS["learned"], OWN_COLORS[1]]


def test_no_two_policies_of_a_figure_look_alike() -> None:
    """Distances of colors are those of CIELAB, in which 2 to 3 are just seen apart."""
    for one, other in itertools.combinations([*COLORS.values(), *OWN_COLORS], 2):
        assert np.linalg.norm(lab(one) - lab(other)) > 25, (one, other)


def lab(color: str) -> NDArray[np.float64]:
    """The color in CIELAB under D65, from sRGB (IEC 61966-2-1)."""
    value = np.array(to_rgb(color))
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(np.array(to_xyz) @ linear / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_the_curve_has_the_colors_of_the_policies(tmp_path: Path, colors_in) -> None:
    names = ["learned", "mine.npz"]
    rows = [("a", name, k) for name in names for k in (1, 2)]
    means = pd.DataFrame(rows, columns=["case", "policy", "leaders"])
    for place, quantity in enumerate(QUANTITIES):
        means[quantity] = means[f"{quantity}_low"] = means[f"{quantity}_high"] = 0.1 * place
    means["signed_order"] += means["policy"].map({name: i for i, name in enumerate(names)})
    means["signed_order_low"] = means["signed_order"] - 0.2
    means["signed_order_high"] = means["signed_order"] + 0.2
    leader_curve(means, tmp_path / "curve.png", titles={"a": "a $title"})
    assert colors_in(tmp_path / "curve.png") == {"learned", OWN_COLORS[0]}
