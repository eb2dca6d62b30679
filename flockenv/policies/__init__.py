"""Leader policies: closed-form laws, learned networks and plain ones to compare with."""

from flockenv.policies.base import LeaderPolicy, Policy
from flockenv.policies.constant import RandomRudders, StraightAhead
from flockenv.policies.laws import DampedLaw, LawPolicy, LeaningLaw, SteeringLaw
from flockenv.policies.model import ModelPolicy
from flockenv.policies.network import NetworkPolicy
from flockenv.policies.registry import load, policy
from flockenv.policies.wrapped import WrappedPolicy

__all__ = [
    "DampedLaw",
    "LawPolicy",
    "LeaderPolicy",
    "LeaningLaw",
    "ModelPolicy",
    "NetworkPolicy",
    "Policy",
    "RandomRudders",
    "SteeringLaw",
    "StraightAhead",
    "WrappedPolicy",
    "load",
    "policy",
]
