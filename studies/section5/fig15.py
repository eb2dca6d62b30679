"""Figure 15: Ψ_o against noise, n = 20 and 50, without and with leaders."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from studies.claim import Claims, Interval, bca, mean
from studies.section5.section5 import HIGH_S, LOW_S, SERIES, Evidence, draw_means, judging_presets
from studies.study import main


def judge(e: Evidence) -> Claims:
    """Judge what the paper says of figure 15."""
    claims = Claims("5.2", e.name)
    free = e.of(20, 0)
    if len(free) and free["bw_s"].max() >= HIGH_S:
        low, high = (e.over(20, 0, "psi_o", *ends) for ends in ((0.0, LOW_S), (HIGH_S, 9.0)))
        claims.add(
            "The degree of ordering drops as bw grows",
            f"mean Ψ_o at bw ≤ {LOW_S:g} s minus that at bw ≥ {HIGH_S:g} s, k = 0; "
            "read as at least 0.2",
            mean(low - high),
            least=0.2,
            n="20",
        )
    for n, k in SERIES:
        runs = e.of(n, k)
        if runs["bw_s"].nunique() > 3:
            claims.add(
                f"Order is lost at bw of 0.6 to 0.8 s, {'with' if k else 'without'} leaders",
                f"critical bw (s), k = {k}",
                e.critical(n, k),
                least=0.6,
                most=0.8,
                n=str(n),
            )
    noises = sorted(free["bw_s"].unique())
    if len(noises) > 3 and np.allclose(np.diff(noises[:9]), 0.1):
        claims.add(
            "The transition from order to disorder is smooth",
            "largest fall of mean Ψ_o within 0.1 s over its whole fall, k = 0; "
            "read as at most half",
            steepest(e.groups(20, 0, "psi_o")),
            most=0.5,
            n="20",
        )
    return claims


def steepest(groups: Sequence[Any]) -> Interval:
    """Return the largest fall of mean Ψ_o from one noise to the next over its whole fall."""

    def of(*drawn: Any) -> Any:
        psi_o = np.stack(np.broadcast_arrays(*(group[..., 0].mean(-1) for group in drawn)))
        return (psi_o[:-1] - psi_o[1:]).max(0) / (psi_o.max(0) - psi_o.min(0))

    return bca(groups, of)


script = judging_presets(
    "fig15", judge, partial(draw_means, name="fig15", column="psi_o", label="mean Ψ_o")
)

if __name__ == "__main__":
    main(script)
