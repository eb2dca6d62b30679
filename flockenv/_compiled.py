"""Whether the compiled simulator is there: imported before anything that needs it."""

from importlib.util import find_spec

if find_spec("flockenv._core") is None:
    raise ImportError(
        f"{__file__} is a source file of flockenv, without the compiled simulator beside it: "
        "start Python in another folder than the clone's, or run `make build` there"
    )
