"""Leader policies: closed-form laws, learned networks and plain ones to compare with."""

from flockenv.policies.laws import DampedLaw, ObservedPolicy, SignCorrectedLaw, SteeringLaw
from flockenv.policies.leaning_law import LeaningLaw
from flockenv.policies.levels import WithLevels
from flockenv.policies.loading import load
from flockenv.policies.network import NetworkPolicy
from flockenv.policies.plain import RandomRudders, StraightAhead

__all__ = [
    "DampedLaw",
    "LeaningLaw",
    "NetworkPolicy",
    "ObservedPolicy",
    "RandomRudders",
    "SignCorrectedLaw",
    "SteeringLaw",
    "StraightAhead",
    "WithLevels",
    "load",
]
