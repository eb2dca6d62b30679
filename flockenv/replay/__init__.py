"""Replays: recordings as one self-contained HTML page. Nothing upstream imports this package."""

from flockenv.replay.page import MOST_BYTES, MOST_INLINE_BYTES, Replay, inline_replay, write_replay

__all__ = ["MOST_BYTES", "MOST_INLINE_BYTES", "Replay", "inline_replay", "write_replay"]
