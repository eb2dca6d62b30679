"""Replays: recordings as one self-contained HTML page. Nothing upstream imports this package."""

from flockenv.replay.page import MOST_BYTES, Replay, write_replay

__all__ = ["MOST_BYTES", "Replay", "write_replay"]
