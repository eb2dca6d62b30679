"""Colors of pictures by name, declared in `src/draw/palette.rs`."""

from collections.abc import Mapping

from flockenv import _core

PALETTE: Mapping[str, str] = _core.PALETTE
"""Colors of frames, and of pages on light ground: water, boats, leaders, and so on."""

OKABE_ITO: Mapping[str, str] = _core.OKABE_ITO
"""Colors of plots, in their order of use; color-blind people can tell them apart."""
