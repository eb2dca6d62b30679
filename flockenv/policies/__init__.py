"""Leader policies: closed-form laws, learned networks and plain ones to compare with."""

from flockenv.policies.constant import RandomRudders, StraightAhead
from flockenv.policies.discrete import WithLevels
from flockenv.policies.laws import DampedLaw, ObservedPolicy, SignCorrectedLaw, SteeringLaw
from flockenv.policies.leaning_law import HiddenUnits, LeaningLaw
from flockenv.policies.model import ModelPolicy
from flockenv.policies.network import NetworkPolicy
from flockenv.policies.pretrained import load

__all__ = [
    "DampedLaw",
    "HiddenUnits",
    "LeaningLaw",
    "ModelPolicy",
    "NetworkPolicy",
    "ObservedPolicy",
    "RandomRudders",
    "SignCorrectedLaw",
    "SteeringLaw",
    "StraightAhead",
    "WithLevels",
    "load",
]
