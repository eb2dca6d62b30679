"""Report of tracks: what was used, what was left out, and what is doubtful."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import Floats, Motion

if TYPE_CHECKING:
    import pandas as pd

_LOW_COSINE, _MANY_SAMPLES, _MANY_TOGETHER = 0.3, 20, 6
_MANY_OUTSIDE, _LONG_STEP_S, _SLOW_CM_S = 0.1, 10.0, 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackReport:
    """Report of tracks: what was used, and what was left out. As text it names what is doubtful."""

    frames: int  #: Number of different times.
    boats: int  #: Number of different names.
    samples: int  #: Number of used poses.
    #: Number of frames without a pose, summed over boats; frames without any row count, too.
    missing: int
    duration_s: float  #: Time from first to last frame; a wrong `fps` shows in it.
    step_s: float  #: Median step between two frames.
    #: Median of the boats' speeds, NaN without any. A wrong `fps` or `cm_per_unit` shows in it.
    median_speed_cm_s: float
    #: Omitted rows by reason and boat; the boat is "" for rows without one.
    left_out: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    #: How often the time goes back between two successive rows of a boat; the rows are then sorted.
    unsorted: int = 0
    #: Whether the column of names is empty, so that all rows belong to one boat.
    unnamed: bool = False
    #: Number of gaps between two poses of a boat, and the length of the longest gap in s.
    gaps: int = 0
    longest_gap_s: float = 0.0
    #: Steps faster than the highest speed, for example from wrong detections or exchanged names.
    #: Both samples are used, but no velocity is computed across the step.
    broken: int = 0
    #: Samples without a neighbor in time. They have no velocity, and quantities leave them out.
    lone: int = 0
    #: Mean cosine between heading and motion, weighted by speed: near 1 for boats that move
    #: ahead, small or negative if axes, units or directions are wrong; NaN if nothing moves.
    cosine: float = float("nan")
    #: Boats that are at exactly one point in at least 20 samples and a tenth of all their samples,
    #: or at a point where boats are together in at least six samples. Holds x and y in units of
    #: the file, and the boat's number of samples there.
    stuck: Mapping[str, tuple[float, float, int]] = field(default_factory=dict)
    #: Boats that move, but have one heading in at least 20 samples and each other heading in at
    #: most a tenth as many. Holds the number of samples with that heading.
    held: Mapping[str, int] = field(default_factory=dict)

    def named(self) -> dict[str, Any]:
        """Return the attributes by name, with None for NaN."""
        return {name: None if value != value else value for name, value in asdict(self).items()}

    def __str__(self) -> str:
        counts = {why: sum(boats.values()) for why, boats in self.left_out.items()}
        reasons = [f"{n} {why}{_by_boat(self.left_out[why])}" for why, n in counts.items()]
        longest = f", the longest {self.longest_gap_s:.4g} s" if self.gaps else ""
        lines = [
            f"{self.samples} poses of {self.boats} boats in {self.frames} frames; "
            f"missing: {self.missing} of {self.samples + self.missing} boat-frames",
            f"{self.duration_s:.6g} s, a frame every {self.step_s:.4g} s; median speed "
            f"{self.median_speed_cm_s:.3g} cm/s",
            f"left out: {sum(counts.values())} rows"
            + (f" ({', '.join(reasons)})" if counts else ""),
            f"gaps: {self.gaps}{longest}; steps too fast for a velocity: {self.broken}; "
            f"samples without a velocity: {self.lone}",
            f"mean cosine between heading and motion: {self.cosine:.2f}",
        ]
        return "\n  ".join([*lines, *self._doubts(counts.get("outside the water", 0))])

    def _doubts(self, outside: int) -> list[str]:
        """Return a line about each unusual value, which may be correct.

        `outside` is the number of rows outside the water.
        """
        share_outside = outside / max(1, outside + self.samples)
        points = [
            f"{name} at ({x:.6g}, {y:.6g}) in {count} frames"
            for name, (x, y, count) in self.stuck.items()
        ]
        are_all_lone = self.lone == self.samples and self.frames > 1
        is_slow = self.step_s > _LONG_STEP_S or 0.0 < self.median_speed_cm_s < _SLOW_CM_S
        doubts = {
            "no boat appears in two successive frames: are the names right?": are_all_lone,
            "the cosine is far from 1: are y_down, heading_unit, heading_turns, heading_zero and "
            "the order of x and y right, and are the headings not axes?": self.cosine < _LOW_COSINE,
            f"rows are not in the order of time ({self.unsorted} steps back), and were sorted: is "
            "it one film?": self.unsorted > 0,
            "the column of names is empty: all rows are of one boat": self.unnamed,
            "that is slow for boats: are times in s? `fps` says how many units one second has": (
                is_slow
            ),
            f"{share_outside:.0%} of the detections lie beside the pool: do cm_per_unit, center "
            "and pool fit?": share_outside > _MANY_OUTSIDE,
            f"the same point in many frames: {_first_five(points)}; if one stands for a lost boat, "
            "name it in `lost`": len(points) > 0,
            f"the same heading in many frames{_by_boat(self.held)}; if a number stands for no "
            "heading, name it in `missing`": len(self.held) > 0,
        }
        return [words for words, is_doubtful in doubts.items() if is_doubtful]


def _by_boat(boats: Mapping[str, int]) -> str:
    """Return ": name count, ..." of the boats with the largest counts; "" without names."""
    named = sorted(((count, name) for name, count in boats.items() if name), reverse=True)
    return f": {_first_five([f'{name} {count}' for count, name in named])}" if named else ""


def _first_five(words: list[str]) -> str:
    more = [f"{len(words) - 5} more boats"] if len(words) > 5 else []
    return ", ".join(words[:5] + more)


def report_of(
    samples: "pd.DataFrame", time_s: Floats, pose: Floats, motion: Motion, layout: TrackLayout
) -> TrackReport:
    """Return the report of used and omitted samples, without `unsorted` and `unnamed`."""
    speed = np.hypot(*np.moveaxis(motion.velocity, -1, 0)[:2])
    used, omitted = samples[samples["why"] == ""], samples[samples["why"] != ""]
    counts = omitted.fillna({"id": ""}).groupby(["why", "id"]).size()
    gaps_s = np.concatenate([gaps for _, gaps in map(motion.split, range(pose.shape[1]))])
    steps, speeds, count = np.diff(time_s), speed[~np.isnan(speed)], int(motion.present.sum())
    step_s = float(np.median(steps)) if len(steps) else 0.0
    # Frames without any row are those that a gap in the times skips on a regular clock.
    empty_frames = int((np.rint(steps[steps > motion.longest_s] / step_s) - 1).sum())
    return TrackReport(
        frames=len(time_s),
        boats=pose.shape[1],
        samples=count,
        missing=pose.shape[1] * (len(time_s) + empty_frames) - count,
        duration_s=float(time_s[-1]),
        step_s=step_s,
        median_speed_cm_s=float(np.median(speeds)) if len(speeds) else float("nan"),
        left_out={why: counts[why].to_dict() for why in counts.index.unique(0)},
        gaps=len(gaps_s),
        longest_gap_s=float(gaps_s.max(initial=0.0)),
        broken=motion.broken,
        lone=int((motion.present & np.isnan(speed)).sum()),
        cosine=motion.cosine(pose[..., 2]),
        stuck=_stuck(used, layout),
        held=_held(used) if layout.has_headings else {},
    )


def _stuck(used: "pd.DataFrame", layout: TrackLayout) -> dict[str, tuple[float, float, int]]:
    """Return boats that stay at exactly one point in many samples, as `TrackReport.stuck`."""
    counts = used.value_counts(["id", "x", "y"]).reset_index()
    tenth = counts.groupby("id")["count"].transform("sum") / 10
    # Hulls do not overlap, so several boats at one point in many samples are lost ones.
    shared = used[used.duplicated(["frame", "x", "y"], keep=False)].value_counts(["x", "y"])
    is_shared = counts.set_index(["x", "y"]).index.isin(shared.index[shared >= _MANY_TOGETHER])
    counts = counts[is_shared | ((counts["count"] >= _MANY_SAMPLES) & (counts["count"] >= tenth))]
    (center_x, center_y), x_scale = layout.center, layout.cm_per_unit or 1.0
    y_scale = -x_scale if layout.y_down else x_scale
    stuck = counts.drop_duplicates("id").itertuples(index=False)
    return {
        str(name): (x_cm / x_scale + center_x, y_cm / y_scale + center_y, int(count))
        for name, x_cm, y_cm, count in stuck
    }


def _held(used: "pd.DataFrame") -> dict[str, int]:
    """Return boats that move with one heading in many samples, as `TrackReport.held`."""
    # A boat at rest keeps its heading, so samples at one point count once.
    moving = used.drop_duplicates(["id", "x", "y"])
    counts: Any = moving.value_counts(["id", "heading"]).groupby("id")
    # `value_counts` sorts, so a boat's entry 1 is its second most frequent heading.
    most, second = counts.max(), counts.nth(1).droplevel("heading")
    held = most[(most >= _MANY_SAMPLES) & (most >= 10 * second.reindex(most.index, fill_value=0))]
    return {str(name): int(count) for name, count in held.items()}
