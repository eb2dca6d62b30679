"""Law: the colors of policies are distinguishable, and a reference has its own in every figure."""

from pathlib import Path

import pandas as pd

from flockenv.comparison.episodes import QUANTITIES
from flockenv.comparison.figure import OTHER_COLORS, leader_curve


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
    assert colors_in(tmp_path / "curve.png") == {"learned", OTHER_COLORS[0]}
