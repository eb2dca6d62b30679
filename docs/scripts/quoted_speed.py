"""Numbers of docs/speed_vs_error.md, and rows of its tables that other pages quote, too."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from docs.scripts.quoted import Number, interval

PAGE = "docs/speed_vs_error.md"
SPEED = "docs/speed_vs_error/"
OURS = {"engine": "flockenv", "setting": "leapfrog / block-pivoting / 1e-4 cm", "dt_s": 0.01}
MOREAU = OURS | {"setting": "moreau / block-pivoting / 1e-4 cm"}
RAPIER = {"engine": "rapier2d-f64", "setting": "4 iterations / unit 10 cm", "dt_s": 0.01}
BOX2D = {"engine": "Box2D (f32)", "setting": "4 substeps / unit 10 cm", "dt_s": 0.01}
JAM = {"scene": "jam", "n": 27, **OURS}
CYCLE = JAM | {"scene": "cycle"}
LARGE = {"scene": "jam", "n": 1000}
LARGE_JAM = JAM | LARGE


def throughput() -> list[Number]:
    """List the speeds of environments in a batch and alone."""
    page, table = PAGE, "docs/throughput/environments.csv"
    rows = {pool: {"row": f"64 flocks, {pool}"} for pool in ("wide", "narrow")}

    def agent_steps(rows: Any) -> float:
        leaders = 4
        return leaders * rows["median"].iloc[0] / 1e6

    single = "step of a single environment over a flock's in a batch of 64, "
    wide, narrow = ({"row": f"{single}{pool}"} for pool in ("wide", "narrow"))
    return [
        Number(page, "environment takes {} times as long", table, wide, "median", ".1f"),
        Number(page, "in `wide` and {} times in `narrow`, by", table, narrow, "median", ".1f"),
        *(
            Number(page, words, table, rows[pool], "median", ",.0f")
            for words, pool in (
                ("makes {} control steps of a flock", "wide"),
                ("through Gymnasium, and {} in `narrow`", "narrow"),
            )
        ),
        Number(page, "That is {} and # million agent steps", table, rows["wide"], agent_steps),
        Number(page, "That is # and {} million agent steps", table, rows["narrow"], agent_steps),
    ]


def box2d(rows: Any) -> float:
    """Return the time of Box2D's step over ours."""
    theirs, ours = (
        rows[(rows[list(row)] == pd.Series(row)).all(axis=1)]["us_per_step"].item()
        for row in (BOX2D, OURS)
    )
    return theirs / ours


def two_digits(value: float) -> float:
    """Round to two significant digits."""
    return float(f"{value:.2g}")


def deeper(engine: dict[str, Any], digits: Callable[[float], float] = two_digits) -> Any:
    """Return a function for the ratio of another engine's mean overlap to ours."""

    def times(rows: Any) -> float:
        theirs, ours = (
            rows[(rows[list(row)] == pd.Series(row)).all(axis=1)]["overlap_mean_cm"].mean()
            for row in (engine, OURS)
        )
        return digits(theirs / ours)

    return times


def speed() -> list[Number]:
    """List our times and memory, and how other engines compare."""
    page, table, threads = PAGE, f"{SPEED}speed.csv", f"{SPEED}threads.csv"
    numbers = [
        Number(page, "takes {} µs of one core", table, JAM, "us_per_step", ".1f"),
        Number(page, "and {} µs if they move", table, CYCLE, "us_per_step", ".1f"),
        Number(page, "rapier needs {} and # times", table, JAM, "faster", ".1f"),
        Number(page, "rapier needs # and {} times", table, CYCLE, "faster", ".0f"),
        Number(
            page,
            "10 000 boats runs {} times",
            f"{SPEED}growth.csv",
            {"n": 10_000},
            "times_real_time",
            ".1f",
        ),
        Number(
            page,
            "on one thread, in {} MB",
            f"{SPEED}growth.csv",
            {"n": 10_000},
            lambda rows: rows["bytes"].item() / 1e6,
            ".0f",
        ),
    ]
    scenes = (("jam", 27, ".1f"), ("cycle", 27, ".0f"), ("jam", 1000, ".1f"))
    cells = ("{} | # | #", "# | {} | #", "# | # | {}")
    for cell, (scene, n, form) in zip(cells, scenes, strict=True):
        row = {"scene": scene, "n": n}
        numbers += [
            Number(page, f"| rapier2d-f64 | 1 | {cell} |", table, row | OURS, "faster", form),
            Number(page, f"| Box2D | 1 | {cell} |", table, row, box2d, form),
        ]
    drake = {"engine, setting": "Drake SAP"}
    numbers += [
        Number(page, words, f"{SPEED}short_engines.csv", drake, column, "g")
        for words, column in (
            ("SAP accepts: a step takes {} µs", "jam, µs"),
            ("in the jam and {} µs in the cycle", "cycle, µs"),
        )
    ]
    engines = {"rapier2d-f64, `parallel`": "rapier2d-f64", "Box2D": "Box2D (f32)"}
    for words, engine in engines.items():
        for cell, (scene, n, form) in zip(cells, scenes, strict=True):
            row = {"engine": engine, "scene": scene, "n": n}
            row_words = f"| {words} | 2 | {cell} |"
            numbers.append(Number(page, row_words, threads, row, "times_as_long", form))
    paper = "docs/software/paper.md"
    return [
        *numbers,
        Number(paper, "27 jammed boats take {} µs per step", table, JAM, "us_per_step", ".1f"),
        Number(paper, "and {} times as long in rapier", table, JAM, "faster", ".1f"),
        *(
            Number(paper, words, f"{SPEED}slide.csv", row, "slide_median_cm", form)
            for words, row, form in (
                ("the default scheme is {} cm and", OURS, ".5f"),
                ("that of rapier {} cm, since", RAPIER, ".2g"),
                ("of `flockenv` comes to {} cm.", MOREAU, ".2g"),
            )
        ),
    ]


def overlap_rates() -> list[Number]:
    """List in how many runs overlaps are deep, with a tolerance and without one."""
    page, table = PAGE, f"{SPEED}overlap_rates.csv"
    scenes = {
        "cycle": "| cycle with bw = # s, a minute |",
        "wide": "| `wide`, bw = # s, # s |",
        "narrow": "| `narrow`, bw = # s, # s |",
    }
    shown = (
        "{} | # cm | # | # cm",
        "# | {} cm | # | # cm",
        "# | # cm | {} | # cm",
        "# | # cm | # | {} cm",
    )
    cells = ((1e-4, "beyond_0.0001_cm", "d"), (1e-4, "deepest_cm", "g"))
    cells += ((math.inf, "beyond_0.1_cm", "d"), (math.inf, "deepest_cm", "g"))
    return [
        Number(page, f"{words} {cell} |", table, row | {"tolerance_cm": cm}, column, form)
        for scene, words in scenes.items()
        for row in ({"scene": scene, "scheme": "leapfrog"},)
        for cell, (cm, column, form) in zip(shown, cells, strict=True)
    ]


def steps() -> list[Number]:
    """List what a step of 0.1 s changes, from the study of step sizes."""
    page, table = PAGE, "studies/step_size/claims.csv"
    at = "at dt = 0.1 s minus that at 0.005 s"
    alone = {"reading": "20 boats in wide, no leaders, physics training", "quantity": f"Ψ_o {at}"}

    def largest_shift(rows: Any) -> float:
        shifts = rows[rows["quantity"].str.startswith("noise of the same")]
        return shifts[["low", "high"]].abs().max(axis=None)

    return [
        *interval(page, "8 minutes show a change of {} at 0.1 s", table, alone, form=".3f"),
        Number(page, "order is lost by at most {} s", table, {}, largest_shift),
    ]


def other_engines() -> list[Number]:
    """List overlaps of other engines relative to ours, and the spread of rapier's times."""
    table, jam = f"{SPEED}overlap.csv.gz", {"scene": "jam", "n": 27}
    own_unit = RAPIER | {"setting": "4 iterations / unit 1 cm"}

    def spread(rows: Any) -> float:
        return (100 * (rows["us_q3"] - rows["us_q1"]) / rows["us_per_step"]).item()

    def over_linear(rows: Any) -> float:
        theirs, ours = (
            rows[(rows[list(row)] == pd.Series(row)).all(axis=1)]["us_per_step"].item()
            for row in (BOX2D, OURS | {"setting": "leapfrog / block-pivoting / linear"})
        )
        return theirs / ours

    return [
        Number(PAGE, "its hulls overlap {} times as much.", table, jam, deeper(RAPIER), ".0f"),
        Number(
            PAGE,
            "its hulls overlap {} times as much as ours. **",
            table,
            jam,
            deeper(own_unit),
            ".0f",
        ),
        Number(
            PAGE, "its hulls overlap {} times as much as ours. A", table, jam, deeper(BOX2D), ".0f"
        ),
        Number(
            PAGE,
            "of # % in the jam and {} % in the cycle",
            f"{SPEED}speed.csv",
            CYCLE | RAPIER,
            spread,
            ".0f",
        ),
        Number(
            PAGE,
            "interquartile range of {} % in the jam and",
            f"{SPEED}speed.csv",
            JAM | RAPIER,
            spread,
            ".0f",
        ),
        Number(
            PAGE, "takes {} times as long as the default", f"{SPEED}speed.csv", LARGE, box2d, ".1f"
        ),
        Number(
            PAGE, "and {} times as long as gaps", f"{SPEED}speed.csv", LARGE, over_linear, ".1f"
        ),
        *(
            Number(
                PAGE,
                f"where this one has {words} (",
                f"{SPEED}speed.csv",
                row | OURS,
                "faster",
                form,
            )
            for words, row, form in (
                ("{}, # and #", JAM, ".1f"),
                ("#, {} and #", CYCLE, ".0f"),
                ("#, # and {}", LARGE, ".1f"),
            )
        ),
    ]


def our_settings() -> list[Number]:
    """List what our steps and tolerances cost, and how errors fall with the step."""
    training = {"engine, setting": "leapfrog / exact / 1e-4 cm", "dt, s": 0.1}
    steps, falls = f"{SPEED}short_steps.csv", f"{SPEED}short_exponents.csv"
    changes = f"{SPEED}short_order_errors.csv"

    def contact_exponents(rows: Any) -> Any:
        both = rows[rows["scheme"].isin(["leapfrog", "moreau"])]
        return both[["0.5 s of the jam", "0.5 s of the cycle"]]

    def impact_ratios(rows: Any) -> Any:
        by_scheme = rows.set_index("scheme")
        return by_scheme.loc["leapfrog / linear"] / by_scheme.loc["moreau / linear"]

    def per_boat(rows: Any) -> float:
        us_per_step = rows.set_index("n")["us_per_step"]
        return us_per_step[1000] / 1000 / (us_per_step[27] / 27)

    rise, width = "error of Ψ_o", "± (Ψ_o)"
    return [
        Number(PAGE, "27 boats {} (jam) to # times", steps, training, "jam, × real time", ".0f"),
        Number(PAGE, "27 boats # (jam) to {} times", steps, training, "cycle, × real time", ",.0f"),
        Number(
            PAGE,
            "the exponents are {} to #.",
            falls,
            {},
            lambda rows: contact_exponents(rows).min(axis=None),
            ".1f",
        ),
        Number(
            PAGE,
            "the exponents are # to {}.",
            falls,
            {},
            lambda rows: contact_exponents(rows).max(axis=None),
            ".1f",
        ),
        Number(
            PAGE,
            "`leapfrog` errs {} to # times",
            f"{SPEED}impact.csv",
            {},
            lambda rows: impact_ratios(rows).min(),
            ".1f",
        ),
        Number(
            PAGE,
            "`leapfrog` errs # to {} times",
            f"{SPEED}impact.csv",
            {},
            lambda rows: impact_ratios(rows).max(),
            ".0f",
        ),
        Number(
            PAGE,
            "and time by a factor of {}, because",
            f"{SPEED}speed.csv",
            {"scene": "jam", **OURS},
            per_boat,
            ".1f",
        ),
        *(
            Number(PAGE, f"Ψ_o changes by {words}", changes, training | {"dt, s": dt_s}, column)
            for dt_s, column, words in (
                (0.05, rise, "{} ± # at dt"),
                (0.05, width, "# ± {} at dt"),
                (0.1, rise, "# ± # at dt = 0.05 s, and by {} ± # at"),
                (0.1, width, "# ± # at dt = 0.05 s, and by # ± {} at"),
            )
        ),
        *(
            Number(
                PAGE,
                f"`paper` raises Ψ_o by {words}.",
                changes,
                {"engine, setting": "paper / exact / linear"},
                end(rise),
            )
            for words, end in (("{} to #", least), ("# to {}", most))
        ),
        Number(PAGE, "at 0.005 s in {} seeds", changes, training, "runs", "d"),
        Number(
            PAGE,
            "(pymunk and MuJoCo {};",
            changes,
            {"engine, setting": "MuJoCo Newton"},
            "runs",
            "d",
        ),
    ]


def least(column: str) -> Callable[[Any], float]:
    """Return a function for the least number of a column."""
    return lambda rows: rows[column].min()


def most(column: str) -> Callable[[Any], float]:
    """Return a function for the largest number of a column."""
    return lambda rows: rows[column].max()


def controlled_steps() -> list[Number]:
    """List what a step that follows its error saves and costs."""
    table = f"{SPEED}step_control.csv"

    def substep_ratios(rows: Any) -> Any:
        """Return the ratio of the substeps of controlled steps to those of fixed ones, by setting.

        Both have the same error, interpolated between fixed steps. A setting with a smaller error
        than every fixed step is left out.
        """
        fixed = rows[rows["step"] == "fixed"].sort_values("error_cm")
        controlled = rows[rows["step"] == "controlled"]
        is_covered = controlled["error_cm"].between(
            fixed["error_cm"].min(), fixed["error_cm"].max()
        )
        controlled = controlled[is_covered]
        error, substeps = np.log(fixed[["error_cm", "substeps"]].to_numpy().T)
        fixed_substeps = np.exp(np.interp(np.log(controlled["error_cm"]), error, substeps))
        return controlled["substeps"] / fixed_substeps

    def in_a_flock(rows: Any) -> Any:
        return pd.concat(
            [
                substep_ratios(scene_rows)
                for scene, scene_rows in rows.groupby("scene")
                if scene != "impact"
            ]
        )

    impact = {"scene": "impact"}
    return [
        Number(
            PAGE,
            "slides it takes {} to # times",
            table,
            {},
            lambda rows: in_a_flock(rows).min(),
            ".1f",
        ),
        Number(
            PAGE,
            "slides it takes # to {} times",
            table,
            {},
            lambda rows: in_a_flock(rows).max(),
            ".0f",
        ),
        Number(
            PAGE,
            "0.001 cm or less: {} times the substeps",
            table,
            impact,
            lambda rows: substep_ratios(rows).min(),
            ".1f",
        ),
        Number(
            PAGE,
            "the substeps at an error of {} cm",
            table,
            impact | {"setting": "1e-05 cm"},
            "error_cm",
            "g",
        ),
    ]


def controlled_times() -> list[Number]:
    """List how much longer a step that follows its error takes for an error."""
    table = f"{SPEED}work.csv"

    def longer(column: str) -> Callable[[Any], Any]:
        """Return a function for the ratio of controlled to fixed times at the same error."""

        def ratios(rows: Any) -> Any:
            by_scene = []
            for _, scene_rows in rows[rows["engine"] == "flockenv"].groupby("scene"):
                is_controlled = scene_rows["setting"].str.startswith("controlled")
                controlled = scene_rows[is_controlled]
                fixed = scene_rows[~is_controlled].sort_values("error_median_cm")
                error, time = np.log(fixed[["error_median_cm", "us_per_s"]].to_numpy().T)
                controlled_error = np.log(controlled["error_median_cm"])
                assert controlled_error.between(error.min(), error.max()).all()
                fixed_time = np.exp(np.interp(controlled_error, error, time))
                by_scene.append(controlled[column] / fixed_time)
            return pd.concat(by_scene)

        return ratios

    calls, whole = longer("call_us_per_s"), longer("us_per_s")
    words, tried = "a controlled step takes {} times as long", "as we tried it, it takes {} times"
    return [
        Number(PAGE, words.format("{} to #"), table, {}, lambda rows: calls(rows).min(), ".1f"),
        Number(PAGE, words.format("# to {}"), table, {}, lambda rows: calls(rows).max(), ".1f"),
        Number(PAGE, tried.format("{} to #"), table, {}, lambda rows: whole(rows).min(), ".1f"),
        Number(PAGE, tried.format("# to {}"), table, {}, lambda rows: whole(rows).max(), ".0f"),
    ]


def learners() -> list[Number]:
    """List the speeds of other environments and of the learners' interfaces."""
    many, own = "docs/throughput/many_agents.csv", "docs/throughput/learners.csv"

    def best(rows: Any) -> Any:
        return rows.groupby("environment")["steps per second of one core"].max()

    def times(theirs: str, *, faster: bool) -> Callable[[Any], float]:
        def ratio_to_ours(rows: Any) -> float:
            ratio = best(rows)[theirs] / best(rows)["flockenv, hulls with exact contacts"]
            return ratio if faster else 1 / ratio

        return ratio_to_ours

    boids, dropout = "PufferLib boids in C, no collisions", "VMAS dropout, no collisions"
    return [
        Number(
            PAGE,
            "task with collisions takes {} times",
            many,
            {},
            times("VMAS flocking, discs that push", faster=False),
            ".0f",
        ),
        Number(
            PAGE,
            "collisions are {} and # times as fast",
            many,
            {},
            times(boids, faster=True),
            ".0f",
        ),
        Number(
            PAGE,
            "collisions are # and {} times as fast",
            many,
            {},
            times(dropout, faster=True),
            ".0f",
        ),
        Number(
            PAGE,
            "the batch alone makes {} per second",
            own,
            {"interface": "the batch itself"},
            lambda rows: two_digits(rows["samples/s"].item()),
            ",.0f",
        ),
    ]


def every() -> list[Number]:
    """List the numbers of all functions above."""
    return [
        *speed(),
        *other_engines(),
        *our_settings(),
        *controlled_steps(),
        *controlled_times(),
        *overlap_rates(),
        *steps(),
        *throughput(),
        *learners(),
    ]
