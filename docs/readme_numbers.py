"""What the README says of speed, error and the paper's answers, from committed data."""

from statistics import fmean

from committed_data import markdown, one, rows

VERDICTS = ("holds", "fails", "open")
STUDIES = "../studies"
READING = ("dt_s", "scheme", "noise_scheme", "overlap_tolerance_cm")
LEAST_RISE = 0.3
"""Rise of mean |m| from bw = 0 to its peak from which on noise counts as what makes motion."""
OURS = {"engine": "flockenv", "setting": "leapfrog / block-pivoting / r0", "dt_s": "0.01"}
RAPIER = {"engine": "rapier2d-f64", "setting": "4 iterations / unit 10 cm", "dt_s": "0.01"}


def speed() -> str:
    """Return the speed and the error of a step beside those of rapier."""
    step = one("speed_vs_error/speed.csv", scene="jam", n="27", **OURS)
    ours, first_order, theirs = (
        float(one("speed_vs_error/slide.csv", **engine)["slide_median_cm"])
        for engine in (OURS, OURS | {"setting": "moreau / block-pivoting / r0"}, RAPIER)
    )
    schemes = ("leapfrog / r0", "moreau / r0")
    hit = [one("speed_vs_error/impact.csv", scheme=each)["dt = 0.01 s"] for each in schemes]
    return (
        f"A step of 0.01 s with 27 boats jammed in `narrow` takes {float(step['us_per_step']):.1f} "
        f"µs on one core. The physics engine rapier needs {float(step['faster']):.1f} times as "
        f"long. A boat that slides along the wall for 2 s is then off by {ours:.2g} cm with the "
        f"default scheme, by {first_order:.2g} cm with the first-order `moreau`, and by "
        f"{theirs:.2g} cm in rapier. If it hits the wall on the way, the default is off by "
        f"{hit[0]} cm, and `moreau` by {hit[1]} cm ([speed against error](docs/speed_vs_error.md))."
    )


def lost(study: str, reading: str, quantity: str) -> str:
    """Return at which backward duration order is lost, in s."""
    row = one(f"{STUDIES}/{study}/claims.csv", reading=reading, quantity=quantity)
    return f"{float(row['measured']):.2f}"


def mean_at(file: str, column: str, bw_s: str, **known: str) -> float:
    """Return a mean over the runs of a study at a noise."""
    return fmean(
        float(row[column]) for row in rows(f"{STUDIES}/section4/results/{file}", bw_s=bw_s, **known)
    )


FREE = {"preset": "experiment", "n_leaders": "0", "minutes": "8.0"}
"""27 boats without leaders."""


def rises(n_boats: str) -> list[float]:
    """Return by how much noise raises mean |m|, in each reading of Section 5 in `wide`."""
    wanted = {"pool": "wide", "n_leaders": "0", "n_boats": n_boats}
    found: dict[tuple[str, ...], dict[str, list[float]]] = {}
    for row in rows(f"{STUDIES}/section5/results/section5.csv", **wanted):
        key = tuple(row[name] for name in READING)
        found.setdefault(key, {}).setdefault(row["bw_s"], []).append(float(row["abs_m"]))
    means = [{bw_s: fmean(runs) for bw_s, runs in each.items()} for each in found.values()]
    return [max(each.values()) - each["0.0"] for each in means if len(each) > 4]


def needs(n_boats: str) -> str:
    """Return in how many readings noise raises mean |m| by at least 0.3."""
    found = rises(n_boats)
    return f"{sum(each >= LEAST_RISE for each in found)} of {len(found)}"


def with_current(constants: str, current: str) -> list[str]:
    """Return at which backward durations order is lost without leaders and with three, in s."""
    reading = f"{constants} constants, narrow, n = 27"
    return [lost("current", reading, f"critical bw (s), {current}, k = {k}") for k in (0, 3)]


def finding(headline: str, words: str, picture: str, shown: str) -> str:
    """Return a finding with its picture, which is small and leads to the large one."""
    file = f"studies/{picture}.png"
    image = f'<img src="{file}" alt="{shown}" width="440">'
    return f"**{headline}** {words}\n\n[{image}]({file})"


def density() -> str:
    """Return in which flocks noise makes motion."""
    quiet, moving, gone = (
        mean_at("section4.csv", "abs_m", bw_s=bw_s, **FREE) for bw_s in ("0.0", "1.0", "2.8")
    )
    return finding(
        "Dense flocks need noise to move, sparse ones do not.",
        "The rotation is 1 if all boats circle one way. In `wide`, noise raises it for 50 boats "
        f"by {LEAST_RISE} or more in {needs('50')} variants of the model, and for 20 boats in "
        f"{needs('20')}: most of these rotate without noise (24 runs of 30 minutes, no leaders). "
        "With the default preset, dense flocks hardly rotate at any noise. With `experiment`, "
        f"fitted to jams at low noise, 27 boats in `narrow` reach {quiet:.2f} without noise, "
        f"{moving:.2f} at bw = 1.0 s and {gone:.2f} at 2.8 s.",
        "density/pictures/density",
        "Rise of the rotation by noise, against density",
    )


def overlap() -> str:
    """Return at which noise the readings of the paper lose their order."""
    readings = ("simulation", "paper, 0.1 cm", "paper, 0.001 cm")
    white, early, late = (
        lost("section5", f"{reading}, n = 20", "critical bw (s), k = 0") for reading in readings
    )
    return finding(
        "When order is lost depends on choices that the paper leaves open.",
        f"20 boats in `wide` lose it at bw = {white} s with white "
        "noise and the default scheme. With noise and steps taken literally it is "
        f"{early} to {late} s: "
        "the less overlap a step tolerates, the later. The paper has 0.6 to 0.8 s (24 runs at each "
        "noise, no leaders).",
        "section5/pictures/readings",
        "When each variant of the model loses its order",
    )


def currents() -> str:
    """Return what the current that the paper measured changes."""
    own, strong = (with_current("preset", f"{which} current") for which in ("preset's", "measured"))
    return finding(
        "The current that the paper measured makes a flock lose its order earlier.",
        f"27 boats of `experiment` in `narrow` lose it at {own[0]} s, and with the measured "
        f"current at {strong[0]} s (paper: 1.4 s). With three leaders it is {own[1]} and "
        f"{strong[1]} s (paper: 2.0 s; 24 runs at each noise).",
        "current/pictures/current",
        "Order against noise with both currents",
    )


def findings() -> str:
    """Return three answers to the paper, each with its picture."""
    return "\n\n".join([density(), overlap(), currents()])


FIGURES = {
    "states": ("4 to 6, Table 2", "section4/pictures/table2"),
    "fig07": ("7", "section4/pictures/fig07"),
    "fig08": ("8", "section4/pictures/fig08"),
    "fig09": ("9", "section4/pictures/fig09"),
    "fig10": ("10", "section4/pictures/fig10"),
    "fig11": ("11", "section4/pictures/fig11"),
    "fig12": ("12", "section4/pictures/fig12"),
    "noise_makes_motion": ("summary", "density/pictures/noise_makes_motion"),
    "fig14": ("14", "section5/pictures/fig14_paper"),
    "fig15": ("15", "section5/pictures/fig15"),
    "fig16": ("16", "section5/pictures/fig16"),
    "fig17": ("17", "section5/pictures/fig17"),
}
"""The paper's figures by the name of their claims: number and picture."""


def figures() -> str:
    """Return how many statements of each figure hold, fail and are open."""
    body, total = [], [0] * len(VERDICTS)
    for name, (number, picture) in FIGURES.items():
        claims = rows(f"{STUDIES}/{picture.partition('/')[0]}/claims.csv", figure=name)
        found = [sum(row["verdict"] == each for row in claims) for each in VERDICTS]
        total = [before + each for before, each in zip(total, found, strict=True)]
        body.append([f"[{number}]({picture}.png)", *map(str, found)])
    body.append(["all", *map(str, total)])
    return markdown(["figure", *VERDICTS], body)


def variants() -> str:
    """Return in how many variants the headlines hold, for its page."""
    found = [row["verdict"] for row in rows(f"{STUDIES}/headlines/claims.csv", figure="headlines")]
    held, failed, free = (found.count(each) for each in VERDICTS)
    end = f"{failed} fail" if failed else "none fails"
    return f"**Mostly: {held} of {len(found)} answers hold, {free} are open, and {end}.**"
