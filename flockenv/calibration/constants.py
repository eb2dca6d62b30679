"""The constants that a fit may free, with their bounds, and the readings of the pool."""

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["CONSTANTS", "POOLS", "Constant"]

POOLS = ("table-1", "500-boats")
"""Both readings of the pool's size; each gets as many trials as the other."""


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant of the boats that the paper leaves open.

    Attributes
    ----------
    low, high : float
        Bounds.
    is_log : bool
        Whether its logarithm is searched; otherwise the constant itself.
    reason : str
        Where the bounds come from.
    """

    low: float
    high: float
    is_log: bool
    reason: str

    def at(self, place: float) -> float:
        """Return the value at a place from 0 to 1 between the bounds, to four digits."""
        if self.is_log:
            value = self.low * (self.high / self.low) ** place
        else:
            value = self.low + (self.high - self.low) * place
        return float(f"{value:.4g}")


CONSTANTS: Mapping[str, Constant] = {
    "c0": Constant(0.3, 3.0, True, "Table 3 has 1 /s: a boat nears its speed within 2 s of fw"),
    "c1": Constant(0.05, 5.0, True, "Table 3 has 1 s; Table 1's backing turn narrows it"),
    "c2": Constant(0.05, 4.0, True, "Table 3 has 0.1 /(cm·s): the strength of leaders' rudders"),
    "c3": Constant(0.03, 1.0, True, "Table 3 has 1 /cm, for another range of noise"),
    "c4": Constant(1e-3, 0.1, True, "Table 3 has 0.1 rad/s^1.5, waves included (Section 4.5)"),
    "speed_cm_s": Constant(10.0, 20.0, False, "Table 1: 15 ± 5 cm/s in fw"),
    "reverse_speed_cm_s": Constant(2.0, 12.0, True, "Section 3.2: much slower in bw than in fw"),
    "speed_spread_cm_s": Constant(0.0, 5.0, False, "Table 1: 15 ± 5 cm/s, read as a spread"),
    "turning_bias": Constant(1e-4, 0.1, True, "Section 4.5: a slight bias, counter-clockwise"),
    "current_gain": Constant(0.01, 0.4, True, "Section 4.5: 3 to 5 cm/s beside boats of 10 to 15"),
    "leader_speed_factor": Constant(0.667, 1.333, True, "Section 2.6: similar; Table 1: 15 ± 5"),
}
"""Constants that can be freed. Leaders' own rudder strength is c2, as no other boat steers."""
