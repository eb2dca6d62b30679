"""The corpus of honest tables: programs, orders, clocks, spellings, headings, lost animals."""

import gzip
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from .honest import ANGLE, BOATS, HZ, PLACE, Honest, Rows, rows
from .program_tables import SLEAP_COLUMNS, sleap, wide
from .programs import DATASETS, PROGRAMS

PLAIN = {**PLACE, **ANGLE, "fps": HZ}
_rng = np.random.default_rng(5)


def _swapped(table: Rows) -> Rows:
    """As a logger with threads writes: neighbors change places."""
    place = np.arange(len(table))
    at = np.arange(3, len(table) - 9, 13)
    place[at], place[at + BOATS] = place[at + BOATS].copy(), place[at].copy()
    return table.iloc[place]


ORDERS: dict[str, Callable[[Rows], Rows]] = {
    "as it was": lambda t: t,
    "by boat": lambda t: t.sort_values(["id", "frame"]),
    "shuffled": lambda t: t.sample(frac=1.0, random_state=1),
    "newest first": lambda t: t[::-1],
    "leaders, then others": lambda t: pd.concat([t[t["id"] <= 2], t[t["id"] > 2]]),
    "late block first": lambda t: pd.concat([t[t["frame"] >= 70], t[t["frame"] < 70]]),
    "neighbors swapped": _swapped,
    "every second frame, then the others": lambda t: pd.concat(
        [t[t["frame"] % 2 == 0], t[t["frame"] % 2 == 1]]
    ),
}
START = pd.Timestamp("2026-03-29 01:59:57")
CLOCKS: dict[str, tuple[Callable[[Any], Any], dict[str, Any]]] = {
    "frames": (lambda s: np.rint(s * HZ).astype(int), {"fps": HZ}),
    "later frames": (lambda s: np.rint(s * HZ).astype(int) + 12345, {"fps": HZ}),
    "every third frame": (lambda s: np.rint(s * 3 * HZ).astype(int), {"fps": 3 * HZ}),
    "frames as decimals": (lambda s: np.rint(s * HZ), {"fps": HZ}),
    "s": (lambda s: s, {"fps": None}),
    "s by fps": (lambda s: s, {"fps": 1.0}),
    "Unix time": (lambda s: s + 1.7e9, {"fps": None}),
    "ms": (lambda s: np.rint(s * 1e3).astype(int), {"fps": 1e3}),
    "ms with decimals": (lambda s: s * 1e3 + 0.02, {"fps": 1e3}),
    "µs": (lambda s: np.rint(s * 1e6).astype(np.int64), {"fps": 1e6}),
    "ns since 1970": (
        lambda s: np.rint(s * 1e9).astype(np.int64) + 1_700_000_000 * 10**9,
        {"fps": 1e9},
    ),
    "minutes": (lambda s: s / 60, {"fps": 1 / 60}),
    "hours": (lambda s: s / 3600, {"fps": 1 / 3600}),
    "dates": (lambda s: START + pd.to_timedelta(s, "s"), {"fps": None}),
    "ISO dates": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ"),
        {"fps": None},
    ),
    "clock": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%H:%M:%S.%f"),
        {"fps": None},
    ),
    "clock past midnight": (
        lambda s: (pd.Timestamp("2026-03-29 23:59:52") + pd.to_timedelta(s, "s")).dt.strftime(
            "%H:%M:%S.%f"
        ),
        {"fps": None},
    ),
    "dates with commas": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%Y-%m-%d %H:%M:%S,%f"),
        {"fps": None},
    ),
    "German dates": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%d.%m.%Y %H:%M:%S,%f"),
        {"fps": None},
    ),
    "a stopwatch": (
        lambda s: (pd.Timestamp(0) + pd.to_timedelta(s + 50.0, "s")).dt.strftime("%M:%S.%f"),
        {"fps": None},
    ),
    "stamps of each boat": (None, {"fps": None}),
}
SPELLINGS: dict[str, tuple[str, dict[str, Any], dict[str, Any], Callable[[bytes], bytes]]] = {
    "commas": ("t.csv", {}, {}, bytes),
    "semicolons": ("t.csv", {"sep": ";"}, {"separator": ";"}, bytes),
    "a German export": (
        "t.csv",
        {"sep": ";", "decimal": ","},
        {"separator": ";", "decimal": ","},
        bytes,
    ),
    "tabs": ("t.tsv", {"sep": "\t"}, {}, bytes),
    "tabs and decimal commas": ("t.tsv", {"sep": "\t", "decimal": ","}, {"decimal": ","}, bytes),
    "tabs in a text": ("t.txt", {"sep": "\t"}, {"separator": "\t"}, bytes),
    "blanks in a text": ("t.txt", {"sep": " "}, {"separator": " "}, bytes),
    "commas in a text": ("t.txt", {}, {}, bytes),
    "bars": ("t.csv", {"sep": "|"}, {"separator": "|"}, bytes),
    "gzip": ("t.csv.gz", {}, {}, gzip.compress),
    "gzipped tabs": ("t.tsv.gz", {"sep": "\t"}, {}, gzip.compress),
    "gzipped text": ("t.txt.gz", {"sep": ";"}, {"separator": ";"}, gzip.compress),
    "UTF-8 with a mark": ("t.csv", {}, {}, lambda b: b"\xef\xbb\xbf" + b),
    "UTF-16": ("t.csv", {}, {}, lambda b: b.decode().encode("utf-16")),
    "Windows lines": ("T.CSV", {}, {}, lambda b: b.replace(b"\n", b"\r\n")),
    "Macintosh lines": ("t.csv", {}, {}, lambda b: b.replace(b"\n", b"\r")),
    "blank lines": ("t.csv", {}, {}, lambda b: b.replace(b"\n", b"\n\n")),
    "blanks after commas": ("t.csv", {}, {}, lambda b: b.replace(b",", b", ")),
    "Excel's word for it": (
        "t.csv",
        {"sep": ";"},
        {"separator": ";", "skip": 1},
        lambda b: b"sep=;\n" + b,
    ),
    "remarks above": ("t.csv", {}, {"skip": 2}, lambda b: b"# made by a camera\n# 10 Hz\n" + b),
    "a remark mark": ("t.csv", {}, {}, lambda b: b"#" + b),
    "commas at the ends": ("t.csv", {}, {}, lambda b: b.replace(b"\n", b",\n")),
    "quotes": ("t.csv", {"quoting": 1}, {}, bytes),
    "an index": ("t.csv", {"index": True}, {}, bytes),
    "large names": ("t.csv", {}, {}, lambda b: b.split(b"\n")[0].upper() + b[b.index(b"\n") :]),
    "exponents": ("t.csv", {"float_format": "%.9e"}, {}, bytes),
    "no header": (
        "t.csv",
        {"header": False},
        {"header": ["frame", "id", "x", "y", "angle", *(f"p{n}" for n in range(4))]},
        bytes,
    ),
}
DEGREES: dict[str, tuple[Callable[[Any, Any], Any], dict[str, Any]]] = {
    "degrees": (lambda a, t: a, {"heading_unit": "deg"}),
    "signed degrees": (lambda a, t: (a + 180) % 360 - 180, {"heading_unit": "deg"}),
    "radians": (lambda a, t: np.radians(a), {"heading_unit": "rad"}),
    "signed radians": (lambda a, t: np.radians((a + 180) % 360 - 180), {"heading_unit": "rad"}),
    "turns": (lambda a, t: a / 360, {"heading_unit": "turn"}),
    "a compass": (
        lambda a, t: (a + 90) % 360,
        {"heading_unit": "deg", "heading_zero": "up", "heading_turns": "cw"},
    ),
    "mathematics": (lambda a, t: -a % 360, {"heading_unit": "deg", "heading_turns": "ccw"}),
    "from the left": (
        lambda a, t: (a + 180) % 360,
        {"heading_unit": "deg", "heading_zero": "left"},
    ),
    "radians that go on": (
        lambda a, t: np.radians(a + 360 * (t["frame"] // 20)),
        {"heading_unit": "rad", "wrapped": False},
    ),
    "degrees that go on": (
        lambda a, t: a - 360 * (t["frame"] // 20),
        {"heading_unit": "deg", "wrapped": False},
    ),
}
LOST: dict[str, tuple[Any, dict[str, Any]]] = {
    "zeros": (0.0, {"lost": [[0, 0]]}),
    "zeros beside the pool": (0.0, {}),
    "minus one": (-1.0, {"lost": [[-1, -1]]}),
    "nothing": (None, {}),
    "NaN": (np.nan, {}),
    "NA": ("NA", {}),
    "a dash": ("-", {}),
    "infinite": (np.inf, {}),
    "a word": ("lost", {"missing": ["lost"]}),
    "a number": (-999, {"missing": ["-999"]}),
    "no row": ("drop", {}),
}


def _wide_rows(order: str) -> Rows:
    """One row per frame, in an order that a table of one boat would have."""
    one = rows()[rows()["id"] == 1].reset_index(drop=True)
    return wide(lambda n, b: f"{n}{b}", ("x", "y", "angle")).loc[ORDERS[order](one).index]


def _of_order(order: str, names: tuple[str, ...]) -> dict[str, Honest]:
    tables = {
        "long": (lambda: ORDERS[order](rows()), PLAIN),
        "SLEAP": (
            lambda: sleap().loc[ORDERS[order](rows()).index],
            {**PLACE, "fps": HZ, "frame": "frame_idx", "id": "track", **SLEAP_COLUMNS},
        ),
        "s": (
            lambda: ORDERS[order](rows()).assign(frame=lambda t: t["frame"] / HZ),
            {**PLAIN, "fps": None},
        ),
        "wide": (
            lambda: _wide_rows(order),
            {**PLAIN, "x": "x{id}", "y": "y{id}", "heading": "angle{id}"},
        ),
    }
    return {f"{name}: {order}": Honest(*tables[name]) for name in names}


def _with_clock(clock: str) -> Honest:
    times, fields = CLOCKS[clock]

    def table() -> Rows:
        found = rows()
        if times is None:
            return found.assign(frame=found["frame"] / HZ + found["id"] * 0.004)
        return found.assign(frame=times(found["frame"] / HZ))

    return Honest(table, {**PLAIN, **fields})


def _with_lost(mark: str) -> Honest:
    value, fields = LOST[mark]

    def table() -> Rows:
        found = rows().astype({"x": object, "y": object})
        gone = (found["id"] == 3) & found["frame"].between(40, 60)
        if isinstance(value, str) and value == "drop":
            return found[~gone]
        return found.assign(x=found["x"].mask(gone, value), y=found["y"].mask(gone, value))

    return Honest(table, {**PLAIN, **fields})


def _beside_the_pool() -> Rows:
    """A sixth of all detections are reflections outside of the water, each somewhere else."""
    table = rows()
    other = table[::5].assign(x=lambda t: 1200 + t["frame"] * 1.7, y=lambda t: t["id"] * 31.0)
    return pd.concat([table, other.assign(id=99)], ignore_index=True)


def _slow(every_s: float) -> Honest:
    """One picture every so often, of animals that creep along."""
    frame = np.repeat(np.arange(60), 3)
    boat, angle = np.tile(np.arange(3), 60), 0.02 * frame + np.tile([0.0, 2.0, 4.0], 60)
    table = pd.DataFrame({"time_s": frame * every_s, "id": boat})
    table = table.assign(x=70 * np.cos(angle), y=70 * np.sin(angle), heading=angle + np.pi / 2)
    layout = {"pool": (100.0, 0.0), "frame": "time_s", "wrapped": False}
    return Honest(lambda: table, layout, boats=())


def _back_and_forth() -> Rows:
    """On a line: headings are exactly 0 and π, and boats move ahead."""
    frame = np.arange(200)
    phase = frame % 40
    x = np.where(phase < 20, phase, 40 - phase) * 2.0 - 20.0
    heading = np.where(phase < 20, 0.0, np.pi)
    parts = [
        pd.DataFrame({"frame": frame, "id": n, "x": x, "y": 15.0 * n, "heading": heading})
        for n in range(3)
    ]
    return pd.concat(parts)


OTHERS = {
    "a sixth beside the pool": Honest(_beside_the_pool, PLAIN),
    "a picture every 12 s": _slow(12.0),
    "a picture every 30 s": _slow(30.0),
    "a picture every 12.5 s": _slow(12.5),
    "headings 0 and π": Honest(_back_and_forth, {"pool": (100.0, 0.0), "fps": HZ}, boats=()),
    "names as numbers with a point": Honest(lambda: rows().astype({"id": float}), PLAIN),
    "names of two words": Honest(
        lambda: rows().assign(id=lambda t: "fish no. " + t["id"].astype(str)), PLAIN
    ),
    "a column of remarks": Honest(lambda: rows().assign(note='said "no", twice'), PLAIN),
    "columns of the model": Honest(lambda: rows().assign(vx=1.0, vy=2.0, cluster=3), PLAIN),
    "a few rows twice": Honest(lambda: pd.concat([rows(), rows()[::50]]), PLAIN),
}
CORPUS: dict[str, Honest] = {
    **{f"program: {name}": each for name, each in PROGRAMS.items()},
    **{f"dataset {name}": each for name, each in DATASETS.items()},
    **{
        f"order of {name}": each
        for order in ORDERS
        for name, each in _of_order(order, ("long", "SLEAP", "s", "wide")).items()
    },
    **{f"clock: {clock}": _with_clock(clock) for clock in CLOCKS},
    **{
        f"spelling: {name}": Honest(rows, {**PLAIN, **layout}, file, {**options, "bytes": change})
        for name, (file, options, layout, change) in SPELLINGS.items()
    },
    **{
        f"headings: {name}": Honest(
            lambda change=change: rows().assign(angle=lambda t: change(t["angle"], t)),
            {**PLACE, "fps": HZ, "heading": "angle", **fields},
        )
        for name, (change, fields) in DEGREES.items()
    },
    **{f"lost: {mark}": _with_lost(mark) for mark in LOST},
    **{f"other: {name}": each for name, each in OTHERS.items()},
}
