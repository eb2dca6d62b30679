"""The paper's figures and claims, reproduced: `flockenv reproduce`."""

from flockenv.reproduce.catalogue import ALL, names

__all__ = ["ALL", "names"]
