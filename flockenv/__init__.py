"""Flocks of leader-steered rigid boats in a pool, simulated in Rust."""

import importlib
from importlib.metadata import version
from types import ModuleType

from flockenv import _compiled as _compiled
from flockenv import policies
from flockenv._core import Flock
from flockenv.contacts import Contacts, ContactSeries
from flockenv.errors import EpisodeError, FlockError, ParameterError, SolverError
from flockenv.order_parameters import OrderParameters, OrderSeries
from flockenv.parallel_env import LeadersParallelEnv, parallel_env
from flockenv.parameters import FlockParameters
from flockenv.recording import Recording
from flockenv.registration import register
from flockenv.simulation import simulate
from flockenv.single_env import LeadersEnv
from flockenv.statistics import Statistics
from flockenv.vector_env import LeadersVectorEnv

__all__ = [
    "ContactSeries",
    "Contacts",
    "EpisodeError",
    "Flock",
    "FlockError",
    "FlockParameters",
    "LeadersEnv",
    "LeadersParallelEnv",
    "LeadersVectorEnv",
    "OrderParameters",
    "OrderSeries",
    "ParameterError",
    "Recording",
    "SolverError",
    "Statistics",
    "__version__",
    "parallel_env",
    "policies",
    "simulate",
]

__version__ = version("flockenv")

register()


def __getattr__(name: str) -> ModuleType:
    # stable-baselines3 takes seconds to import: only for those who use it.
    if name == "sb3":
        return importlib.import_module("flockenv.sb3")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
