"""Law: a number that a sentence takes from committed data is the number in the data.

A row below names the sentence and the cell. If one of them changes, somebody edits the other.
"""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

import flockenv
from docs.scripts import quoted_speed
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
from docs.scripts.quoted_speed import (
    CYCLE,
    JAM,
    LARGE,
    LARGE_JAM,
    MOREAU,
    RAPIER,
    SPEED,
)
from docs.scripts.speed_quantities import OURS, box2d
from flockenv.statistics import critical_noise


def readings_with_rise(rows: Any) -> int:
    """In how many readings noise raises mean |m| by at least 0.3 from that at bw = 0."""
    reading = ["dt_s", "scheme", "noise_scheme", "overlap_tolerance_cm"]
    means = rows.groupby([*reading, "bw_s"])["abs_m"].mean().unstack()
    means = means[means.notna().sum(axis=1) > 4]
    return int((means.max(axis=1) - means[0.0] >= 0.3).sum())


SECTION5 = "studies/section5/results/section5.csv.gz"
WIDE = {"pool": "wide", "n_leaders": 0}
LOST = {"quantity": "critical bw (s), k = 0"}
PER_STEP = {"dt_s": 0.02, "scheme": "paper", "noise_scheme": "per-step"}
LOST_IN = {
    "simulation": {"dt_s": 0.02, "scheme": "leapfrog", "noise_scheme": "white"},
    "paper, 0.1 cm": PER_STEP | {"overlap_tolerance_cm": 0.1},
    "paper, 0.001 cm": PER_STEP | {"overlap_tolerance_cm": 0.001},
}
"""The readings whose loss of order the front page names."""
COHERENCE = "mean Ψ_o with 3 clockwise leaders minus without, bw 1.4 to 2.0 s; read as at least 0.2"

LEADERS = "studies/leaders/results/"
CLOSE = {"case": "wide-bw-0.31", "policy": "learned", "leaders": 3}
SINGLE = CLOSE | {"leaders": 1}
TUNED = CLOSE | {"policy": "tuned law"}
PAPERS = CLOSE | {"policy": "paper's law"}
NARROW = {"case": "narrow-bw-0.45", "leaders": 3}
TRAININGS = "studies/trainings/results/pretrained/algorithms.csv"
EARLY = "studies/trainings/results/pretrained/algorithms-500.csv"


def test_no_overlap_exceeds_the_tolerance_and_all_is_solved():
    rates = pd.read_csv(REPOSITORY / SPEED / "overlap_rates.csv")
    kept = rates[rates["tolerance_cm"] == 1e-4]
    assert len(kept) == 6
    assert (kept["runs"] == 200).all()
    assert (kept[["beyond_0.0001_cm", "unsolved"]] == 0).all(axis=None)
    once = rates[rates["tolerance_cm"] == math.inf]
    assert (once["beyond_0.01_cm"] == once["runs"]).all()


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


def critical() -> list[Number]:
    """The noise at which flocks of 27 boats lose their order."""
    page, folder = "docs/model.md", "studies/critical_noise/results/"
    scan, fitted = f"{folder}critical_noise.csv", f"{folder}critical_noise_experiment.csv"
    wide = {"pool": "wide"}

    def lost(place: int) -> Any:
        def at(rows: Any) -> float:
            levels = rows.groupby("bw_s")
            groups = [own[["psi_o", "rotation"]].to_numpy() for _, own in levels]
            return critical_noise(list(levels.groups), groups)[place]

        return at

    def noises(rows: Any) -> int:
        return rows["bw_s"].nunique()

    return [
        Number(page, "their order at bw = {} s with it", scan, wide | {"preset": "paper"}, lost(0)),
        Number(
            page, "and at {} s with `simulation` (", scan, wide | {"preset": "simulation"}, lost(0)
        ),
        Number(page, "at each of {} noises, [numbers", scan, wide, noises, "d"),
        Number(page, "it is {} s (95 % interval", fitted, {}, lost(0)),
        Number(page, "(95 % interval {} to #; 8 runs", fitted, {}, lost(1)),
        Number(page, "(95 % interval # to {}; 8 runs", fitted, {}, lost(2)),
        Number(page, "at each of {} noises; [study", fitted, {}, noises, "d"),
    ]


def instructions() -> list[Number]:
    """Instructions of a control step, which say why a GPU would gain little."""
    page, table = "docs/questions.md", "benches/instructions.csv"

    def thousands(rows: Any) -> float:
        return round(rows["instructions per step"].item(), -3)

    return [
        Number(
            page,
            f"of 27 boats takes {words} instructions",
            table,
            {"scene": f"training control step in {pool}"},
            thousands,
            ",.0f",
        )
        for words, pool in (("{} to #", "wide"), ("# to {}", "narrow"))
    ]


def room(pool: str, boat_radius_cm: float = 5.0) -> int:
    """Hulls that the water of a pool has room for by their length and width."""
    outer, inner = flockenv.FlockParameters.preset("simulation").replace(pool=pool).pool_radii_cm
    return int(math.pi * (outer**2 - inner**2) / (2 * boat_radius_cm * 3 * boat_radius_cm))


def test_pools_have_the_room_that_the_model_names():
    page = (REPOSITORY / "docs/model.md").read_text("utf-8")
    assert f"`wide` has room for {room('wide')} boats, `narrow` for {room('narrow')}." in page
    assert f"It also has room for {room('narrow', 2.5)} boats" in page


def test_a_free_boat_moves_backward_from_the_bw_that_the_model_names():
    """Eq. (8) on paper: ahead at full speed for 2 s from rest, adrift for 1 s, then backing."""
    p = flockenv.FlockParameters.preset("simulation")
    speed = (1 - math.exp(-p.c0 * p.fw_s)) * math.exp(-p.c0 * p.nop1_s)
    stops_s = math.log(1 + speed) / p.c0
    page = (REPOSITORY / "docs/model.md").read_text("utf-8")
    assert f"moves backward only if bw exceeds {stops_s:.3f} s." in page


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
    best = {"level": "order-narrow", "budget": 30, "entry": "IPPO"}
    learned = {"level": "order-wide", "policy": "learned"}
    return [
        *laws,
        *interval(page, "of IPPO, score {} there", ENTRIES, best, ends_of("score")),
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
            ("the damped law 1, TRPO {} and PPO", "TRPO", "score", ".2f"),
            ("law 1, TRPO # and PPO {}.", "PPO", "score", ".2f"),
            ("take # s and score {}, while", "paired branches", "score", ".2f"),
            ("take {} s and score #, while", "paired branches", "cpu_s", ".0f"),
            ("while TRPO's take {} s (", "TRPO", "cpu_s", ".0f"),
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
            Number(page, words, f"{SPEED}slide.csv", row, "slide_median_cm", form)
            for words, row, form in (
                ("ends {} cm from its exact position with the default scheme", OURS, ".5f"),
                ("{} cm with the first-order scheme `moreau`", MOREAU, ".2g"),
                ("and {} cm in rapier", RAPIER, ".2g"),
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


def lower_orders(rows: Any) -> pd.Series:
    """By how many s order is lost later where that means a mean Ψ_o below 0.3."""
    middle = pd.read_csv(REPOSITORY / "studies/section5/claims.csv")
    own = rows[(rows["n_boats"] == 20) & (rows["n_leaders"] == 0) & (rows["pool"] == "wide")]
    found = {}
    for reading, row in LOST_IN.items():
        runs = own[(own[list(row)] == pd.Series(row)).all(axis=1)]
        psi_o = runs.groupby("bw_s")["psi_o"].mean()
        last = psi_o[psi_o >= 0.3].index[-1]
        ends = psi_o.loc[last:].iloc[:2]
        crossing = np.interp(-0.3, -ends.to_numpy(), ends.index.to_numpy())
        is_own = (middle["reading"] == f"{reading}, n = 20") & (
            middle["quantity"] == LOST["quantity"]
        )
        found[reading] = crossing - middle[is_own]["measured"].iloc[0]
    return pd.Series(found)


def readme_of_studies(page: str) -> list[Number]:
    quiet = {"pool": "wide", "n_boats": 20, "c4": 0.0}

    def jammed(rows: Any) -> float:
        return 100 * rows["jammed"].mean()

    return [
        *(
            Number(
                page,
                words,
                "studies/density/results/quiet.csv",
                quiet | {"preset": preset},
                jammed,
                ".0f",
            )
            for words, preset in (
                ("20 boats jam in {} % of the frames with the default", "simulation"),
                ("in # % of the frames with the default scheme, and in {} % with", "paper"),
            )
        ),
        Number(
            page, "would be {} to # s higher", SECTION5, {}, lambda rows: lower_orders(rows).min()
        ),
        Number(
            page,
            "would be # to {} s higher",
            SECTION5,
            {},
            lambda rows: lower_orders(rows).max(),
            ".1f",
        ),
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
                ("lose it at {} to # s: the less", "paper, 0.1 cm"),
                ("lose it at # to {} s: the less", "paper, 0.001 cm"),
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
    *quoted_speed.every(),
    *energy(),
    *critical(),
    *instructions(),
    *levels(),
    *easy_branches(),
    *leaders("README.md"),
    *leaders("docs/leaders.md"),
    *plans("docs/leaders.md"),
    *offsets(),
    *trainings(),
    *lessons(),
]


def ratio(table: str, column: str, one: dict[str, Any], other: dict[str, Any]) -> float:
    """A cell of a table over another one."""
    rows = pd.read_csv(REPOSITORY / table)
    cells = [rows[(rows[list(row)] == pd.Series(row)).all(axis=1)] for row in (one, other)]
    return cells[0][column].item() / cells[1][column].item()


def solving(boats: int) -> float:
    """The share of a step in which contacts are solved."""
    row = pd.read_csv(REPOSITORY / SPEED / "profile.csv").set_index("n").loc[boats]
    return row["solve_us"] / row["whole_us"]


@pytest.mark.parametrize(
    ("words", "fraction", "found"),
    [
        (
            "has nine tenths of the error at 1e-6 cm that it has at 1e-4 cm",
            9 / 10,
            ratio(
                f"{SPEED}slide.csv",
                "slide_median_cm",
                OURS | {"tolerance_cm": 1e-6, "setting": OURS["setting"].replace("1e-4", "1e-6")},
                OURS,
            ),
        ),
        (
            "instructions per boat and step grow by a tenth in the jam",
            1.1,
            ratio(
                "benches/instructions.csv",
                "per boat and substep",
                {"scene": "jam of 1000"},
                {"scene": "jam of 27"},
            ),
        ),
        ("takes two thirds of a step of 27 boats in a jam", 2 / 3, solving(27)),
        ("in a jam, and half of a step of 1000 boats", 1 / 2, solving(1000)),
    ],
)
def test_a_fraction_in_words_is_that_of_the_data(words: str, fraction: float, found: float):
    assert words in (REPOSITORY / quoted_speed.PAGE).read_text("utf-8")
    assert found == pytest.approx(fraction, abs=0.05)


def test_the_error_in_the_jam_does_not_come_from_the_tolerance():
    rows = pd.read_csv(REPOSITORY / SPEED / "horizon.csv")
    ours = {"engine": "flockenv", "scheme": "leapfrog", "solver": "block-pivoting", "scene": "jam"}
    rows = rows[(rows[list(ours)] == pd.Series(ours)).all(axis=1)]
    errors = rows.pivot_table("horizon_median_cm", "dt_s", "tolerance_cm")
    assert len(errors) == 5
    for smaller in (1e-6, 1e-9):
        assert (errors[smaller] / errors[1e-4]).between(0.895, 1.105).all()


def test_one_of_eleven_settings_shows_a_change_of_the_order():
    """It is that of trainings, which lies within three standard errors."""
    page = (REPOSITORY / quoted_speed.PAGE).read_text("utf-8")
    assert "Of eleven settings of `leapfrog` and `moreau` one shows a change" in page
    rows = pd.read_csv(REPOSITORY / SPEED / "order.csv")
    kept = rows["scheme"].isin(["leapfrog", "moreau"]) & (rows["psi_o_half_width"] > 0)
    ours = rows[kept & (rows["first_seed"] == 1)]
    assert len(ours) == 11
    training = ours[(ours["dt_s"] == 0.1) & (ours["tolerance_cm"] == 1e-4)].iloc[0]
    changed = ours[ours["psi_o_error"].abs() > ours["psi_o_half_width"]]
    assert list(changed.index) == [training.name]
    for name in ("psi_o_{}", "c_v_{}_cm2_s2"):
        error, half = (training[name.format(each)] for each in ("error", "half_width"))
        # Half a 95 % interval is two standard errors or more.
        assert abs(error) < 1.5 * half


def test_three_million_control_steps_kept_the_tolerance():
    runs = pd.read_csv(REPOSITORY / "docs/throughput/soak.csv")
    assert runs["control_steps"].sum() >= 3_000_000
    assert (runs["worst_overlap_cm"] <= runs["tolerance_cm"]).all()
    assert (runs[["unsolved", "solver_errors"]] == 0).all(axis=None)


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
