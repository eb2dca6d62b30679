"""Stands in for a missing compiled simulator: Python finds an extension module first."""

raise ImportError(
    f"{__file__} is a source file of flockenv, without the compiled simulator beside it: "
    "start Python in another folder than the clone's, or run `make build` there"
)
