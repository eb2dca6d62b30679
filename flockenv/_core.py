"""Stands in for the compiled simulator where it is missing: an extension module comes first."""

raise ImportError(
    f"{__file__} is a source file of flockenv, without the compiled simulator beside it: "
    "start Python in another folder than the clone's, or run `make build` there"
)
