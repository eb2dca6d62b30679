"""Figure 16: C_v against noise, n = 20 and 50, without and with leaders."""

from functools import partial
from typing import Any

import numpy as np

from studies.claim import Claims, bca, mean
from studies.section5.section5 import LOW_S, Evidence, draw_means, judging_presets
from studies.study import main


def judge(e: Evidence) -> Claims:
    """Judge what the paper says of figure 16, and of density."""
    claims = Claims("5.2", e.name)
    few, many = (e.groups(n, 0, "c_v", "abs_m") for n in (20, 50))
    dense = e.over(50, 0, "c_v", 0.0, LOW_S)
    if len(dense) and few:
        claims.add(
            "50 boats have low C_v at low noise",
            f"mean C_v of 50 boats at bw ≤ {LOW_S:g} s over the highest of 20 boats, k = 0; "
            "read as at most half",
            bca([dense[:, None], *few], lambda low, *sparse: low[..., 0].mean(-1) / _best(sparse)),
            most=0.5,
            n="50",
        )
    led = e.over(50, 10, "c_v", 0.0, LOW_S)
    if len(led) and len(led) == len(dense):
        claims.add(
            "C_v of 50 boats at low noise is lowest without leaders",
            f"mean C_v with 10 leaders minus without, bw ≤ {LOW_S:g} s (cm²/s²)",
            mean(led - dense),
            least=0.0,
            n="50",
        )
    if len(many) > 3 and len(few) > 3:
        for column, name in enumerate(("C_v", "|m|")):
            claims.add(
                f"Density lowers the best order that noise can give, by {name}",
                f"highest mean {name} of any bw, n = 50 minus n = 20, k = 0",
                bca(
                    [*many, *few],
                    lambda *drawn, c=column: (
                        _best(drawn[: len(many)], c) - _best(drawn[len(many) :], c)
                    ),
                ),
                most=0.0,
                n="20, 50",
            )
    return claims


def _best(groups: Any, column: int = 0) -> Any:
    return np.stack(np.broadcast_arrays(*(group[..., column].mean(-1) for group in groups))).max(0)


script = judging_presets(
    "fig16", judge, partial(draw_means, name="fig16", column="c_v", label="mean C_v (cm²/s²)")
)

if __name__ == "__main__":
    main(script)
