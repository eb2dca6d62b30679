"""The CSV files of one run, joined where they share engine, setting and step."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

KEY = ["engine", "setting", "scheme", "solver", "tolerance_cm", "dt_s"]
# The step in s at which engines are compared.
STEP_S = 0.01
# Deeper overlaps count as deep.
DEEP_CM = 0.01
RAPIER = ("rapier2d-f64", "4 iterations / unit 10 cm")
TIGHT_RAPIER = ("rapier2d-f64", "4 iterations / unit 1 cm")
BOX2D = ("Box2D (f32)", "4 substeps / unit 10 cm")
BOX2D_TWO = ("Box2D (f32)", "4 substeps / unit 10 cm / 2 threads")
OURS = ("flockenv", "leapfrog / block-pivoting / linear")


@dataclass(frozen=True)
class Measurements:
    """All tables of a run."""

    speed: pd.DataFrame
    overlap: pd.DataFrame
    slide: pd.DataFrame
    wall_push: pd.DataFrame
    momentum: pd.DataFrame
    horizon: pd.DataFrame
    order: pd.DataFrame
    solvers: pd.DataFrame
    profile: pd.DataFrame
    parts: pd.DataFrame
    growth: pd.DataFrame

    @classmethod
    def read(cls, folder: Path) -> Measurements:
        """Read every table, and append the tables of other programs."""
        tables = {}
        for name in cls.__dataclass_fields__:
            # A long table is compressed after the report is made.
            packed = folder / f"{name}.csv.gz"
            frames = [pd.read_csv(packed if packed.exists() else folder / f"{name}.csv")]
            peers = folder / f"{name}_peers.csv"
            if peers.exists():
                frames.append(pd.read_csv(peers))
            filled = [frame.dropna(axis="columns", how="all") for frame in frames]
            tables[name] = pd.concat(filled, ignore_index=True)
        return cls(**tables)

    def overlaps(self) -> pd.DataFrame:
        """Return each setting's overlaps over its seeds, and its fraction of deep runs."""
        key = [*KEY, "scene", "n"]
        runs = self.overlap.assign(deep_share=self.overlap.overlap_max_cm > DEEP_CM)
        columns = {"overlap_mean_cm": "mean", "overlap_max_cm": "max", "deep_share": "mean"}
        return runs.groupby(key, dropna=False, as_index=False).agg(columns)

    def settings(self) -> pd.DataFrame:
        """Return a row for each engine, setting and step: results of 27 boats and of exact laws."""
        joined = None
        for scene in ("jam", "cycle"):
            for table, columns in [
                (self.speed, ["us_per_step", "us_q1", "us_q3", "faster", "times_real_time"]),
                (self.overlaps(), ["overlap_mean_cm", "overlap_max_cm", "deep_share"]),
            ]:
                rows = table[(table.scene == scene) & (table.n == 27)]
                joined = _join(joined, rows, columns, f"{scene}_")
            for horizon_s, name in [(0.5, "half_second_cm"), (1.0, "second_cm")]:
                of_scene = self.horizon[self.horizon.scene == scene]
                rows = of_scene[of_scene.horizon_s == horizon_s]
                rows = rows.rename(columns={"horizon_median_cm": name})
                joined = _join(joined, rows, [name], f"{scene}_")
        joined = _join(joined, self.slide, ["slide_median_cm", "slide_worst_cm"], "")
        joined = _join(joined, self.wall_push, ["force_error"], "")
        columns = ["momentum_drift", "angular_momentum_drift"]
        return _join(joined, self.momentum, columns, "")


def _join(
    joined: pd.DataFrame | None, table: pd.DataFrame, columns: list[str], prefix: str
) -> pd.DataFrame:
    key = KEY if joined is None else ["engine", "setting", "dt_s"]
    prefixed = table[key + columns].rename(columns={name: prefix + name for name in columns})
    return prefixed if joined is None else joined.merge(prefixed, on=key, how="left")


def pick(table: pd.DataFrame, engine: tuple[str, str], **fields: object) -> pd.Series:
    """Return the one row of an engine and setting, by default at the reference step."""
    wanted = {"engine": engine[0], "setting": engine[1], "dt_s": STEP_S, **fields}
    rows = table
    for name, value in wanted.items():
        rows = rows[rows[name] == value]
    if len(rows) != 1:
        raise LookupError(f"{len(rows)} rows for {wanted}")
    return rows.iloc[0]


def in_words(engine: str, setting: str) -> str:
    """Return an engine and its setting as the plots name them."""
    if engine != "flockenv":
        return f"{engine}, {setting.replace(' / unit ', ', unit ')}"
    scheme, _, gaps = setting.split(" / ")
    name = "paper's scheme" if scheme == "paper" else scheme
    return f"{name}, gaps {'solved once' if gaps == 'linear' else f'to {gaps}'}"


def ours(scheme: str, gaps: str) -> tuple[str, str]:
    """Return flockenv and the name of its setting with the exact solver."""
    return "flockenv", f"{scheme} / block-pivoting / {gaps}"
