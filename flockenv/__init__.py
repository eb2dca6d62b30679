"""Flocks of leader-steered rigid boats in a pool, simulated in Rust."""

from importlib.metadata import version

__all__ = ["__version__"]

__version__ = version("flockenv")
