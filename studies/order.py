"""What is measured of a run: means of its order, and histograms."""

import math

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import flockenv
from studies.store import Row

MOSTLY = 0.7
"""Share of a run's frames from which on it counts as mostly jammed or mostly rotating."""
PHI_EDGES = np.linspace(-math.pi, math.pi, 37)
PSI_EDGES = np.linspace(0.0, 1.0, 26)


def order_row(run: flockenv.Recording, after: float = 0.1) -> Row:
    """Return means over the analysis window after the first tenth of a run.

    A frame has a direction where Ψ_o ≥ 0.5: it is jammed where φ_o is within π/4 of the outward
    radial, and rotates where it is within π/4 of a tangent. Histograms of φ_o and Ψ_o are in
    thousandths of the frames.
    """
    order = run.analyzed(after).order
    m, outward, psi_o, phi_o = order.rotation(), order.outward(), order.psi_o, order.phi_o
    directed = psi_o >= 0.5
    off = abs(phi_o)
    rotates = directed & (abs(off - math.pi / 2) < math.pi / 4)
    return {
        "frames": len(psi_o),
        "psi_o": psi_o.mean(),
        "psi_o_sd": psi_o.std(),
        "m": m.mean(),
        "abs_m": abs(m).mean(),
        "outward": outward.mean(),
        "psi_v": order.psi_v.mean(),
        "c_v": order.c_v.mean(),
        "c_v_sd": order.c_v.std(),
        "jammed": (directed & (off <= math.pi / 4)).mean(),
        "cw": (rotates & (phi_o > 0)).mean(),
        "ccw": (rotates & (phi_o < 0)).mean(),
        "near_zero": (off < math.pi / 12).mean(),
        "phi_histogram": _histogram(phi_o, PHI_EDGES),
        "psi_histogram": _histogram(psi_o, PSI_EDGES),
    }


def _histogram(values: NDArray[np.float64], edges: NDArray[np.float64]) -> str:
    counts = np.histogram(values, edges)[0]
    return " ".join(str(round(1000 * share)) for share in counts / max(len(values), 1))


def histograms(column: pd.Series) -> NDArray[np.float64]:
    """Return the mean of stored histograms, in shares of the frames."""
    return np.array([text.split() for text in column], float).mean(axis=0) / 1000
