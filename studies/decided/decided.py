"""What do more runs decide? Open statements judged once, by new runs alone.

The number of runs of a statement follows from `Statement.needed`, which its line of ``claims.csv``
estimated before any of them was made; the rule stands in README.md.
"""

import math
import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

import matplotlib as mpl
import pandas as pd

from studies.claim import OPEN, Claim, Interval, mean, proportion, write_claims
from studies.counts import FIGURES
from studies.headlines import headlines
from studies.picture import COLORS, picture
from studies.section4 import fig07, fig10, fig12, section4, states
from studies.section5 import fig14, fig15, fig17, section5
from studies.section5.section5 import FEW_LEVELS_S, LOW_S, READINGS, Evidence
from studies.study import FIRST_SEED, HERE, Options, Row, Study, main

FIRST, BLOCK = 30_000, 1000
"""The first of the seeds that no other study has, and the seeds kept for each statement."""
MARGIN, MOST_RUNS = 1.5, 500
"""How many times the runs that would decide are made, and how many at most."""


@dataclass(frozen=True, eq=False)
class Runs:
    """The runs that judge a statement.

    Attributes
    ----------
    study
        Where they are first made: what is measured of a run.
    cells
        The rows of one seed.
    found
        The statement's value, from a table of such runs.
    counted
        How many runs of a seed its line of ``claims.csv`` counts: all, or one if it counts seeds.
    """

    study: Study
    cells: tuple[Row, ...]
    found: Callable[[pd.DataFrame], Interval]
    counted: int = 1


@dataclass(frozen=True, eq=False)
class Statement:
    """An open line of a ``claims.csv``, found by its columns, and the runs that judge it again.

    Attributes
    ----------
    figure, claim, reading, quantity
        The line; of the quantity a part.
    needed
        The runs that would decide it, as its line says.
    runs
        How they are made.
    """

    figure: str
    claim: str
    reading: str
    quantity: str
    needed: int
    runs: Runs

    @property
    def seeds(self) -> int:
        """Number of seeds, fixed before any of them is run."""
        runs = min(MOST_RUNS, math.ceil(MARGIN * self.needed))
        return round(runs / self.runs.counted)

    @property
    def first_seed(self) -> int:
        """The first seed of the statement's block."""
        return FIRST_SEED + FIRST + BLOCK * STATEMENTS.index(self)

    def rows(self) -> list[Row]:
        """Return the runs."""
        return [
            cell | {"first_seed": self.first_seed, "seed": seed}
            for seed in range(self.seeds)
            for cell in self.runs.cells
        ]

    def line(self) -> pd.Series:
        """Return the committed line that left the statement open."""
        folder = self.runs.study.name.partition("/")[0]
        table = pd.read_csv(HERE / folder / "claims.csv", dtype=str, keep_default_na=False)
        same = table["quantity"].str.contains(self.quantity, regex=False)
        for name in ("figure", "claim", "reading"):
            same &= table[name] == getattr(self, name)
        (place,) = table.index[same]
        return table.loc[place]

    def judged(self, found: Interval) -> Claim:
        """Return the statement with a new value."""
        line = self.line()
        texts = [str(line[name]) for name in ("claim", "section", "reading", "quantity")]
        least, most = float(line["least"]), float(line["most"])
        return Claim(*texts, found, least, most, ours=line["of"] == "ours")


# --- section 4 -----------------------------------------------------------------------------------


def _setups(names: Iterable[str], least_s: float, most_s: float) -> tuple[Row, ...]:
    setups = [section4.SETUPS[name] for name in names]
    return tuple(
        {"preset": "experiment", "n_leaders": k, "target": target, "bw_s": bw_s, "minutes": 8.0}
        for k, target in setups
        for bw_s in section4.LEVELS_S
        if least_s <= bw_s <= most_s
    )


def _experiment(bw_s: float, minutes: float, n_leaders: int = 0) -> Row:
    return {"preset": "experiment", "n_leaders": n_leaders, "bw_s": bw_s, "minutes": minutes}


def _gain(name: str, needed: int, least_s: float, most_s: float) -> Statement:
    cells = _setups((section4.FREE, section4.CW), least_s, most_s)
    runs = Runs(section4.STUDY, cells, lambda table: fig10.gain(table, least_s, most_s))
    claim = f"Leaders increase the order at {name} noise"
    return Statement("fig10", claim, section4.READING, "with 3 clockwise leaders", needed, runs)


def _lost(setup: str, needed: int) -> Statement:
    cells = _setups((setup,), 0.0, 2.8)
    claim = "Ψ_o becomes that of disorder around bw = 2.0 s"
    runs = Runs(section4.STUDY, cells, fig10.lost, len(cells))
    return Statement("fig10", claim, section4.READING, setup, needed, runs)


def _onset(claim: str, quantity: str, needed: int, place: int) -> Statement:
    cells = tuple(_experiment(bw_s, 16.0) for bw_s in (0.8, 1.2, 1.4))
    runs = Runs(states.STUDY, cells, lambda table: states.onsets(table)[place])
    return Statement("states", claim, _FREE, quantity, needed, runs)


_FREE = f"{section4.READING}, no leaders"
_JAMMED = headlines.DENSE.rows("one jam")


# --- section 5 -----------------------------------------------------------------------------------


def _reading(
    claim: str,
    name: str,
    needed: int,
    noises: Iterable[float],
    found: Callable[[Evidence], Interval],
    *,
    n: int = 20,
    k: int = 0,
    figure: str = "readings",
    counted: int = 1,
) -> Statement:
    cells = tuple(
        READINGS[name] | {"n_boats": n, "n_leaders": k, "bw_s": bw_s, "minutes": 30.0}
        for bw_s in noises
    )
    runs = Runs(section5.STUDY, cells, lambda table: found(Evidence(table, name)), counted)
    return Statement(figure, claim, f"{name}, n = {n}", "", needed, runs)


def _both_states(name: str, needed: int, n: int = 20, figure: str = "readings") -> Statement:
    def found(e: Evidence) -> Interval:
        _, count, of = fig17.in_rarer_state(e.runs)
        return proportion(count, of)

    claim = "Jam and rotation both come from random starts at one n"
    return _reading(claim, name, needed, (0.0,), found, n=n, figure=figure)


def _few_jams(name: str, needed: int) -> Statement:
    claim = "20 boats are not jammed often enough to leave a mark"
    return _reading(
        claim, name, needed, (0.0, LOW_S), lambda e: mean(e.runs.groupby("seed")["jammed"].mean())
    )


def _loss(name: str, needed: int, n: int, k: int) -> Statement:
    claim = f"Order is lost at bw of 0.6 to 0.8 s, {'with' if k else 'without'} leaders"
    every = len(FEW_LEVELS_S)
    return _reading(
        claim, name, needed, FEW_LEVELS_S, lambda e: e.critical(n, k), n=n, k=k, counted=every
    )


def _their_way(name: str, needed: int, n: int) -> Statement:
    claim = "With leaders order has their direction only"
    return _reading(
        claim, name, needed, FEW_LEVELS_S, lambda e: fig14.clockwise(e.runs), n=n, k=n // 5
    )


STATEMENTS = (
    Statement(
        "headlines",
        "50 boats in wide need backing to move",
        "one jam",
        "",
        124,
        Runs(
            headlines.STUDY,
            tuple(
                {name: value for name, value in row.items() if name != "seed"}
                for row in _JAMMED
                if row["seed"] == _JAMMED[0]["seed"]
            ),
            lambda table: headlines.Runs(table, "one jam").rise(headlines.DENSE),
        ),
    ),
    Statement(
        "fig07",
        "The flock follows its leaders' direction in every 4-minute interval with high efficiency",
        f"{section4.READING}, 3 leaders",
        "bw = 1.4 s",
        174,
        Runs(fig07.STUDY, (_experiment(1.4, 16.0, 3),), fig07.followed),
    ),
    Statement(
        "fig12",
        "Order increases with the number of leaders",
        section4.READING,
        "bw = 1.4 s",
        166,
        Runs(fig12.STUDY, tuple(_experiment(1.4, 8.0, k) for k in range(5)), fig12.per_leader, 5),
    ),
    _gain("medium", 28, *section4.MEDIUM_S),
    Statement(
        "states",
        "The direction of a moving flock can change at bw = 1.9 s",
        _FREE,
        "",
        195,
        Runs(
            states.STUDY,
            (_experiment(1.9, 16.0),),
            lambda table: proportion((table["turns"] > 0).sum(), len(table)),
        ),
    ),
    _onset("Velocities change more abruptly than orientations", "rise", 76, 1),
    _both_states("simulation", 76, 26, "fig17"),
    _lost(section4.CCW, 370),
    _lost(section4.CW, 387),
    _reading(
        "The transition from order to disorder is smooth",
        "simulation",
        399,
        section5.LEVELS_S,
        lambda e: fig15.steepest(e.groups(20, 0, "psi_o")),
        figure="fig15",
        counted=len(section5.LEVELS_S),
    ),
    _onset("Orientations signal the coming order earlier than velocities", "halfway", 437, 0),
    _gain("low", 386, *section4.LOW_S),
    _few_jams("paper, dt 0.05 s", 36),
    _few_jams("paper, white, 0.001 cm", 39),
    _few_jams("paper, white", 97),
    _both_states("paper, white, 0.1 cm", 195),
    _both_states("paper, 0.1 cm", 195),
    _both_states("paper, white, 0.001 cm", 195),
    _loss("paper, dt 0.01 s", 294, 20, 0),
    _both_states("paper, 0.03 cm", 169, 30),
    _their_way("paper, white, 0.1 cm", 60, 20),
    _both_states("paper, narrow", 195),
    _loss("leapfrog, per-step", 295, 50, 10),
    _both_states("moreau, per-step", 195),
    _loss("paper, narrow", 235, 50, 10),
    _both_states("leapfrog, per-step", 195),
    _both_states("simulation, narrow", 195),
    _their_way("simulation, narrow", 91, 50),
    _reading(
        "Without leaders order comes in both directions in simulation",
        "simulation, narrow",
        195,
        FEW_LEVELS_S,
        lambda e: proportion(*fig14.in_rarer_direction(e.runs)),
    ),
)
"""The headlines' and the figures' statements first, then the readings'; the cheapest first."""


def design(study: Study) -> list[Row]:
    """Return the new runs of a study, statement by statement."""
    return [row for each in STATEMENTS if each.runs.study is study for row in each.rows()]


STUDIES = {
    study.name: Study(
        f"decided/{study.name.partition('/')[2]}", partial(design, study), study.measure
    )
    for study in dict.fromkeys(each.runs.study for each in STATEMENTS)
}
"""The new runs, by the name of the study that made the first ones."""


def judge(tables: dict[str, pd.DataFrame], trial: bool = False) -> dict[Statement, Claim]:
    """Judge each statement of which all runs have been made; in a trial, of which any has."""
    found = {}
    for each in STATEMENTS:
        table = tables[each.runs.study.name]
        runs = table[table["first_seed"] == each.first_seed]
        if len(runs) == len(each.rows()) or (trial and len(runs)):
            found[each] = each.judged(each.runs.found(runs))
    return found


def draw(options: Options, judged: dict[Statement, Claim]) -> None:
    """Draw both intervals of each statement by their distance to the bound.

    The bound is the one nearer to the first value, and the longer half of the first interval is 1.
    """
    with picture(options, "decided", height_cm=1.5 + 1.1 * len(judged)) as figure:
        axes = figure.subplots()
        axes.axvspan(0.0, 100.0, color="0.93", zorder=0)
        axes.axvline(0.0, color="0.6", linewidth=0.6, zorder=0)
        reach = 1.0
        for place, (statement, claim) in enumerate(judged.items()):
            line = statement.line()
            first = [float(line[name]) for name in ("measured", "low", "high")]
            bound = min((claim.least, claim.most), key=lambda each: abs(each - first[0]))
            half = max(abs(end - first[0]) for end in first)
            side = (1.0 if bound == claim.least else -1.0) / half
            for shift, color, ends in ((-0.16, COLORS[0], first), (0.16, COLORS[1], claim.found)):
                value, *interval = (side * (each - bound) for each in ends)
                axes.plot(sorted(interval), [place + shift] * 2, color=color)
                axes.plot([value], [place + shift], "o", color=color)
                reach = max(reach, *(abs(each) for each in (value, *interval)))
        names = [_name(each) for each in judged]
        axes.set_yticks(range(len(names)), names, fontsize=8.5)
        axes.set(xlim=(-1.05 * reach, 1.05 * reach), ylim=(len(judged) - 0.5, -0.5))
        axes.set_xlabel("distance to the bound in halves\nof the first interval; gray: holds")
        handles = [
            mpl.lines.Line2D([], [], color=color, marker="o", label=label)
            for color, label in zip(COLORS, ("first runs", "new runs"), strict=False)
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=2)


def _name(statement: Statement) -> str:
    return "\n".join(textwrap.wrap(f"{statement.claim} ({_where(statement)})", 62))


def _where(statement: Statement) -> str:
    number, _ = FIGURES.get(statement.figure, ("", ""))
    if not number:
        return statement.reading
    setup = f", {statement.quantity}" if statement.quantity in section4.SETUPS else ""
    return f"figure{'s' if ' ' in number else ''} {number}{setup}"


def table() -> str:
    """Return the committed judgments in Markdown, by the first runs and by the new ones."""
    claims = pd.read_csv(HERE / "decided" / "claims.csv", dtype=str, keep_default_na=False)
    rows = [["statement", "where", "first runs", "new runs", "answer"], ["---"] * 5]
    for each in STATEMENTS:
        first = each.line()
        found = claims[(claims[list(_LINE)] == first[list(_LINE)]).all(axis=1)]
        for _, new in found.iterrows():
            shown = [_value(line) for line in (first, new)]
            more = f" ({new['runs_that_would_decide']} runs would decide)"
            answer = new["verdict"] + (more if new["verdict"] == OPEN else "")
            rows.append([each.claim, _where(each), *shown, answer])
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


_LINE = ("figure", "claim", "reading", "quantity")


def _value(line: pd.Series) -> str:
    ends = f"{line['measured']} ({line['low']} to {line['high']})".replace("-", "−")
    return f"{ends}, n = {line['n_runs']}"


def script(options: Options) -> None:
    """Make the runs, judge the statements that have all of theirs, and draw them."""
    tables = {name: study.results(options, optional=True) for name, study in STUDIES.items()}
    judged = judge(tables, options.trial)
    for figure in dict.fromkeys(each.figure for each in judged):
        write_claims(options, figure, [c for each, c in judged.items() if each.figure == figure])
    if judged:
        draw(options, judged)
    if options.out == HERE and judged:
        print(table(), end="")


if __name__ == "__main__":
    main(script)
