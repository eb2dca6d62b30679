"""Law: a number that a sentence takes from committed data is the number in the data.

A row below names the sentence and the cell. If one of them changes, somebody edits the other.
"""

import math
from typing import Any

import pandas as pd
import pytest

from docs.scripts.plots import REPOSITORY
from docs.scripts.quoted import (
    DENSITY,
    Number,
    ends_of,
    interval,
    mean,
    most_of_an_offset,
    offset,
    plans,
    ranks_of_levels,
)


def readings_with_rise(rows: Any) -> int:
    """In how many readings noise raises mean |m| by at least 0.3 from that at bw = 0."""
    reading = ["dt_s", "scheme", "noise_scheme", "overlap_tolerance_cm"]
    means = rows.groupby([*reading, "bw_s"])["abs_m"].mean().unstack()
    means = means[means.notna().sum(axis=1) > 4]
    return int((means.max(axis=1) - means[0.0] >= 0.3).sum())


SPEED = "docs/speed_vs_error/"
OURS = {"engine": "flockenv", "setting": "leapfrog / block-pivoting / 1e-4 cm", "dt_s": 0.01}
MOREAU = OURS | {"setting": "moreau / block-pivoting / 1e-4 cm"}
RAPIER = {"engine": "rapier2d-f64", "setting": "4 iterations / unit 10 cm", "dt_s": 0.01}
BOX2D = {"engine": "Box2D (f32)", "setting": "4 substeps / unit 10 cm", "dt_s": 0.01}
JAM = {"scene": "jam", "n": 27, **OURS}
CYCLE = JAM | {"scene": "cycle"}
LARGE = {"scene": "jam", "n": 1000}
LARGE_JAM = JAM | LARGE

SECTION5 = "studies/section5/results/section5.csv.gz"
WIDE = {"pool": "wide", "n_leaders": 0}
LOST = {"quantity": "critical bw (s), k = 0"}
COHERENCE = "mean Ψ_o with 3 clockwise leaders minus without, bw 1.4 to 2.0 s; read as at least 0.2"

LEADERS = "studies/leaders/results/"
CLOSE = {"case": "wide-bw-0.31", "policy": "learned", "leaders": 3}
SINGLE = CLOSE | {"leaders": 1}
TUNED = CLOSE | {"policy": "tuned law"}
PAPERS = CLOSE | {"policy": "paper's law"}
NARROW = {"case": "narrow-bw-0.45", "leaders": 3}
TRAININGS = "studies/trainings/results/pretrained/algorithms.csv"
EARLY = "studies/trainings/results/pretrained/algorithms-500.csv"


def throughput() -> list[Number]:
    page, table = "docs/speed_vs_error.md", "docs/throughput/environments.csv"
    rows = {pool: {"row": f"64 flocks, {pool}"} for pool in ("wide", "narrow")}

    def agent_steps(rows: Any) -> float:
        leaders = 4
        return leaders * rows["median"].iloc[0] / 1e6

    single = "step of a single environment over a flock's in a batch of 64, "
    wide, narrow = ({"row": f"{single}{pool}"} for pool in ("wide", "narrow"))
    return [
        Number(page, "environment takes {} times as long", table, wide, "median", ".1f"),
        Number(page, "in `wide` and {} times in `narrow`, by", table, narrow, "median", ".1f"),
        Number(page, "That is {} and # million agent steps", table, rows["wide"], agent_steps),
        Number(page, "That is # and {} million agent steps", table, rows["narrow"], agent_steps),
    ]


def box2d(rows: Any) -> float:
    """Time of Box2D's step over ours."""
    theirs, ours = (
        rows[(rows[list(row)] == pd.Series(row)).all(axis=1)]["us_per_step"].item()
        for row in (BOX2D, OURS)
    )
    return theirs / ours


def speed() -> list[Number]:
    """Times over those of other engines."""
    page, table, threads = "docs/speed_vs_error.md", f"{SPEED}speed.csv", f"{SPEED}threads.csv"
    found = [
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
        found += [
            Number(page, f"| rapier2d-f64 | 1 | {cell} |", table, row | OURS, "faster", form),
            Number(page, f"| Box2D | 1 | {cell} |", table, row, box2d, form),
        ]
    drake = {"engine, setting": "Drake SAP"}
    found += [
        Number(page, words, f"{SPEED}short_engines.csv", drake, column, "g")
        for words, column in (
            ("takes them: a step takes {} µs", "jam, µs"),
            ("in the jam and {} µs in the cycle", "cycle, µs"),
        )
    ]
    engines = {"rapier2d-f64, `parallel`": "rapier2d-f64", "Box2D": "Box2D (f32)"}
    for words, engine in engines.items():
        for cell, (scene, n, form) in zip(cells, scenes, strict=True):
            row = {"engine": engine, "scene": scene, "n": n}
            words_of = f"| {words} | 2 | {cell} |"
            found.append(Number(page, words_of, threads, row, "times_as_long", form))
    paper = "docs/software/paper.md"
    return [
        *found,
        Number(paper, "27 jammed boats take {} µs per step", table, JAM, "us_per_step", ".1f"),
        Number(paper, "and {} times as long in rapier", table, JAM, "faster", ".1f"),
    ]


def overlap_rates() -> list[Number]:
    """In how many runs overlaps are deep, by a tolerance and without one."""
    page, table = "docs/speed_vs_error.md", f"{SPEED}overlap_rates.csv"
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
        Number(page, f"{words} {place} |", table, row | {"tolerance_cm": cm}, column, form)
        for scene, words in scenes.items()
        for row in ({"scene": scene, "scheme": "leapfrog"},)
        for place, (cm, column, form) in zip(shown, cells, strict=True)
    ]


def test_no_overlap_exceeds_the_tolerance_and_all_is_solved():
    rates = pd.read_csv(REPOSITORY / SPEED / "overlap_rates.csv")
    kept = rates[rates["tolerance_cm"] == 1e-4]
    assert len(kept) == 6
    assert (kept["runs"] == 200).all()
    assert (kept[["beyond_0.0001_cm", "unsolved"]] == 0).all(axis=None)
    once = rates[rates["tolerance_cm"] == math.inf]
    assert (once["beyond_0.01_cm"] == once["runs"]).all()


def steps() -> list[Number]:
    """What a step of 0.1 s changes, by the study of the step."""
    page, table = "docs/speed_vs_error.md", "studies/step_size/claims.csv"
    at = "at dt = 0.1 s minus that at 0.005 s"
    alone = {"reading": "20 boats in wide, no leaders, physics training", "quantity": f"Ψ_o {at}"}

    def farthest(rows: Any) -> float:
        shifts = rows[rows["quantity"].str.startswith("noise of the same")]
        return shifts[["low", "high"]].abs().max(axis=None)

    return [
        *interval(page, "8 minutes show a change of {} at 0.1 s", table, alone, form=".3f"),
        Number(page, "order is lost by at most {} s", table, {}, farthest),
    ]


def energy() -> list[Number]:
    """Numbers of what contacts seem to add to flocks without motors and rudders."""
    page, table = "docs/model.md", "docs/throughput/soak_energy.csv"

    def percent(rows: Any) -> float:
        return 100 * rows["largest_gain"].iloc[0]

    without = {"scheme": "leapfrog", "c0_per_s": 0.0}
    words = {0.01: "{}, # and # %", 0.02: "#, {} and # %", 0.1: "#, # and {} %"}
    literal = {"scheme": "paper", "dt_s": 0.1}
    return [
        *(
            Number(
                page, f"gained at most {words[dt]} in one", table, without | {"dt_s": dt}, percent
            )
            for dt in words
        ),
        Number(page, "`paper` gained at most {} %", table, literal | {"c0_per_s": 0.0}, percent),
        Number(page, "in one, and {} % with drag", table, literal | {"c0_per_s": 1.0}, percent),
    ]


def test_drag_leaves_contacts_no_energy_to_add():
    gains = pd.read_csv(REPOSITORY / "docs/throughput/soak_energy.csv")
    with_drag = gains[(gains["scheme"] == "leapfrog") & (gains["c0_per_s"] > 0)]
    assert len(with_drag) == 6
    assert (with_drag["largest_gain"] == 0).all()


def easy_branches() -> list[Number]:
    """What paired branches reach in the easy flock from nothing."""
    page, file = "docs/train.md", "studies/levels/results/orders.csv.gz"
    words = "seeds 0 to 2 came to {}, {} and {} after 100 flock-hours"
    found = []
    for seed in range(3):
        shown = ["#"] * 3
        shown[seed] = "{}"
        row = {"budget": 100, "policy": f"branches-100/order-easy-{seed}.json"}
        found.append(Number(page, words.format(*shown), file, row, mean("signed_order")))
    return found


def levels() -> list[Number]:
    """Numbers of suite v3: what laws reach in each level."""
    page, file, laws = "docs/levels.md", "studies/levels/results/laws.csv", []
    before = {
        "order-easy": "0.3 s | 2 min |",
        "order-noisy": "`narrow` | 0.45 s | 2 min |",
        "order-narrow": "0.45 s | 4 min |",
        "order-wide": "0.31 s | 8 min |",
    }
    columns = {
        "straight ahead": "{} | # | #",
        "paper's law": "# | {} | #",
        "damped law": "# | # | {}",
    }
    for level, words in before.items():
        for policy, shown in columns.items():
            row = {"level": level, "policy": policy}
            laws.append(Number(page, f"{words} {shown} |", file, row, "signed_order"))
    best = {"level": "order-narrow", "budget": 30, "entry": "MAPPO"}
    learned = {"level": "order-wide", "policy": "learned"}
    return [
        *laws,
        *interval(page, "of MAPPO, gain {} of", ENTRIES, best, ends_of("score")),
        *interval(page, "learned leaders gain {} on it", file, learned, ends_of("gain"), ".3f"),
        *ranks_of_levels(
            page, "correlation of {}; in", "in `order-wide` it is {}, and", "`order-narrow` {}. In"
        ),
        *learned_soonest(),
    ]


ENTRIES = "studies/levels/results/entries.csv"


def learned_soonest() -> list[Number]:
    """What suite v3 says of the easy flock on the page of trainings."""
    page, row = "docs/train.md", {"level": "order-easy", "budget": 30}
    return [
        Number(page, words, ENTRIES, row | {"entry": entry}, column, form)
        for words, entry, column, form in (
            ("it gains {} of what the damped law gains, and PPO", "TRPO", "score", ".2f"),
            ("law gains, and PPO {}.", "PPO", "score", ".2f"),
            ("they gain {} in # s, where", "paired branches", "score", ".2f"),
            ("they gain # in {} s, where", "paired branches", "cpu_s", ".0f"),
            ("where TRPO takes {} s (", "TRPO", "cpu_s", ".0f"),
        )
    ]


def readme() -> list[Number]:
    """Numbers of the front page."""
    page = "README.md"
    return [
        Number(page, "takes {} µs on one core", f"{SPEED}speed.csv", JAM, "us_per_step", ".1f"),
        Number(page, "needs {} times as long,", f"{SPEED}speed.csv", JAM, "faster", ".1f"),
        Number(page, "{} times if the boats move", f"{SPEED}speed.csv", CYCLE, "faster", ".0f"),
        Number(page, "{} times in a jam of 1000", f"{SPEED}speed.csv", LARGE_JAM, "faster", ".1f"),
        Number(page, "needs {} times as long in that", f"{SPEED}speed.csv", LARGE, box2d, ".1f"),
        *(
            Number(page, words, f"{SPEED}slide.csv", row, "slide_median_cm", ".2g")
            for words, row in (
                ("ends {} cm from its exact position with the default scheme", OURS),
                ("{} cm with the first-order scheme `moreau`", MOREAU),
                ("and {} cm in rapier", RAPIER),
            )
        ),
        *(
            Number(page, words, f"{SPEED}impact.csv", {"scheme": scheme}, "dt = 0.01 s", ".2g")
            for words, scheme in (
                ("ends {} cm away with the default scheme", "leapfrog / linear"),
                ("and {} cm with `moreau` ([speed", "moreau / linear"),
            )
        ),
        *readme_of_studies(page),
    ]


def readme_of_studies(page: str) -> list[Number]:
    return [
        Number(
            page,
            "50 boats in `wide` by # or more in {} of",
            SECTION5,
            WIDE | {"n_boats": 50},
            readings_with_rise,
            "d",
        ),
        Number(
            page, "of 20 boats in {} of", SECTION5, WIDE | {"n_boats": 20}, readings_with_rise, "d"
        ),
        *(
            Number(
                page, words, "studies/section5/claims.csv", LOST | {"reading": f"{reading}, n = 20"}
            )
            for words, reading in (
                ("lose it at bw = {} s with white noise", "simulation"),
                ("it is {} to # s: the less", "paper, 0.1 cm"),
                ("it is # to {} s: the less", "paper, 0.001 cm"),
            )
        ),
        *(
            Number(page, words, "studies/section4/claims.csv", {"quantity": quantity})
            for words, quantity in (
                ("happens at {} s without leaders", f"{DENSITY}, no leaders"),
                ("without leaders and at {} s with three", f"{DENSITY}, 3 leaders, CW"),
                ("raise the order Ψ_o by {}, where", COHERENCE),
            )
        ),
    ]


DIFFERENCES, CLOSE_MEANS = f"{LEADERS}close_differences.csv", f"{LEADERS}close_means.csv"


def leaders(page: str) -> list[Number]:
    """What the front page and the page of leaders say of them."""
    words = "leads better than the tuned law, by {}" + (" (" if page == "README.md" else ", and")
    return [
        Number(page, "{} trainings gain", TRAININGS, column="seeds", form="d"),
        Number(page, "trainings gain {} on the tuned law", TRAININGS, column="gain"),
        Number(page, "on average ({} to #, 95 % interval)", TRAININGS, column="gain_low"),
        Number(page, "on average (# to {}, 95 % interval)", TRAININGS, column="gain_high"),
        Number(page, words, DIFFERENCES, CLOSE, "mean"),
        *(leaders_in_brief(page) if page == "README.md" else leaders_at_length(page)),
    ]


def leaders_in_brief(page: str) -> list[Number]:
    return [
        Number(page, "({} against #, # episodes)", CLOSE_MEANS, CLOSE, "signed_order"),
        Number(page, "(# against {}, # episodes)", CLOSE_MEANS, TUNED, "signed_order"),
        Number(page, "(# against #, {} episodes)", DIFFERENCES, CLOSE, "n", "d"),
    ]


def leaders_at_length(page: str) -> list[Number]:
    reached = "in other flocks, and reaches a signed order of {}"
    narrow = (
        ("tuned law: it reaches {}", "tuned law"),
        ("and the paper's law {}", "paper's law"),
    )
    return [
        Number(page, reached, CLOSE_MEANS, CLOSE, "signed_order"),
        Number(page, "and with a single leader by {}", DIFFERENCES, SINGLE, "mean"),
        Number(page, "eq. (10), reaches {}", f"{LEADERS}means.csv", PAPERS, "signed_order"),
        *(
            Number(page, words, f"{LEADERS}means.csv", NARROW | {"policy": policy}, "signed_order")
            for words, policy in narrow
        ),
    ]


def offsets() -> list[Number]:
    """What one step of planning without foresight adds."""
    step = "one such step adds {} to the mean order of the next 96 s"
    most = "planning without foresight adds at most {} of order"
    return [*offset("docs/leaders.md", step, 96), most_of_an_offset("docs/levels.md", most)]


def trainings() -> list[Number]:
    """What the trainings of `make pretrained` reached."""
    page, found = "docs/train.md", []
    columns = ("signed_order", "lowest", "highest")
    gains = ("gain", "gain_low", "gain_high")
    for means, words, end in ((TRAININGS, "seeds", " more than the"), (EARLY, "they", " more.")):
        reached = (
            f"{words} reach {{}} on",
            f"{words} reach # on average ({{}} to",
            f"{words} reach # on average (# to {{}})",
        )
        found += [
            Number(page, text, means, column=column, form=".3f")
            for text, column in zip(reached, columns, strict=True)
        ]
        found += interval(page, f"(# to #): {{}}{end}", means, columns=gains, form=".3f")
    return found


def lessons() -> list[Number]:
    """What the lessons of the live page say."""
    page, means = "web/lessons.mjs", f"{LEADERS}means.csv"
    law = PAPERS | {"leaders": 4}
    return [
        Number(
            page,
            "learned leaders reach {}, the law",
            means,
            CLOSE | {"leaders": 4},
            "signed_order",
        ),
        Number(page, "learned leaders reach #, the law {}.", means, law, "signed_order"),
        Number(page, "one leader reaches {}, four", means, PAPERS | {"leaders": 1}, "signed_order"),
        Number(page, "one leader reaches #, four {}.", means, law, "signed_order"),
    ]


NUMBERS = [
    *readme(),
    *speed(),
    *throughput(),
    *energy(),
    *overlap_rates(),
    *steps(),
    *levels(),
    *easy_branches(),
    *leaders("README.md"),
    *leaders("docs/leaders.md"),
    *plans("docs/leaders.md"),
    *offsets(),
    *trainings(),
    *lessons(),
]


@pytest.mark.parametrize("number", NUMBERS, ids=lambda number: f"{number.page}: {number.words}")
def test_pages_quote_the_data(number):
    found = number.shown(number.page_text())
    assert found == [number.expected()], f"{number.file} {number.row}"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("It is 0.5 cm, and no more.", ["0.5"]),
        ("It is\n−0.5 cm", ["−0.5"]),
        ("It is 0.5 mm.", []),
        ("It is 0.5 cm. It is 0.6 cm.", ["0.5", "0.6"]),
    ],
)
def test_a_number_is_found_by_its_words(text, found):
    assert Number("", "is {} cm", "").shown(text) == found
