"""The paper's figures and claims, reproduced: `flockenv reproduce`."""

from flockenv.reproduce.catalogue import ALL, names, require_packages

__all__ = ["ALL", "names", "require_packages"]
