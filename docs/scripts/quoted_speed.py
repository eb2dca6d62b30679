"""Numbers of docs/speed_vs_error.md, and rows of its tables that other pages quote, too."""

import math

from docs.scripts.quoted import Number, interval
from docs.scripts.speed_quantities import (
    BOX2D,
    OURS,
    Values,
    box2d,
    box2d_over_linear,
    contact_exponents,
    impact_ratios,
    largest_shift,
    least,
    megabytes,
    million_agent_steps,
    most,
    overlap_over_ours,
    samples,
    speed_over_ours,
    substep_ratios,
    substep_ratios_in_flocks,
    time_over_ours,
    time_per_boat,
    time_ratios,
    time_spread,
)

PAGE = "docs/speed_vs_error.md"
SPEED = "docs/speed_vs_error/"
TIMES = f"{SPEED}speed.csv"
MOREAU = OURS | {"setting": "moreau / block-pivoting / 1e-4 cm"}
RAPIER = {"engine": "rapier2d-f64", "setting": "4 iterations / unit 10 cm", "dt_s": 0.01}
JAM = {"scene": "jam", "n": 27, **OURS}
CYCLE = JAM | {"scene": "cycle"}
LARGE = {"scene": "jam", "n": 1000}
LARGE_JAM = JAM | LARGE
TRAINING = {"engine, setting": "leapfrog / exact / 1e-4 cm", "dt, s": 0.1}


def extremes(words: str, file: str, values: Values, forms: tuple[str, str]) -> list[Number]:
    """List the least and the largest of some values; ``{}`` in the words stands for both."""
    least_form, most_form = forms
    return [
        Number(PAGE, words.replace("{}", shown), file, {}, column, form)
        for shown, column, form in (
            ("{} to #", least(values), least_form),
            ("# to {}", most(values), most_form),
        )
    ]


def batch_speeds() -> list[Number]:
    """List the speeds of environments in a batch and alone."""
    flocks = "64 flocks, "
    alone = "step of a single environment over a flock's in a batch of 64, "
    steps = million_agent_steps
    return [
        Number(PAGE, words, "docs/throughput/environments.csv", {"row": row}, column, form)
        for words, row, column, form in (
            ("environment takes {} times as long", f"{alone}wide", "median", ".1f"),
            ("in `wide` and {} times in `narrow`, by", f"{alone}narrow", "median", ".1f"),
            ("makes {} control steps of a flock", f"{flocks}wide", "median", ",.0f"),
            ("through Gymnasium, and {} in `narrow`", f"{flocks}narrow", "median", ",.0f"),
            ("That is {} and # million agent steps", f"{flocks}wide", steps, ".2f"),
            ("That is # and {} million agent steps", f"{flocks}narrow", steps, ".2f"),
        )
    ]


def samples_of_learners() -> list[Number]:
    """List how many samples the batch makes for a learner."""
    file, row = "docs/throughput/learners.csv", {"interface": "the batch itself"}
    return [Number(PAGE, "the batch alone makes {} per second", file, row, samples, ",.0f")]


def speeds_of_other_environments() -> list[Number]:
    """List how fast other environments are relative to ours."""
    flocking = "VMAS flocking, discs that push"
    boids, dropout = "PufferLib boids in C, no collisions", "VMAS dropout, no collisions"
    return [
        Number(PAGE, words, "docs/throughput/many_agents.csv", {}, ratio, ".0f")
        for words, ratio in (
            ("task with collisions takes {} times", time_over_ours(flocking)),
            ("collisions are {} and # times as fast", speed_over_ours(boids)),
            ("collisions are # and {} times as fast", speed_over_ours(dropout)),
        )
    ]


def our_times() -> list[Number]:
    """List the times of our steps, and how they grow with the number of boats."""
    steps, growth = f"{SPEED}short_steps.csv", f"{SPEED}growth.csv"
    jams = {"scene": "jam", **OURS}
    return [
        Number(PAGE, words, file, row, column, form)
        for words, file, row, column, form in (
            ("takes {} µs of one core", TIMES, JAM, "us_per_step", ".1f"),
            ("and {} µs if they move", TIMES, CYCLE, "us_per_step", ".1f"),
            ("and time by a factor of {}, because", TIMES, jams, time_per_boat, ".1f"),
            ("10 000 boats runs {} times", growth, {"n": 10_000}, "times_real_time", ".1f"),
            ("27 boats {} (jam) to # times", steps, TRAINING, "jam, × real time", ".0f"),
            ("27 boats # (jam) to {} times", steps, TRAINING, "cycle, × real time", ",.0f"),
        )
    ]


def memory() -> list[Number]:
    """List the memory of a large flock."""
    file, row = f"{SPEED}growth.csv", {"n": 10_000}
    return [Number(PAGE, "on one thread, in {} MB", file, row, megabytes, ".0f")]


def times_of_other_engines() -> list[Number]:
    """List how long steps of other engines take relative to ours."""
    return [
        Number(PAGE, words, TIMES, row, column, form)
        for words, row, column, form in (
            ("rapier needs {} and # times", JAM, "faster", ".1f"),
            ("rapier needs # and {} times", CYCLE, "faster", ".0f"),
            ("where this one has {}, # and # (", JAM, "faster", ".1f"),
            ("where this one has #, {} and # (", CYCLE, "faster", ".0f"),
            ("where this one has #, # and {} (", LARGE_JAM, "faster", ".1f"),
            ("takes {} times as long as the default", LARGE, box2d, ".1f"),
            ("and {} times as long as gaps", LARGE, box2d_over_linear, ".1f"),
        )
    ]


def table_of_other_engines() -> list[Number]:
    """List the page's table of times of other engines relative to ours."""
    scenes = (
        ("{} | # | #", {"scene": "jam", "n": 27}, ".1f"),
        ("# | {} | #", {"scene": "cycle", "n": 27}, ".0f"),
        ("# | # | {}", {"scene": "jam", "n": 1000}, ".1f"),
    )
    threads = f"{SPEED}threads.csv"
    rapier, box = {"engine": "rapier2d-f64"}, {"engine": "Box2D (f32)"}
    return [
        Number(PAGE, f"| {engine} | {cell} |", file, scene | row, column, form)
        for engine, file, row, column in (
            ("rapier2d-f64 | 1", TIMES, OURS, "faster"),
            ("Box2D | 1", TIMES, {}, box2d),
            ("rapier2d-f64, `parallel` | 2", threads, rapier, "times_as_long"),
            ("Box2D | 2", threads, box, "times_as_long"),
        )
        for cell, scene, form in scenes
    ]


def times_of_drake() -> list[Number]:
    """List the times of a step of Drake."""
    file, row = f"{SPEED}short_engines.csv", {"engine, setting": "Drake SAP"}
    return [
        Number(PAGE, words, file, row, column, "g")
        for words, column in (
            ("SAP accepts: a step takes {} µs", "jam, µs"),
            ("in the jam and {} µs in the cycle", "cycle, µs"),
        )
    ]


def spread_of_times() -> list[Number]:
    """List the interquartile ranges of rapier's times."""
    return [
        Number(PAGE, words, TIMES, scene | RAPIER, time_spread, ".0f")
        for words, scene in (
            ("interquartile range of {} % in the jam and", JAM),
            ("of # % in the jam and {} % in the cycle", CYCLE),
        )
    ]


def overlaps_of_other_engines() -> list[Number]:
    """List the overlaps of hulls in other engines relative to ours."""
    file, row = f"{SPEED}overlap.csv.gz", {"scene": "jam", "n": 27}
    own_unit = RAPIER | {"setting": "4 iterations / unit 1 cm"}
    return [
        Number(PAGE, words, file, row, overlap_over_ours(engine), ".0f")
        for words, engine in (
            ("its hulls overlap {} times as much.", RAPIER),
            ("its hulls overlap {} times as much as ours. **", own_unit),
            ("its hulls overlap {} times as much as ours. A", BOX2D),
        )
    ]


def overlap_rates() -> list[Number]:
    """List in how many runs overlaps are deep, with a tolerance and without one."""
    scenes = {
        "cycle": "| cycle with bw = # s, a minute |",
        "wide": "| `wide`, bw = # s, # s |",
        "narrow": "| `narrow`, bw = # s, # s |",
    }
    cells = (
        ("{} | # cm | # | # cm", 1e-4, "beyond_0.0001_cm", "d"),
        ("# | {} cm | # | # cm", 1e-4, "deepest_cm", "g"),
        ("# | # cm | {} | # cm", math.inf, "beyond_0.1_cm", "d"),
        ("# | # cm | # | {} cm", math.inf, "deepest_cm", "g"),
    )
    return [
        Number(
            PAGE,
            f"{words} {cell} |",
            f"{SPEED}overlap_rates.csv",
            {"scene": scene, "scheme": "leapfrog", "tolerance_cm": tolerance_cm},
            column,
            form,
        )
        for scene, words in scenes.items()
        for cell, tolerance_cm, column, form in cells
    ]


def errors_by_step() -> list[Number]:
    """List how errors fall with the step."""
    exponents, impact = f"{SPEED}short_exponents.csv", f"{SPEED}impact.csv"
    return [
        *extremes("the exponents are {}.", exponents, contact_exponents, (".1f", ".1f")),
        *extremes("`leapfrog` errs {} times", impact, impact_ratios, (".1f", ".0f")),
    ]


def order_by_step() -> list[Number]:
    """List by how much the step and the scheme change the order."""
    file = f"{SPEED}short_order_errors.csv"
    change, width = "error of Ψ_o", "± (Ψ_o)"
    halved, paper = TRAINING | {"dt, s": 0.05}, {"engine, setting": "paper / exact / linear"}
    before = "Ψ_o changes by # ± # at dt = 0.05 s, and by"
    return [
        Number(PAGE, words, file, row, column, form)
        for words, row, column, form in (
            ("Ψ_o changes by {} ± # at dt", halved, change, ".2f"),
            ("Ψ_o changes by # ± {} at dt", halved, width, ".2f"),
            (f"{before} {{}} ± # at", TRAINING, change, ".2f"),
            (f"{before} # ± {{}} at", TRAINING, width, ".2f"),
            ("`paper` raises Ψ_o by {} to #.", paper, least(change), ".2f"),
            ("`paper` raises Ψ_o by # to {}.", paper, most(change), ".2f"),
            ("at 0.005 s in {} seeds", TRAINING, "runs", "d"),
            ("(pymunk and MuJoCo {};", {"engine, setting": "MuJoCo Newton"}, "runs", "d"),
        )
    ]


def study_of_steps() -> list[Number]:
    """List what a step of 0.1 s changes, from the study of step sizes."""
    file, at = "studies/step_size/claims.csv", "at dt = 0.1 s minus that at 0.005 s"
    training = {
        "reading": "20 boats in wide, no leaders, physics training",
        "quantity": f"Ψ_o {at}",
    }
    return [
        *interval(PAGE, "8 minutes show a change of {} at 0.1 s", file, training, form=".3f"),
        Number(PAGE, "order is lost by at most {} s", file, {}, largest_shift),
    ]


def substeps_of_controlled_steps() -> list[Number]:
    """List how many substeps a step that follows its error saves and costs."""
    file, impact = f"{SPEED}step_control.csv", {"scene": "impact"}
    smallest = impact | {"setting": "1e-05 cm"}
    in_impact = (
        ("0.001 cm or less: {} times the substeps", impact, least(substep_ratios), ".1f"),
        ("the substeps at an error of {} cm", smallest, "error_cm", "g"),
    )
    return [
        *extremes("slides it takes {} times", file, substep_ratios_in_flocks, (".1f", ".0f")),
        *(Number(PAGE, words, file, row, column, form) for words, row, column, form in in_impact),
    ]


def times_of_controlled_steps() -> list[Number]:
    """List how much longer a step that follows its error takes for an error."""
    file = f"{SPEED}work.csv"
    calls, whole = time_ratios("call_us_per_s"), time_ratios("us_per_s")
    return [
        *extremes("a controlled step takes {} times as long", file, calls, (".1f", ".1f")),
        *extremes("as we tried it, it takes {} times", file, whole, (".1f", ".0f")),
    ]


def software_paper() -> list[Number]:
    """List the times and errors that the paper on the software quotes."""
    slide = f"{SPEED}slide.csv"
    return [
        Number("docs/software/paper.md", words, file, row, column, form)
        for words, file, row, column, form in (
            ("27 jammed boats take {} µs per step", TIMES, JAM, "us_per_step", ".1f"),
            ("and {} times as long in rapier", TIMES, JAM, "faster", ".1f"),
            ("the default scheme is {} cm and", slide, OURS, "slide_median_cm", ".5f"),
            ("that of rapier {} cm, since", slide, RAPIER, "slide_median_cm", ".2g"),
            ("of `flockenv` comes to {} cm.", slide, MOREAU, "slide_median_cm", ".2g"),
        )
    ]


def every() -> list[Number]:
    """List the numbers of all functions above."""
    return [
        *batch_speeds(),
        *samples_of_learners(),
        *speeds_of_other_environments(),
        *our_times(),
        *memory(),
        *times_of_other_engines(),
        *table_of_other_engines(),
        *times_of_drake(),
        *spread_of_times(),
        *overlaps_of_other_engines(),
        *overlap_rates(),
        *errors_by_step(),
        *order_by_step(),
        *study_of_steps(),
        *substeps_of_controlled_steps(),
        *times_of_controlled_steps(),
        *software_paper(),
    ]
