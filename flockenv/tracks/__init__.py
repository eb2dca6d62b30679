"""Tracks of real flocks read as recordings, and recordings written as tables and GSD."""

from flockenv.tracks.guess import guess_layout
from flockenv.tracks.layout import TrackLayout, description_of, read_layout
from flockenv.tracks.reader import read_tracks, recording_of
from flockenv.tracks.report import TrackReport
from flockenv.tracks.table import SUFFIXES, check_ending
from flockenv.tracks.writer import EXPORTS, export

__all__ = [
    "EXPORTS",
    "SUFFIXES",
    "TrackLayout",
    "TrackReport",
    "check_ending",
    "description_of",
    "export",
    "guess_layout",
    "read_layout",
    "read_tracks",
    "recording_of",
]
