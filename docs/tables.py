"""Fill the marked tables of the pages from committed data: `make tables`.

A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``; `TABLES` says how NAME is made
and from which file. tests/docs/test_tables.py fails where a page differs from its data.
"""

import re
from collections.abc import Callable
from pathlib import Path

from committed_data import (
    DIFFERENCES,
    MEANS,
    difference,
    interval,
    markdown,
    one,
    order,
    rows,
)
from floors import floors
from readme_numbers import figures, findings, speed
from training_tables import TRAINING_TABLES

DOCS = Path(__file__).parent
PAGES = (
    DOCS.parent / "README.md",
    DOCS.parent / "ARCHITECTURE.md",
    DOCS.parent / "paper" / "README.md",
    *sorted(DOCS.glob("*.md")),
)
MARKED = re.compile(r"(<!-- table: (\S+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def main() -> None:
    """Rewrite every page in which a table differs from its data."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        new = filled(text)
        if new != text:
            page.write_text(new, encoding="utf-8")


def filled(text: str) -> str:
    """Return a page with each marked table made again."""
    return MARKED.sub(lambda found: f"{found[1]}\n{TABLES[found[2]]()}\n\n{found[4]}", text)


LADDER = ("paper's law", "damped law", "tuned law", "learned")

# --- the leaders ----------------------------------------------------------------------------------


def leader_count() -> str:
    """Return what `make compare` prints."""
    file = "leaders/leader_count.csv"
    policies = ("paper's law", "tuned law", "learned")
    body = [["0", order(one(file, policy="no leaders", leaders="0")), "", ""]]
    for k in ("1", "2", "3", "4"):
        body.append([k, *(order(one(file, policy=name, leaders=k)) for name in policies)])
    slopes = [one(file, policy=name, leaders="slope") for name in policies]
    body.append(["slope per leader", *(f"{float(row['signed_order']):.3f}" for row in slopes)])
    return markdown(["leaders", *policies], body)


def leaders_of(case: str) -> str:
    """Return the order with each policy in a pool, and what learning adds to the tuned law."""
    body = []
    for k in ("1", "2", "3", "4"):
        known = {"case": case, "leaders": k}
        means = (one(MEANS, policy=name, **known) for name in LADDER)
        added = one(DIFFERENCES, policy="learned", reference="tuned law", **known)
        body.append([k, *(order(row) for row in means), difference(added)])
    return markdown(["leaders", *LADDER, "learned minus tuned law"], body)


def leaders_close() -> str:
    """Return learned leaders and the tuned law in more flocks, where they are close."""
    body = []
    for pool, case, leaders in (
        ("wide", "wide-bw-0.31", "1"),
        ("narrow", "narrow-bw-0.45", "1234"),
    ):
        for k in leaders:
            known = {"case": case, "leaders": k}
            means = (one("leaders/close_means.csv", policy=name, **known) for name in LADDER[2:])
            added = one("leaders/close_differences.csv", policy="learned", **known)
            body.append([f"`{pool}`", k, *(order(row) for row in means), difference(added)])
    return markdown(["pool", "leaders", *LADDER[2:], "learned minus tuned law"], body)


def leader_motion() -> str:
    """Return how leaders head and where they are."""
    body = [
        [
            f"`{row['pool']}`",
            row["policy"],
            f"{float(row['alignment']):.3f}",
            f"{float(row['velocity_cm_s']):.2f}",
            f"{float(row['radius_cm']):.1f}",
            f"{float(row['apart_cm']):.1f}",
            *(
                f"{100 * float(row[name]):.0f} %"
                for name in ("at_wall", "beside_wall", "beside_leader")
            ),
        ]
        for row in rows("leaders/motion.csv")
    ]
    header = [
        "pool",
        "policy",
        "mean cosine of misalignment",
        "velocity towards the target, cm/s",
        "distance from the center, cm",
        "distance to the next leader, cm",
        "time in the row at the wall",
        "time beside that row",
        "time within 20 cm of a leader",
    ]
    return markdown(header, body)


def tuned_laws() -> str:
    """Return what tuning for each number of leaders adds to the tuned law."""
    body = []
    for row in rows("leaders/tuned_laws/gains.csv"):
        gains = ", ".join(row[name] for name in ("gain", "backward_gain", "damping"))
        mean = interval(row, "signed_order", "low", "high")
        more = interval(row, "beyond", "beyond_low", "beyond_high", "+.3f")
        body.append([f"`{row['pool']}`", row["leaders"], gains, mean, more])
    header = ["pool", "leaders", "gain, backward gain, damping", "signed order"]
    return markdown([*header, "minus the tuned law"], body)


TABLES: dict[str, Callable[[], str]] = {
    "floors": floors,
    "figures": figures,
    "findings": findings,
    "leader-count": leader_count,
    "leaders-wide": lambda: leaders_of("wide-bw-0.31"),
    "leaders-narrow": lambda: leaders_of("narrow-bw-0.45"),
    "leaders-close": leaders_close,
    "leader-motion": leader_motion,
    "tuned-laws": tuned_laws,
    "speed": speed,
    **TRAINING_TABLES,
}
"""How each table is made."""


if __name__ == "__main__":
    main()
