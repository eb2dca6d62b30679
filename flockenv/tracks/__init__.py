"""Doors for data: tracks of real flocks in, recordings out to tables and GSD."""

from flockenv.tracks.assemble import recording_of
from flockenv.tracks.guess import guess_layout
from flockenv.tracks.layout import TrackLayout, layout_beside, read_layout
from flockenv.tracks.reader import (
    SUFFIXES,
    TrackReport,
    Tracks,
    from_movement,
    from_table,
    load_tracks,
    read_tracks,
)
from flockenv.tracks.writer import EXPORTS, export

__all__ = [
    "EXPORTS",
    "SUFFIXES",
    "TrackLayout",
    "TrackReport",
    "Tracks",
    "export",
    "from_movement",
    "from_table",
    "guess_layout",
    "layout_beside",
    "load_tracks",
    "read_layout",
    "read_tracks",
    "recording_of",
]
