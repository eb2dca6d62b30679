"""Flocks of leader-steered rigid boats in a pool, simulated in Rust."""

import importlib
from importlib.metadata import version
from typing import Any

from flockenv import policies
from flockenv.envs.parallel import LeadersParallelEnv, env, parallel_env
from flockenv.envs.registration import register
from flockenv.envs.single import LeadersEnv
from flockenv.envs.vector import LeadersVectorEnv
from flockenv.errors import (
    EpisodeError,
    FlockError,
    InUseError,
    ParameterError,
    SolverError,
)
from flockenv.flock import Contacts, ContactSeries, Flock, Statistics
from flockenv.order import OrderParameters, OrderSeries, order_series
from flockenv.parameters import FlockParameters
from flockenv.recording import Recording
from flockenv.simulation import simulate

__all__ = [
    "ContactSeries",
    "Contacts",
    "EpisodeError",
    "Flock",
    "FlockError",
    "FlockParameters",
    "InUseError",
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
    "env",
    "order_series",
    "parallel_env",
    "policies",
    "simulate",
]

__version__ = version("flockenv")

register()


def __getattr__(name: str) -> Any:
    # What belongs to other libraries takes seconds to import: only for those who use it.
    if name in ("benchmarl", "rllib", "sb3", "torchrl"):
        return importlib.import_module(f"flockenv.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
