"""Draw the figures and write the short tables of one run: ``python benches/report FOLDER [FILES]``.

FOLDER has the tables of the run. The short tables, which docs/speed_vs_error.md shows, are written
beside them. FILES is the folder with the versions of other engines, and is given only after a
measurement. Then ``made.toml`` stores the date, the machine and the versions, and the folder
``processors`` gets a table of times named after the processor.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from machine import processor, provenance, write_provenance
from measurements import BOX2D, BOX2D_TWO, RAPIER, STEP_S, Measurements, ours
from plots import draw_all

# Columns of the short tables, and what they are called there.
ENGINES = {
    "jam_us_per_step": "jam, µs",
    "jam_faster": "jam, speed",
    "cycle_us_per_step": "cycle, µs",
    "cycle_faster": "cycle, speed",
    "jam_overlap_mean_cm": "jam overlap, cm",
    "force_error": "force",
    "slide_median_cm": "slide, cm",
    "cycle_half_second_cm": "cycle 0.5 s, cm",
}
SIZES = {
    "leapfrog": ours("leapfrog", "linear"),
    "leapfrog, 1e-4 cm": ours("leapfrog", "1e-4 cm"),
    "leapfrog, 1e-6 cm": ours("leapfrog", "1e-6 cm"),
    "rapier2d-f64": RAPIER,
    "Box2D": BOX2D,
    "Box2D, two threads": BOX2D_TWO,
}


def main() -> None:
    """Read the tables, draw the figures and write the short tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("files", type=Path, nargs="?")
    arguments = parser.parse_args()
    m = Measurements.read(arguments.folder)
    if arguments.files is not None:
        made = provenance(Path(__file__).parents[1], arguments.files)
        write_provenance(arguments.folder, made)
        write_processor(m, arguments.folder)
    draw_all(m, arguments.folder)
    for name, make in {
        "engines": engines,
        "steps": steps,
        "sizes": sizes,
        "exponents": exponents,
        "order_errors": order_errors,
    }.items():
        path = arguments.folder / f"short_{name}.csv"
        make(m).to_csv(path, index=False, float_format=two_digits, lineterminator="\n")


def write_processor(m: Measurements, folder: Path) -> None:
    """Write the times of this processor, beside those of other processors."""
    columns = ["scene", "n", "engine", "setting", "dt_s", "us_per_step", "us_q1", "us_q3", "faster"]
    rows = m.speed[m.speed.n.isin([27, 1000])].dropna(subset=["us_per_step"])
    path = folder / "processors" / f"{processor()}.csv"
    path.parent.mkdir(exist_ok=True)
    rows[columns].to_csv(path, index=False, float_format="%.3g", lineterminator="\n")


def two_digits(value: float) -> str:
    """Format with two significant digits, without an exponent for everyday sizes."""
    return f"{float(f'{value:.2g}'):g}"


def engines(m: Measurements) -> pd.DataFrame:
    """Return a row for each engine and setting, with 27 boats at `STEP_S`, flockenv first."""
    rows = m.settings()
    rows = rows[rows.dt_s == STEP_S].copy()
    rows["is_other"] = rows.engine.ne("flockenv")
    return _short(rows.sort_values(["is_other", "engine"], kind="stable"), {}, ENGINES)


def steps(m: Measurements) -> pd.DataFrame:
    """Return leapfrog's speed and errors against the step."""
    rows = m.settings()
    rows = rows[(rows.scheme == "leapfrog") & (rows.solver == "block-pivoting")]
    first_columns = {"dt_s": "dt, s"}
    further_columns = {
        "jam_overlap_max_cm": "deepest in the jam, cm",
        "cycle_overlap_max_cm": "deepest in the cycle, cm",
        "cycle_deep_share": "cycles beyond 0.01 cm",
        "jam_times_real_time": "jam, × real time",
        "cycle_times_real_time": "cycle, × real time",
    }
    return _short(rows, first_columns, {**ENGINES, **further_columns})


def _short(rows: pd.DataFrame, first: dict[str, str], columns: dict[str, str]) -> pd.DataFrame:
    names = rows.engine.where(rows.engine.ne("flockenv"), "") + " " + rows.setting
    short = rows.rename(columns=first | columns)[[*first.values(), *columns.values()]]
    settings = names.str.strip().str.replace("block-pivoting", "exact")
    short.insert(0, "engine, setting", settings)
    return short


def sizes(m: Measurements) -> pd.DataFrame:
    """Return the time of a step of jams in µs by the number of boats."""
    jam = m.speed[(m.speed.scene == "jam") & (m.speed.dt_s == STEP_S)]
    table = {
        name: jam[(jam.engine == engine) & (jam.setting == setting)].set_index("n").us_per_step
        for name, (engine, setting) in SIZES.items()
    }
    return pd.DataFrame(table).rename_axis("boats").reset_index()


def exponents(m: Measurements) -> pd.DataFrame:
    """Return the exponents of errors as powers of the step, fitted over the smallest steps."""
    settings = m.settings()
    table = []
    for scheme in ("leapfrog", "moreau", "paper"):
        slide = _by_step(m.slide, scheme).head(4)
        flock = _by_step(settings, scheme).head(3)
        table.append(
            {
                "scheme": scheme,
                "sliding for 2 s": _exponent(slide, "slide_median_cm"),
                "0.5 s of the jam": _exponent(flock, "jam_half_second_cm"),
                "0.5 s of the cycle": _exponent(flock, "cycle_half_second_cm"),
            }
        )
    return pd.DataFrame(table)


def _by_step(rows: pd.DataFrame, scheme: str) -> pd.DataFrame:
    engine, setting = ours(scheme, "1e-9 cm")
    return rows[(rows.engine == engine) & (rows.setting == setting)].sort_values("dt_s")


def _exponent(rows: pd.DataFrame, column: str) -> float:
    return float(np.polyfit(np.log(rows.dt_s), np.log(rows[column]), 1)[0])


def order_errors(m: Measurements) -> pd.DataFrame:
    """Return the errors of the mean Ψ_o and C_v against leapfrog at 0.005 s."""
    rows = m.order[m.order.psi_o_half_width > 0]
    named = rows.engine.where(rows.engine.ne("flockenv"), "") + " " + rows.setting
    other = rows.first_seed.map(lambda seed: "" if seed == 1 else " (other seeds)")
    return pd.DataFrame(
        {
            "engine, setting": named.str.strip().str.replace("block-pivoting", "exact") + other,
            "dt, s": rows.dt_s,
            "runs": rows.seeds,
            "error of Ψ_o": rows.psi_o_error,
            "± (Ψ_o)": rows.psi_o_half_width,
            "error of C_v, cm²/s²": rows.c_v_error_cm2_s2,
            "± (C_v)": rows.c_v_half_width_cm2_s2,
        }
    )


if __name__ == "__main__":
    main()
