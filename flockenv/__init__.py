"""Flocks of leader-steered rigid boats in a pool, simulated in Rust."""

from importlib.metadata import version

from flockenv._core import Flock
from flockenv.contacts import Contacts
from flockenv.errors import FlockError, ParameterError, SolverError
from flockenv.order_parameters import OrderParameters, OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.recording import Recording, simulate
from flockenv.statistics import Statistics

__all__ = [
    "Contacts",
    "Flock",
    "FlockError",
    "FlockParameters",
    "OrderParameters",
    "OrderSeries",
    "ParameterError",
    "Recording",
    "SolverError",
    "Statistics",
    "__version__",
    "simulate",
]

__version__ = version("flockenv")
