"""Runs, sampled at a fixed rate: saved and loaded."""

from flockenv.recording.checks import PHASES, PRECISIONS
from flockenv.recording.quantities import checked_functions
from flockenv.recording.recording import DISCARDED_SHARE, Recording
from flockenv.recording.stored import LayoutError, RecordingWarning

__all__ = [
    "DISCARDED_SHARE",
    "PHASES",
    "PRECISIONS",
    "LayoutError",
    "Recording",
    "RecordingWarning",
    "checked_functions",
]
