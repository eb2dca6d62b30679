"""Law: a number that a page of the studies takes from committed data is the number in the data.

A row below names the sentence and the cell. If one of them changes, somebody edits the other.
"""

from collections.abc import Callable
from typing import Any

import pytest

from docs.scripts.quoted import (
    DENSITY,
    RANKS,
    Number,
    ends_of,
    interval,
    mean,
    most_of_an_offset,
    offset,
    plans,
    ranks_of_levels,
)


def count(verdict: str) -> Callable[[Any], float]:
    return lambda rows: (rows["verdict"] == verdict).sum()


def entries() -> list[Number]:
    """Numbers of what learns from nothing."""
    page, folder = "studies/levels/README.md", "studies/levels/results/"
    pairs, table = f"{folder}pairs.csv", f"{folder}entries.csv"
    few = {"level": "order-easy", "budget": 30}
    longer = {"budget": 100, "entry": "paired branches"}
    best = {"level": "order-easy", "entry": "TRPO"}
    unlike, ranks = f"{folder}unlike.csv", f"{folder}unlike_ranks.csv"
    wide = {"level": "order-wide", "budget": 30, "entry": "paired branches"}

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
        *interval(page, "has {}, the highest", table, {**few, "entry": "TRPO"}, ends_of("score")),
        *interval(page, "branches have {}: one", table, longer, ends_of("score")),
        *interval(
            page,
            "evolution has {}, and",
            table,
            {"budget": 100, "entry": "linear evolution"},
            ends_of("score"),
        ),
        *(
            number
            for words, level, entry in (
                ("branches in `order-wide`, {}.", "order-wide", "paired branches"),
                ("score in `order-noisy`, {}, and", "order-noisy", "TRPO"),
                ("TRPO has {} in `order-wide`", "order-wide", "TRPO"),
                ("law gains: IPPO has {}, MAPPO", "order-narrow", "IPPO"),
                ("to #), MAPPO {}, and TRPO", "order-narrow", "MAPPO"),
                ("to #), and TRPO {}. These", "order-narrow", "TRPO"),
            )
            for number in interval(
                page,
                words,
                table,
                {"level": level, "budget": 30, "entry": entry},
                ends_of("score"),
            )
        ),
        *interval(
            page,
            "at random, but {} over these 512",
            f"{folder}laws.csv",
            {"level": "order-narrow", "policy": "straight ahead"},
            ("signed_order", "low", "high"),
            ".3f",
        ),
        Number(
            page,
            "correction {} differ in `order-noisy`",
            pairs,
            {"level": "order-noisy"},
            small,
            "d",
        ),
        *ranks_of_levels(
            page,
            "flock is {} in `order-noisy`",
            "{} in `order-wide` and",
            "and {} in `order-narrow` (",
        ),
        *(
            number
            for words, level in (
                ("algorithms is {},", "order-easy"),
                ("(# to #), {}, # (#", "order-noisy"),
                ("(# to #), {} and", "order-narrow"),
                ("to #) and {}.", "order-wide"),
            )
            for number in interval(page, words, ranks, {"level": level}, RANKS)
        ),
        Number(page, "mean over {} or # cond", unlike, {}, lambda r: r["conditions"].min(), "d"),
        Number(page, "mean over # or {} cond", unlike, {}, lambda r: r["conditions"].max(), "d"),
        Number(page, "fall from {} to # (# to #)", table, wide, "score"),
        *interval(page, "fall from # to {}", unlike, wide, ends_of("unlike")),
        Number(page, "falls from {} to # (# to #)", table, best, "score"),
        *interval(page, "falls from # to {}", unlike, best, ends_of("unlike")),
        *(
            Number(page, words, pairs, {"level": level}, told_apart, "d")
            for words, level in (
                ("{} of # pairs differ in `order-noisy`", "order-noisy"),
                ("trainings each), {} in `order-narrow`", "order-narrow"),
                ("`order-narrow` and {} in `order-wide`", "order-wide"),
            )
        ),
    ]


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


def offsets() -> list[Number]:
    """What one step of planning without foresight adds."""
    page = "studies/planning/README.md"
    return [
        *offset(page, "best of 16 leans, adds {}", 96),
        *offset(page, "The chosen offset adds {} to the mean order between 8 and 64 s", 64),
        *offset(page, "after the branch, and {} between 8 and 96 s", 96),
        most_of_an_offset(page, "One step is worth at most {} by the upper ends"),
        most_of_an_offset("studies/README.md", "one step without it at most {}."),
    ]


def trainings() -> list[Number]:
    """What PPO and the evolution strategy gained."""
    page, file = (
        "studies/trainings/README.md",
        "studies/trainings/results/algorithms/algorithms.csv",
    )
    words = {"train_leaders": "PPO's five seeds gain", "evolution": "the evolution strategy's"}
    return [
        number
        for algorithm, text in words.items()
        for number in interval(
            page, f"{text} {{}}", file, {"algorithm": algorithm}, ends_of("gain"), ".3f"
        )
    ]


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


LOST_BELOW = "bw (s) at which mean Ψ_o falls through 0.3, "


def section_4() -> list[Number]:
    page = "studies/section4/README.md"
    bias = {"reading": "experiment, narrow, n = 27", "claim": "leaders against the bias"}
    return [
        *interval(
            page,
            "2.0 s higher by {} with counter",
            "studies/calibration/claims.csv",
            bias,
            form=".3f",
        ),
    ] + [
        Number(page, words, "studies/section4/claims.csv", {"quantity": quantity})
        for words, quantity in (
            ("uniform density at {} s (# to #) without leaders", f"{DENSITY}, no leaders"),
            ("and at {} s (# to #) with three. It falls", f"{DENSITY}, 3 leaders, CW"),
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
    low = {"claim": "Leaders increase the order at low noise"}
    rise = {"claim": "Velocities change more abruptly than orientations"}
    turns = {"claim": "The direction of a moving flock can change at bw = 1.9 s"}
    slope = {"figure": "fig12"}
    orientations = {"claim": "Orientations signal the coming order earlier than velocities"}
    own, table = "studies/decided/README.md", "studies/README.md"
    return [
        *(
            Number(page, words, file, slope, column, ".3f")
            for words, column in (
                ("at 1.4 s by {} (# to #; [# more", "measured"),
                ("at 1.4 s by # ({} to #; [# more", "low"),
                ("at 1.4 s by # (# to {}; [# more", "high"),
            )
        ),
        Number(page, "| {} (# to #) at low,", file, low, form="+.3f"),
        *interval(page, "| {} at low,", file, low, form=".3f")[1:],
        Number(page, "to 0.8 s the gain is {} (#", file, low, form=".3f"),
        Number(page, "at low, {} (# to #) at medium", file, medium, form="+.2f"),
        *interval(page, "at low, {} at medium", file, medium)[1:],
        Number(
            page,
            "rise shorter by {} s (#",
            file,
            rise,
            lambda rows: -rows["measured"].item(),
            ".1f",
        ),
        Number(page, "0 of {} [more runs]", file, turns, "n_runs", "d"),
        *(
            number
            for where, words in (
                (page, "earlier than velocities | by {} | match"),
                (own, "Ψ_o passes halfway {} before"),
            )
            for number in interval(where, words, file, orientations, form=".1f", unit=" s")
        ),
        *(
            Number(where, words, file, column=count(verdict), form="d")
            for where, words, verdict in (
                (own, "statements: {} hold and", "holds"),
                (own, "statements: # hold and {} fail.", "fails"),
                (table, "open statements: {} hold and", "holds"),
                (table, "open statements: # hold and {} fail", "fails"),
            )
        ),
        Number(
            "studies/section5/README.md",
            "of {} [more runs](../decided/README.md) in the rarer",
            file,
            {"figure": "fig17"},
            "n_runs",
            "d",
        ),
    ]


def calibration() -> list[Number]:
    """What the best candidate for the experiment's constants mends, and what it misses."""
    page, file = "studies/calibration/README.md", "studies/calibration/claims.csv"
    candidate = {"reading": "candidate 706, narrow, n = 27"}
    return [
        number
        for words, claim, unit in (
            ("1.4 to 2.0 s by {}, and we read", "leaders add coherence", ""),
            ("than those by {}, and we asked", "leaders against the bias", ""),
            ("are lost at {} without", "direction lost, no leaders", " s"),
            ("very low noise is {} of its", "C_v at very low noise", ""),
        )
        for number in interval(page, words, file, candidate | {"claim": claim}, unit=unit)
    ] + [
        Number(page, "matches {} and misses #, `experiment`", file, candidate, count("holds"), "d"),
        Number(page, "matches # and misses {}, `experiment`", file, candidate, count("fails"), "d"),
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
    claims = "studies/transition/claims.csv"
    dense = {"c4": 0.1, "coverage": 0.6, "start": "one-jam"}
    ring = "leapfrog, white c4 = 0.1, dt = 0.1 s, bw = 0, ring of 83 cm, n = "
    outside = "coverage outside of jams, {} boats, coverage 0.6"
    map_of, three = (
        "studies/transition/phases.csv",
        "One jam and rotation both last for three hours",
    )
    strong = dense | {"scheme": "leapfrog"}
    loop = {"minutes": 80, "n_boats": 200}
    added, white = "boats outside of jams per boat added, {} boats", ring.removesuffix(", n = ")
    literal = "paper, literal c4 = 0.1, dt = 0.02 s, bw = 0, ring of 83 cm"
    of_paper, white_strong = {"scheme": "paper"}, {"scheme": "leapfrog", "c4": 0.1}

    def stayed(rows: Any) -> float:
        return round(rows["measured"].iloc[0] * rows["n_runs"].iloc[0])

    def rarer(name: str, *pair: float) -> Callable[[Any], float]:
        return lambda rows: (
            rows[rows["coverage"].isin(pair) & (rows["start"] != "half-and-half")]
            .groupby("start")[name]
            .sum()
            .min()
        )

    def of_loop(end: Callable[[Any], float]) -> Callable[[Any], float]:
        return lambda rows: end(
            rows[name].mean()
            for name in rows
            if name.startswith("m_") and float(name.rpartition("_")[2]) <= 0.2
        )

    def rotate(name: str) -> Callable[[Any], float]:
        return lambda rows: rows.loc[rows["coverage"] <= 0.3, name].sum()

    return [
        *(
            Number(page, words, claims, {"claim": three, "reading": reading}, stayed, ".0f")
            for words, reading in (
                ("for c4 = 0.0141 ({} of 6 from", ring.replace("0.1,", "0.0141,", 1) + "200"),
                ("0.03 ({} of 12 in", ring.replace("0.1,", "0.03,", 1) + "200"),
                ("and 0.05 ({} of 6)", ring.replace("0.1,", "0.05,", 1) + "200"),
                ("for 0.1 ({} of 9)", ring + "200"),
                ("for the literal noise ({} of 6)", literal + ", n = 200"),
                ("At c4 = 0.2 it is open ({} of 6)", ring.replace("0.1,", "0.2,", 1) + "200"),
            )
        ),
        *(
            Number(page, words, map_of, strong | {"n_boats": 200, "c4": c4}, "outside")
            for words, c4 in (
                ("the coverage outside is {}, #, #, # and # from", 0.0141),
                ("the coverage outside is #, {}, #, # and # from", 0.03),
                ("the coverage outside is #, #, {}, # and # from", 0.05),
                ("the coverage outside is #, #, #, {} and # from", 0.1),
                ("the coverage outside is #, #, #, # and {} from", 0.2),
            )
        ),
        *(
            Number(page, words, map_of, strong | {"n_boats": n}, "outside")
            for words, n in (
                ("The coverage outside is {}, #, #, # and # with", 100),
                ("The coverage outside is #, {}, #, # and # with", 200),
                ("The coverage outside is #, #, {}, # and # with", 400),
                ("The coverage outside is #, #, #, {} and # with", 800),
                ("The coverage outside is #, #, #, # and {} with", 1600),
            )
        ),
        Number(
            page,
            "still jam, and {} is outside",
            map_of,
            strong | {"n_boats": 800, "c4": 0.03},
            "outside",
        ),
        *(
            Number(page, words, "studies/transition/results/hysteresis.csv", loop, column, ".3f")
            for words, column in (
                ("their mean |m| is {} to # at", of_loop(min)),
                ("their mean |m| is # to {} at", of_loop(max)),
            )
        ),
        *(
            Number(page, words, map_of, chosen | {"n_boats": 200}, rarer(name, *pair), ".0f")
            for name, words, chosen, pair in (
                ("last_apart", "at c4 = 0.0141 ({} of 6) and", {"c4": 0.0141}, (0.25, 0.3)),
                ("last_apart", "and 0.03 ({} of 12), and", {"c4": 0.03}, (0.25, 0.3)),
                ("last_apart", "literal noise ({} of 6) and at 0.1", {"c4": 0.05}, (0.25, 0.3)),
                ("last_apart", "literal noise ({} of 6) and at 0.1", of_paper, (0.2, 0.25)),
                ("last_apart", "and at 0.1 ({} of 9).", white_strong, (0.3, 0.4)),
                ("last_strict", "open at 0.1 ({} of 9) and", white_strong, (0.3, 0.4)),
                ("last_strict", "literal noise ({} of 6). Jams", of_paper, (0.2, 0.25)),
            )
        ),
        *(
            Number(page, words, map_of, {"start": "rotating"}, rotate(name), ".0f")
            for words, name in (
                ("three hours in {} of # flocks", "last"),
                ("three hours in # of {} flocks", "runs"),
            )
        ),
        *(
            number
            for words, reading, boats in (
                ("make 100 boats 200, {} stay", white, "100 to 200"),
                ("twice as long, {}.", white, "200 to 400"),
                ("literal noise it is {} and", literal, "100 to 200"),
                ("literal noise it is # (# to #) and {}, at", literal, "200 to 400"),
                ("at c4 = 0.03 {}, −", white.replace("0.1,", "0.03,", 1), "100 to 200"),
            )
            for number in interval(
                page,
                words,
                claims,
                {"quantity": added.format(boats), "reading": reading},
                # Of few runs one digit is printed.
                form=".2f" if "c4 = 0.03" in words else "g",
            )
        ),
        *(
            number
            for words, sizes, n in (
                ("200 boats have {} more outside than 100", "200 minus 100", "100"),
                ("400 have {} more than 200", "400 minus 200", "200"),
            )
            for number in interval(
                page, words, claims, {"quantity": outside.format(sizes), "reading": ring + n}
            )
        ),
        Number(
            page,
            "800 have {} more than 400",
            claims,
            {"quantity": outside.format("800 minus 400"), "reading": ring + "400"},
            form=".1f",
        ),
        *(
            Number(page, words, claims, {"figure": figure}, count(verdict), ".0f")
            for figure, verdict, words in (
                ("condensation", "holds", "# statements, {} hold, # fail"),
                ("condensation", "fails", "# statements, # hold, {} fail"),
                ("condensation", "open", "# fail and {} are open; of the second"),
                ("phases", "holds", "of the second, #, {} hold"),
                ("phases", "fails", "of the second, #, # hold, {} fail"),
                ("phases", "open", "# fail and {} are open, most"),
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


def response() -> list[Number]:
    """What branches say of leaders as a linear response."""
    page, claims = "studies/response/README.md", "studies/response/claims.csv"
    flock, end = "simulation, n = {}, bw = {} s, dt = 0.05 s", "by m, 103 to 207 s after the branch"
    many, less = "R of {} over {} R of 1, {}, " + end, "R of {} less the sum, in R of 1, {}, " + end
    law, factor = "paper's law", "factor by m, {} after the branch, over that of 27 boats at 0.31 s"
    factor += ", 103 to 207 s"
    at_end = factor.format("103 to 207 s")
    learned = "R of {0} learned over R of {0} by the paper's law, " + end
    small, large = (27, 0.31), {100: (100, 0.37), 400: (400, 0.36), 1600: (1600, 0.36)}
    share = "R of {} over 2 R of {}, paper's law, " + end
    sentences = (
        ("two respond as {} times twice one, three", many.format(2, 2, law), small, ".2f"),
        ("three as {} times three", many.format(3, 3, law), small, ".2f"),
        ("six as {} times six", many.format(6, 6, law), small, ".2f"),
        ("two learned ones as {} times twice one.", many.format(2, 2, "learned"), small, ".2f"),
        ("two against one give {} of one", less.format("2 against 1", law), small, ".2f"),
        ("three against one {}, and", less.format("3 against 1", law), small, ".2f"),
        ("two learned against one {}. The", less.format("2 against 1", "learned"), small, ".2f"),
        ("1600 boats responds as {} times", share.format(118, 59), large[1600], ".2f"),
        ("Of 400 boats it is {} and", share.format(30, 15), large[400], ".2f"),
        ("and of 100 boats {}, both", share.format(8, 4), large[100], ".2f"),
        (
            "among 400 boats, {} of the smaller",
            f"R of 30 against 15 less the sum, in R of 15, {law}, {end}",
            large[400],
            ".2f",
        ),
        ("52 s the factor is {} times", factor.format("26 to 52 s"), small, ".1f"),
        ("from 52 to 103 s {} times", factor.format("52 to 103 s"), small, ".2f"),
        ("At 0.4 s the factor is {} times", at_end, (27, 0.4), ".2f"),
        ("among 100 and 400 boats {} and", at_end, large[100], ".2f"),
        ("(# to #) and {} times: these", at_end, large[400], ".2f"),
        ("At 0.2 s it is {} and", at_end, (27, 0.2), ".2f"),
        ("at 0.5 s {} times, both", at_end, (27, 0.5), ".2f"),
        ("leader moves the flock as much as {} by", learned.format(1), small, ".2f"),
        ("1600 boats as {}, # (", learned.format(4), large[100], ".2f"),
        ("1600 boats as # (# to #), {} and", learned.format(15), large[400], ".2f"),
        ("(# to #) and {}.", learned.format(59), large[1600], ".2f"),
    )
    return [
        number
        for words, quantity, of, form in sentences
        for number in interval(
            page, words, claims, {"reading": flock.format(*of), "quantity": quantity}, form=form
        )
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


def steps() -> list[Number]:
    """Where the step changes order, C_v and the noise at which order is lost."""
    page, table = "studies/step_size/README.md", "studies/step_size/claims.csv"

    def quantities(rows: Any) -> Any:
        return rows["quantity"].str.partition(" at dt")[0]

    def farthest(name: str) -> Callable[[Any], float]:
        return lambda rows: rows[quantities(rows) == name][["low", "high"]].abs().max(axis=None)

    def found(answer: str) -> Callable[[Any], float]:
        def of(rows: Any) -> float:
            own = rows[quantities(rows) != "noise of the same Ψ_o"]
            inside = (own["low"] >= own["least"]) & (own["high"] <= own["most"])
            holds_none = (own["low"] <= 0) & (own["high"] >= 0)
            answers = {"inside": inside, "undecided": ~inside & holds_none}
            answers["bias"] = ~inside & ~holds_none
            return answers[answer].sum()

        return of

    def shifts(rows: Any) -> Any:
        return rows[quantities(rows) == "noise of the same Ψ_o"]

    def most(rows: Any) -> float:
        return shifts(rows)["high"].max()

    def least(rows: Any) -> float:
        return shifts(rows)["low"].min()

    lines = [
        ("at 0.1 s, {}, by", "20 boats in wide, paper's law", "training", ".3f"),
        ("at 0.01 s, {}, and", "20 boats in wide, tuned law", "publication", ".3f"),
        ("at 0.02 s, {}. They", "27 boats in narrow, tuned law", "default", ".3f"),
    ]
    alone = {"reading": "27 boats in narrow, no leaders, physics training"}
    more_noise = f"noise of the same Ψ_o {AT_TRAINING}"
    cells = [
        *(
            (words, {"reading": f"{flock}, physics {physics}"}, form)
            for words, flock, physics, form in lines
        ),
        ("by {} of Ψ_o", alone | {"quantity": f"Ψ_o {AT_TRAINING}"}, ".4f"),
        ("{} more C_v", alone | {"quantity": f"C_v / v0² {AT_TRAINING}"}, ".4f"),
    ]
    return [
        Number(page, "move it by at most {} s. They", table, {}, most, ".2f"),
        Number(page, "leaders by at most {}, and", table, {}, farthest("Ψ_o"), ".3f"),
        Number(page, "three leaders by at most {}.**", table, {}, farthest("signed order"), ".3f"),
        Number(page, "Of 45 differences {} are", table, {}, found("inside"), "d"),
        Number(page, "**Undecided** are {},", table, {}, found("undecided"), "d"),
        Number(page, "moves by {} to # s at", table, {}, least, ".3f"),
        Number(page, "moves by # to {} s at", table, {}, most, ".3f"),
        *(
            number
            for words, row, form in cells
            for number in interval(page, words, table, row, form=form)
        ),
        *interval(
            page, "{} more noise", table, alone | {"quantity": more_noise}, form=".4f", unit=" s"
        ),
        Number("studies/README.md", "lost by at most {} s. #", table, {}, most, ".2f"),
        Number("studies/README.md", "# s. {} of 45 other", table, {}, found("inside"), "d"),
    ]


AT_TRAINING = "at dt = 0.1 s minus that at 0.005 s"

NUMBERS = [
    *entries(),
    *gradients(),
    *plans("studies/planning/README.md"),
    *offsets(),
    *trainings(),
    *headlines(),
    *section_4(),
    *calibration(),
    *current(),
    *transition(),
    *response(),
    *density(),
    *steps(),
    *decided(),
]


@pytest.mark.parametrize("number", NUMBERS, ids=lambda number: f"{number.page}: {number.words}")
def test_pages_quote_the_data(number: Number) -> None:
    found = number.shown(number.page_text())
    assert found == [number.expected()], f"{number.file} {number.row}"
