"""Law: a number that a sentence takes from committed data is the number in the data.

A row below names the sentence and the cell. If one of them changes, somebody edits the other.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from flockenv.statistics import mean_interval, student_interval

pd = pytest.importorskip("pandas")

REPOSITORY = Path(__file__).parents[2]
DIGITS = r"[+\-−]?\d[\d ]*(?:\.\d+)?(?:e-?\d+)?"


@dataclass(frozen=True)
class Number:
    """A number of a page.

    Attributes
    ----------
    page
        File of the page.
    words
        What stands around it: ``{}`` is the number, ``#`` another one.
    file
        Table that it is from.
    row
        Values by which its row is found.
    column
        Column of the number, or a function of the rows that gives it.
    form
        How it is written.
    """

    page: str
    words: str
    file: str
    row: dict[str, Any] = field(default_factory=dict)
    column: str | Callable[[Any], float] = "measured"
    form: str = ".2f"

    def shown(self, text: str) -> list[str]:
        """Every number of a page that stands between the words."""
        pattern = re.escape(self.words).replace(r"\{\}", f"({DIGITS})").replace(r"\#", DIGITS)
        return re.findall(pattern, " ".join(text.split()))

    def expected(self) -> str:
        """The number of the data, as it is written."""
        table = pd.read_csv(REPOSITORY / self.file)
        for name, value in self.row.items():
            table = table[table[name] == value]
        assert len(table), f"{self.file} has no row with {self.row}"
        if callable(self.column):
            value = self.column(table)
        else:
            (value,) = table[self.column]
        return format(value, self.form).replace("-", "−")


def mean(column: str) -> Callable[[Any], float]:
    return lambda rows: rows[column].mean()


def count(verdict: str) -> Callable[[Any], float]:
    return lambda rows: (rows["verdict"] == verdict).sum()


def readings_with_rise(rows: Any) -> int:
    """In how many readings noise raises mean |m| by at least 0.3 from that at bw = 0."""
    reading = ["dt_s", "scheme", "noise_scheme", "overlap_tolerance_cm"]
    means = rows.groupby([*reading, "bw_s"])["abs_m"].mean().unstack()
    means = means[means.notna().sum(axis=1) > 4]
    return int((means.max(axis=1) - means[0.0] >= 0.3).sum())


def gain_of_plan(rows: Any, place: int = 0) -> float:
    gain, low, high = student_interval(rows["planned"] - rows["learned"])
    return (gain, (high - low) / 2)[place]


SPEED = "docs/speed_vs_error/"
OURS = {"engine": "flockenv", "setting": "leapfrog / block-pivoting / 1e-4 cm", "dt_s": 0.01}
MOREAU = OURS | {"setting": "moreau / block-pivoting / 1e-4 cm"}
RAPIER = {"engine": "rapier2d-f64", "setting": "4 iterations / unit 10 cm", "dt_s": 0.01}
JAM = {"scene": "jam", "n": 27, **OURS}

SECTION5 = "studies/section5/results/section5.csv.gz"
WIDE = {"pool": "wide", "n_leaders": 0}
LOST = {"quantity": "critical bw (s), k = 0"}
DENSITY = (
    "bw (s) at which the density of φ_o within 10° of the tangent falls through 3 times uniform"
)
COHERENCE = "mean Ψ_o with 3 clockwise leaders minus without, bw 1.4 to 2.0 s; read as at least 0.2"


LEADERS = "studies/leaders/results/"
CLOSE = {"case": "wide-bw-0.31", "policy": "learned", "leaders": 3}
SINGLE = CLOSE | {"leaders": 1}
TUNED = CLOSE | {"policy": "tuned law"}
PAPERS = CLOSE | {"policy": "paper's law"}
NARROW = {"case": "narrow-bw-0.45", "leaders": 3}
TRAININGS = "studies/trainings/results/pretrained/algorithms.csv"
EARLY = "studies/trainings/results/pretrained/algorithms-500.csv"
FIVE = "studies/trainings/results/algorithms/algorithms.csv"
TRAININGS_PAGE = "studies/trainings/README.md"
PLANNING = "studies/planning/results/plan_"


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


def speed() -> list[Number]:
    """Times over those of other engines."""
    page, table, threads = "docs/speed_vs_error.md", f"{SPEED}speed.csv", f"{SPEED}threads.csv"
    cycle = JAM | {"scene": "cycle"}
    found = [
        Number(page, "takes {} µs of one core", table, JAM, "us_per_step", ".1f"),
        Number(page, "and {} µs if they move", table, cycle, "us_per_step", ".1f"),
        Number(page, "rapier needs {} and # times", table, JAM, "faster", ".1f"),
        Number(page, "rapier needs # and {} times", table, cycle, "faster", ".0f"),
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
    engines = {"rapier2d-f64, `parallel`": "rapier2d-f64", "Box2D": "Box2D (f32)"}
    scenes = (("jam", 27, ".1f"), ("cycle", 27, ".0f"), ("jam", 1000, ".1f"))
    for words, engine in engines.items():
        for place, (scene, n, form) in enumerate(scenes):
            shown = " | ".join("{}" if k == place else "#" for k in range(3))
            row = {"engine": engine, "scene": scene, "n": n}
            cells = f"| {words} | 2 | {shown} |"
            found.append(Number(page, cells, threads, row, "times_as_long", form))
    return found


def energy() -> list[Number]:
    """Numbers of what contacts seem to add to flocks without motors and rudders."""
    page, table = "docs/model.md", "docs/throughput/soak_energy.csv"

    def percent(rows: Any) -> float:
        return 100 * rows["largest_gain"].iloc[0]

    without = {"scheme": "leapfrog", "c0_per_s": 0.0}
    words = {0.01: "{}, # and # %", 0.02: "#, {} and # %", 0.1: "#, # and {} %"}
    return [
        Number(page, f"gained at most {words[dt]} in one", table, without | {"dt_s": dt}, percent)
        for dt in words
    ]


def test_drag_leaves_contacts_no_energy_to_add():
    gains = pd.read_csv(REPOSITORY / "docs/throughput/soak_energy.csv")
    with_drag = gains[(gains["scheme"] == "leapfrog") & (gains["c0_per_s"] > 0)]
    assert len(with_drag) == 6
    assert (with_drag["largest_gain"] == 0).all()


def entries() -> list[Number]:
    """Numbers of what learns from nothing."""
    page, folder = "studies/levels/README.md", "studies/levels/results/"
    pairs, table = f"{folder}pairs.csv", f"{folder}entries.csv"
    few = {"level": "order-easy", "budget": 30}
    longer = {"budget": 100, "entry": "paired branches"}
    easy, best = {"level": "order-easy"}, {"level": "order-easy", "entry": "TRPO"}
    unlike, ranks = f"{folder}unlike.csv", f"{folder}unlike_ranks.csv"
    alternates = easy | {"what": "target"}
    law = f"{folder}unlike_conditions.csv"

    def told_apart(rows: Any) -> float:
        return ((rows["difference_low"] > 0) | (rows["difference_high"] < 0)).sum()

    def small(rows: Any) -> float:
        return (rows["p_of_all_pairs"] < 0.05).sum()

    return [
        Number(page, "flock-hours, {} of # pairs of", pairs, few, told_apart, "d"),
        Number(page, "flock-hours, # of {} pairs of", pairs, few, len, "d"),
        Number(page, "Of {} pairs # differ", pairs, few, len, "d"),
        Number(page, "Of # pairs {} differ", pairs, few, told_apart, "d"),
        Number(page, "design. {} of them have", pairs, few, small, "d"),
        Number("studies/README.md", "score; {} of # pairs", pairs, few, told_apart, "d"),
        Number("studies/README.md", "score; # of {} pairs", pairs, few, len, "d"),
        Number(page, "has {} (# to #), the highest", table, few, lambda rows: rows["score"].max()),
        Number(page, "branches have {} (# to #): one", table, longer, "score"),
        Number(page, "branches have # ({} to #): one", table, longer, "score_low"),
        Number(page, "branches have # (# to {}): one", table, longer, "score_high"),
        *(
            Number(page, words, table, {"level": level, "budget": 30, "entry": entry}, column)
            for words, level, entry, column in (
                ("branches in `order-wide`, {} (# to", "order-wide", "paired branches", "score"),
                ("score in `order-noisy`, {} (# to", "order-noisy", "TRPO", "score"),
                ("TRPO has {} (# to #) in `order-wide`", "order-wide", "TRPO", "score"),
                ("law gains: MAPPO has {} (", "order-narrow", "MAPPO", "score"),
                ("to #), and TRPO {} (# to", "order-narrow", "TRPO", "score"),
            )
        ),
        Number(page, "algorithms is {} (# to #)", ranks, easy, "rank_correlation"),
        Number(page, "algorithms is # ({} to #)", ranks, easy, "low"),
        Number(page, "algorithms is # (# to {})", ranks, easy, "high"),
        Number(page, "mean over {} conditions, each", unlike, best, "conditions", "d"),
        Number(page, "falls from {} to # (# to #)", table, best, "score"),
        Number(page, "falls from # to {} (# to #)", unlike, best, "unlike"),
        Number(page, "falls from # to # ({} to #)", unlike, best, "unlike_low"),
        Number(page, "falls from # to # (# to {})", unlike, best, "unlike_high"),
        Number(
            page, "steering, by {} (# to #)", law, alternates, lambda rows: -rows["gain"].item()
        ),
        *(
            Number(page, words, pairs, {"level": level}, told_apart, "d")
            for words, level in (
                ("{} of # pairs differ in `order-noisy`", "order-noisy"),
                ("trainings each), {} in `order-narrow`", "order-narrow"),
                ("`order-narrow` and {} in `order-wide`", "order-wide"),
            )
        ),
    ]


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


def gradients() -> list[Number]:
    """The squared gradient of the order at two policies."""
    page, file = "studies/policy_gradient/README.md", "studies/policy_gradient/results/gradient.csv"
    lean, both = "lean features", "lean and flock features"
    lines = {
        ("wide", "tuned law", lean): ("| tuned law | 29 lean features |", ".1f"),
        ("wide", "learned", lean): ("learned | 29 lean features |", ".0f"),
        ("wide", "learned", both): ("learned | with the whole flock's |", ".0f"),
        ("narrow", "tuned law", lean): ("in `narrow` | 29 lean features |", ".0f"),
    }
    found = []
    for (pool, policy, features), (words, form) in lines.items():
        by_lean = {"pool": pool, "policy": policy, "features": features, "metric": "lean"}
        for column, shown in (("squared_gradient", "{} ± #"), ("spread", "# ± {}")):
            for row, before, digits in (
                (by_lean, words, ".1f"),
                (by_lean | {"metric": "weights"}, f"{words} # ± # | # |", form),
            ):
                value = in_millionths(column)
                found.append(Number(page, f"{before} {shown} |", file, row, value, digits))
    return found


def in_millionths(column: str) -> Callable[[Any], float]:
    return lambda rows: 1e6 * rows[column].item()


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
    return laws


def readme() -> list[Number]:
    """Numbers of the front page."""
    page = "README.md"
    return [
        Number(page, "takes {} µs on one core", f"{SPEED}speed.csv", JAM, "us_per_step", ".1f"),
        Number(page, "needs {} times as long", f"{SPEED}speed.csv", JAM, "faster", ".1f"),
        *(
            Number(page, words, f"{SPEED}slide.csv", row, "slide_median_cm", ".2g")
            for words, row in (
                ("ends {} cm from its exact place with the default scheme", OURS),
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


def plans(page: str) -> list[Number]:
    """What planning ahead adds."""
    known, fresh = f"{PLANNING}known.csv", f"{PLANNING}fresh.csv"
    return [
        Number(
            page, "reaches a signed order of {}, and the learned", known, column=mean("planned")
        ),
        Number(page, "and the learned leaders {}", known, column=mean("learned")),
        Number(page, "does not know it reaches {}", fresh, column=mean("planned")),
        Number(page, "a difference of {} ±", fresh, column=gain_of_plan),
        Number(page, "a difference of # ± {}", fresh, column=lambda rows: gain_of_plan(rows, 1)),
    ]


def offsets() -> list[Number]:
    """What one step of planning without foresight adds."""
    study, table = "studies/planning/README.md", "studies/planning/results/best_of_offsets.csv"
    sentences = (
        (study, "best of 16 leans, adds {}", 96),
        (study, "The chosen offset adds {} to the mean order between 8 and 64 s", 64),
        (study, "after the branch, and {} between 8 and 96 s", 96),
        ("docs/leaders.md", "one such step adds {} to the mean order of the next 96 s", 96),
    )
    found = []
    for page, words, horizon in sentences:
        for place, form in enumerate(("{} (# to #)", "# ({} to #)", "# (# to {})")):
            text = words.replace("{}", form)
            found.append(Number(page, text, table, {"horizon_s": horizon}, gain_of(place), ".3f"))
    # The larger upper end is that by 64 s.
    for page, words in (
        (study, "One step is worth at most {} by the upper ends"),
        ("docs/levels.md", "planning without foresight adds at most {} of order"),
        ("studies/README.md", "one step without it at most {}."),
    ):
        found.append(Number(page, words, table, {"horizon_s": 64}, gain_of(2), ".3f"))
    return found


def gain_of(place: int) -> Callable[[Any], float]:
    """The mean gain of the states, or an end of its interval."""
    return lambda rows: mean_interval(rows["gain"])[place]


def trainings() -> list[Number]:
    """What the trainings of `make pretrained` reached."""
    found = []
    for means, words, end in ((TRAININGS, "seeds", " more than the"), (EARLY, "they", " more.")):
        places = {
            f"{words} reach {{}} in": "signed_order",
            f"{words} reach # in the mean ({{}} to": "lowest",
            f"{words} reach # in the mean (# to {{}})": "highest",
            f"(# to #): {{}} (# to #){end}": "gain",
            f": # ({{}} to #){end}": "gain_low",
            f": # (# to {{}}){end}": "gain_high",
        }
        found += [
            Number("docs/train.md", text, means, column=column, form=".3f")
            for text, column in places.items()
        ]
    five = {"train_leaders": "PPO's five seeds gain", "evolution": "the evolution strategy's"}
    for algorithm, words in five.items():
        for column, form in (
            ("gain", "{} (# to #)"),
            ("gain_low", "# ({} to #)"),
            ("gain_high", "# (# to {})"),
        ):
            text, row = f"{words} {form}", {"algorithm": algorithm}
            found.append(Number(TRAININGS_PAGE, text, FIVE, row, column, ".3f"))
    return found


def headlines() -> list[Number]:
    """In how many variants the headlines hold."""
    found, claims = [], "studies/headlines/claims.csv"
    for page in ("studies/README.md", "studies/headlines/README.md"):
        found += [
            Number(page, "Mostly: {} of #", claims, column=count("holds"), form="d"),
            Number(page, "Mostly: # of {} answers", claims, column=len, form="d"),
            Number(page, "answers hold, {} are open", claims, column=count("open"), form="d"),
            Number(page, "are open, and {} fails", claims, column=count("fails"), form="d"),
        ]
    return found


def studies() -> list[Number]:
    """Numbers of the studies' first paragraphs."""
    return [*section_4(), *current(), *transition(), *density(), *decided()]


LOST_BELOW = "bw (s) at which mean Ψ_o falls through 0.3, "


def section_4() -> list[Number]:
    page = "studies/section4/README.md"
    return [
        Number(page, words, "studies/section4/claims.csv", {"quantity": quantity})
        for words, quantity in (
            ("uniform density at {} s (# to #) without leaders", f"{DENSITY}, no leaders"),
            ("and at {} s (# to #) with three. Through", f"{DENSITY}, 3 leaders, CW"),
            ("bound of disorder, at {} s", f"{LOST_BELOW}no leaders"),
            (
                "disorder, at # s (# to #), and with three leaders {} s",
                f"{LOST_BELOW}with 3 clockwise leaders minus without",
            ),
        )
    ]


def decided() -> list[Number]:
    """What pages quote of the runs that were added."""
    page, file = "studies/section4/README.md", "studies/decided/claims.csv"
    medium = {"claim": "Leaders increase the order at medium noise"}
    rise = {"claim": "Velocities change more abruptly than orientations"}
    turns = {"claim": "The direction of a moving flock can change at bw = 1.9 s"}
    slope = {"figure": "fig12"}
    return [
        Number(page, "at 1.4 s by {} (# to #; [# more", file, slope, form=".3f"),
        Number(page, "at 1.4 s by # ({} to #; [# more", file, slope, "low", ".3f"),
        Number(page, "at 1.4 s by # (# to {}; [# more", file, slope, "high", ".3f"),
        Number(page, "at low, {} (# to #) at medium", file, medium, form="+.2f"),
        Number(page, "at low, # ({} to #) at medium", file, medium, "low"),
        Number(page, "at low, # (# to {}) at medium", file, medium, "high"),
        Number(
            page,
            "rise shorter by {} s (#",
            file,
            rise,
            lambda rows: -rows["measured"].item(),
            ".1f",
        ),
        Number(page, "0 of {} [more runs]", file, turns, "n_runs", "d"),
        Number(
            "studies/section5/README.md",
            "of {} [more runs](../decided/README.md) in the rarer",
            file,
            {"figure": "fig17"},
            "n_runs",
            "d",
        ),
    ]


def current() -> list[Number]:
    page, preset = "studies/current/README.md", {"reading": "preset constants, narrow, n = 27"}
    return [
        Number(page, words, "studies/current/claims.csv", preset | {"quantity": quantity})
        for words, quantity in (
            ("it is lost at {} s (# to #) with the strong", f"{LOST_BELOW}gain 0.32, k = 0"),
            ("strong current, instead of {} s", f"{LOST_BELOW}gain 0.04, k = 0"),
        )
    ]


def transition() -> list[Number]:
    page, area = "studies/transition/README.md", "area of the loop in c4 in |m|, 80 min per noise"
    cell = "leapfrog, white, dt = 0.1 s, coverage 0.35, bw = 0, n = "
    rings, claims = "studies/transition/condensation.csv", "studies/transition/claims.csv"
    dense = {"c4": 0.1, "coverage": 0.6, "start": "one-jam"}
    ring = "leapfrog, white c4 = 0.1, dt = 0.1 s, bw = 0, ring of 83 cm, n = "
    outside = "coverage outside of jams, {} boats, coverage 0.6"
    return [
        *(
            Number(page, words, rings, dense | {"n_boats": n}, "outside", form=".2f")
            for words, n in (
                ("the coverage outside is {}, # and #", 100),
                ("the coverage outside is #, {} and #", 200),
                ("the coverage outside is #, # and {}", 400),
            )
        ),
        *(
            Number(
                page,
                words,
                claims,
                {"quantity": outside.format(sizes), "reading": ring + n},
                form=".2f",
            )
            for words, sizes, n in (
                ("200 have {} (# to #) more than 100", "200 minus 100", "100"),
                ("400 have {} (# to #) more than 200", "400 minus 200", "200"),
            )
        ),
        *(
            Number(page, words, claims, {"quantity": area, "reading": cell + n}, form=".3f")
            for words, n in (
                ("its area in |m| is {} (", "100"),
                ("with 100 boats, {} (", "200"),
                ("with 200 and {} (", "400"),
            )
        ),
    ]


def density() -> list[Number]:
    page, quiet = "studies/density/README.md", "studies/density/results/quiet.csv"
    flock = {"preset": "simulation", "pool": "wide", "n_boats": 20}
    return [
        Number(page, words, quiet, flock | {"c4": c4}, mean("abs_m"))
        for words, c4 in (
            ("|m| is {}, #, #, # and #,", 0.0),
            ("|m| is #, #, #, # and {},", 0.1),
        )
    ]


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
    *levels(),
    *gradients(),
    *entries(),
    *easy_branches(),
    *leaders("README.md"),
    *leaders("docs/leaders.md"),
    *plans("docs/leaders.md"),
    *plans("studies/planning/README.md"),
    *offsets(),
    *trainings(),
    *headlines(),
    *studies(),
    *lessons(),
]


@pytest.mark.parametrize("number", NUMBERS, ids=lambda number: f"{number.page}: {number.words}")
def test_pages_quote_the_data(number):
    found = number.shown((REPOSITORY / number.page).read_text(encoding="utf-8"))
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
