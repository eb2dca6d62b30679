"""The tables of docs/experiment_fit.md, and those of the earlier fit in docs/model.md."""

from committed_data import Row, interval, markdown, one, rows

from flockenv import FlockParameters
from flockenv.calibration.constants import CONSTANTS, POOLS
from flockenv.calibration.targets import GROUPS, MISFITS, TARGETS


def fit_targets() -> str:
    """Return what the preset `experiment-2026` was fitted to and what it reaches."""
    body = []
    for row in rows("results/experiment_fit.csv"):
        low, high = (f"{float(row[f'target_{end}']):.3g}" for end in ("low", "high"))
        value, least, most, best = (
            f"{float(row[name]):.3g}" for name in ("value", "value_low", "value_high", "best_seen")
        )
        inside = "yes" if row["in_range"] == "True" else "**no**"
        accepted = f"≥ {low}" if high == "inf" else f"{low} to {high}"
        name = f"{row['target']} ({row['source']})"
        body.append([name, accepted, value, f"{least} to {most}", inside, best])
    header = ["quantity", "paper", "fitted", "95 % interval", "in range", "nearest of any trial"]
    return markdown(header, body)


FIT = "experiment_fit"


def fit_constants() -> str:
    """Return what may be freed: bounds, reasons, the preset's values and those of the finalists."""
    finals = {f"finalist {place}": row for place, row in enumerate(rows(f"{FIT}/finalists.csv"))}
    judged = [row["name"] for row in rows(f"{FIT}/comparison.csv") if row["name"] != "start"]
    preset = FlockParameters.preset("experiment-2026")
    body = []
    for name, constant in CONSTANTS.items():
        scale = "by its logarithm" if constant.is_log else "by itself"
        values = (f"{float(finals[each][name]):.3g}" for each in judged)
        bounds = f"{constant.low:g} to {constant.high:g}, {scale}"
        body.append([f"`{name}`", bounds, constant.reason, f"{getattr(preset, name):g}", *values])
    body.append(
        [
            "`pool`",
            "both",
            "Table 1, Section 2.2",
            preset.pool,
            *(finals[n]["pool"] for n in judged),
        ]
    )
    return markdown(["constant", "bounds", "source", "`experiment-2026`", *judged], body)


def fit_judged() -> str:
    """Return the targets of the best finalists and of the preset on held-out seeds."""
    found = rows(f"{FIT}/judged.csv")
    names = list(dict.fromkeys(row["name"] for row in found))
    body = []
    for key in dict.fromkeys(row["key"] for row in found):
        each = [one(f"{FIT}/judged.csv", name=name, key=key) for name in names]
        low, high = (float(each[0][f"target_{end}"]) for end in ("low", "high"))
        accepted = (
            f"≥ {low:.3g}"
            if high == float("inf")
            else f"≤ {high:.3g}"
            if low == -float("inf")
            else f"{low:.3g} to {high:.3g}"
        )
        body.append([f"{each[0]['target']} ({each[0]['source']})", accepted, *map(_judged, each)])
    return markdown(["quantity", "paper", *(_name(name) for name in names)], body)


def _judged(row: Row) -> str:
    value, low, high = (
        f"{float(row[name]):.2f}" if row[name] else "none"
        for name in ("value", "value_low", "value_high")
    )
    inside = value if row["in_range"] == "True" else f"**{value}**"
    return inside if low == high else f"{inside} ({low} to {high})"


def _name(name: str) -> str:
    return "`experiment-2026`" if name == "start" else name


def fit_comparison() -> str:
    """Return the misfits of the best finalists and of the preset on held-out seeds."""
    body = []
    for row in rows(f"{FIT}/comparison.csv"):
        groups = (f"{float(row[name]):.2f}" for name in MISFITS)
        change = interval(row, "difference", "difference_low", "difference_high", ".2f")
        met = f"{row['met']} of {len(TARGETS)}"
        body.append([_name(row["name"]), f"`{row['pool']}`", met, *groups, change])
    header = ["parameters", "pool", "in range", *(f"misfit, {group}" for group in GROUPS)]
    return markdown([*header, "sum of misfits, less that of `experiment-2026`"], body)


def fit_finalists() -> str:
    """Return the finalists of both pools as run again."""
    body = []
    for place, row in enumerate(rows(f"{FIT}/finalists.csv")):
        groups = (f"{float(row[name]):.2f}" for name in MISFITS)
        keys = ("critical_bw_0", "critical_bw_3", "jamming", "following", "leaders_test")
        values = (f"{float(row[key]):.2f}" if row[key] else "none" for key in keys)
        body.append([str(place), f"`{row['pool']}`", row["reason"], row["met"], *groups, *values])
    return markdown(
        [
            *("finalist", "pool", "chosen for", "in range"),
            *(f"misfit, {group}" for group in GROUPS),
            *("critical bw, 0 leaders", "critical bw, 3 leaders", "jammed", "signed order"),
            "sets with p ≤ 0.01",
        ],
        body,
    )


def fit_pairs() -> str:
    """Return the five pairs of targets in each pool that fight each other the most."""
    names = {target.key: target.name for target in TARGETS}
    body = []
    for pool in POOLS:
        own = [row for row in rows(f"{FIT}/pairs.csv", pool=pool) if row["correlation"]]
        own.sort(key=lambda row: float(row["correlation"]))
        for row in own[:6]:
            numbers = (f"{float(row[name]):.2f}" for name in ("correlation", "both", "best"))
            body.append([f"`{pool}`", names[row["first"]], names[row["second"]], *numbers])
    header = ["pool", "target", "target", "correlation", "both in range", "best chance of both"]
    return markdown(header, body)


TOGETHER = {
    "critical_bw_0": "critical bw, 0 leaders",
    "critical_bw_3": "critical bw, 3 leaders",
    "low_noise_0": "Ψ_o at low noise, 0 leaders",
    "low_noise_3": "Ψ_o at low noise, 3 leaders",
    "jamming": "jamming",
    "following": "signed order",
    "leaders_slope": "Ψ_o per leader",
    "leaders_test": "sets with p ≤ 0.01",
}
"""Targets that no finalist has together, by key."""


def fit_together() -> str:
    """Return how many of the measured trials have two targets in range, and one (diagonal)."""
    known = {target.key: target for target in TARGETS}
    measured = rows(f"{FIT}/measured/first.csv")

    def inside(row: Row, key: str) -> bool:
        return bool(row[key]) and known[key].is_in_range(float(row[key]))

    body = []
    for place, (key, name) in enumerate(TOGETHER.items()):
        counts = [
            str(sum(inside(row, key) and inside(row, other) for row in measured))
            for other in list(TOGETHER)[: place + 1]
        ]
        body.append([name, *counts, *[""] * (len(TOGETHER) - place - 1)])
    return markdown(["", *TOGETHER.values()], body)


def fit_front() -> str:
    """Return the trials on the measured front, as measured again."""
    measured = rows(f"{FIT}/measured/again.csv")
    measured.sort(key=lambda row: sum(float(row[name]) for name in MISFITS))
    body = []
    for row in measured:
        cells = [
            interval(row, name, f"{name}_low", f"{name}_high", ".2f")
            if row[name] and row[f"{name}_low"]
            else row[name] or "none"
            for name in (*MISFITS, *TOGETHER)
        ]
        body.append([row["trial"], f"`{row['pool']}`", row["met"], *cells])
    groups = (f"misfit, {group}" for group in GROUPS)
    return markdown(["trial", "pool", "in range", *groups, *TOGETHER.values()], body)


def fit_variants() -> str:
    """Return what the fitted constants reach with one other choice at a time."""
    file = "results/experiment_variants.csv"
    keys = {
        "critical_bw_0": "critical bw, 0 leaders, s",
        "critical_bw_3": "critical bw, 3 leaders, s",
        "low_noise_0": "Ψ_o at low noise, 0 leaders",
        "ordered": "time in ordered motion, 0 leaders",
    }
    body = []
    for variant in dict.fromkeys(row["variant"] for row in rows(file)):
        found = [one(file, variant=variant, key=key) for key in keys]
        cells = (interval(row, "value", "value_low", "value_high", ".2f") for row in found)
        body.append([variant, *cells])
    return markdown(["variant", *keys.values()], body)


def fit_changes() -> str:
    """Return what one change at a time does to the targets that no fit has met."""
    file = f"{FIT}/changes.csv"
    names = {target.key: target.name for target in TARGETS}
    found = rows(file)
    keys = list(dict.fromkeys(row["key"] for row in found))
    body = []
    for change in dict.fromkeys(row["change"] for row in found):
        cells = (_changed(one(file, change=change, key=key)) for key in keys)
        body.append([change, *cells])
    return markdown(["change", *(names[key] for key in keys)], body)


def _changed(row: Row) -> str:
    """Return a value, bold if out of range, and the interval of what the change did to it."""
    value = f"{float(row['value']):.2f}"
    inside = value if row["in_range"] == "True" else f"**{value}**"
    if row["change"] == "none":
        return inside
    low, high = (f"{float(row[end]):+.2f}" for end in ("difference_low", "difference_high"))
    return f"{inside} ({low} to {high})"


FIT_TABLES = {
    "fit-changes": fit_changes,
    "fit-targets": fit_targets,
    "fit-variants": fit_variants,
    "fit-constants": fit_constants,
    "fit-judged": fit_judged,
    "fit-comparison": fit_comparison,
    "fit-finalists": fit_finalists,
    "fit-pairs": fit_pairs,
    "fit-together": fit_together,
    "fit-front": fit_front,
}
"""How each table is made."""
