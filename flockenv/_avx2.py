"""The simulator compiled for AVX2: wheels hold it beside the portable one."""

import sys
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path

from flockenv import _core


def choose() -> None:
    """Replace `flockenv._core` by the AVX2 build, if it exists and the processor has AVX2.

    Both builds compute the same bits.
    """
    if _core.USES_AVX2 or not _core.HAS_AVX2:
        return
    name, file = _core.__name__, Path(str(_core.__file__))
    path = file.with_name(file.name.replace("_core", "_core_avx2", 1))
    if path.exists():
        loader = ExtensionFileLoader(name, str(path))
        spec = ModuleSpec(name, loader, origin=str(path))
        spec.has_location = True
        module = module_from_spec(spec)
        loader.exec_module(module)
        sys.modules[name] = module
        vars(sys.modules["flockenv"])["_core"] = module
