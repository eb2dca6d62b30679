"""What the README says of speed, error and the paper's answers, from committed data."""

from statistics import fmean

from committed_data import markdown, one, rows

VERDICTS = ("holds", "fails", "open")
RESULTS = "../paper/results"
CLAIMS = "../paper/claims.csv"
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
        "A step of 0.01 s (the default is 0.02 s) with 27 boats jammed in `narrow` takes "
        f"{float(step['us_per_step']):.1f} µs on one core; the physics engine rapier takes "
        f"{float(step['faster']):.1f} times as long. A boat that slides along the wall for 2 s is "
        f"{ours:.2g} cm off with the default scheme, which is second order while a contact lasts, "
        f"{first_order:.2g} cm with `moreau`, which is first order, and {theirs:.2g} cm with "
        "rapier, to which the motors are forces of first order. If the boat hits the wall within "
        f"these 2 s, the time of the impact sets the error: {hit[0]} and {hit[1]} cm "
        "([speed against error](docs/speed_vs_error.md))."
    )


def lost(reading: str, quantity: str) -> str:
    """Return at which backward duration order is lost, in s."""
    return f"{float(one(CLAIMS, reading=reading, quantity=quantity)['measured']):.2f}"


def mean_at(file: str, column: str, bw_s: str, **known: str) -> float:
    """Return a mean over the runs of a study at a noise."""
    return fmean(float(row[column]) for row in rows(f"{RESULTS}/{file}", bw_s=bw_s, **known))


FREE = {"preset": "experiment", "n_leaders": "0", "minutes": "8.0"}
"""27 boats without leaders."""


def rises(n_boats: str) -> list[float]:
    """Return by how much noise raises mean |m|, in each reading of Section 5 in `wide`."""
    wanted = {"pool": "wide", "n_leaders": "0", "n_boats": n_boats}
    found: dict[tuple[str, ...], dict[str, list[float]]] = {}
    for row in rows(f"{RESULTS}/section5.csv", **wanted):
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
    return [lost(reading, f"critical bw (s), {current}, k = {k}") for k in (0, 3)]


def findings() -> str:
    """Return which of the paper's answers hold."""
    boats = "critical bw (s), k = 0"
    own, strong = (with_current("preset", f"{which} current") for which in ("preset's", "measured"))
    again = with_current("fitted", "measured current")
    fit = rows(CLAIMS, quantity="critical bw (s), best candidate, held-out seeds")
    alone, led = (f"{float(row['measured']):.2f}" for row in fit)
    levels = ("0.0", "1.0", "2.8")
    quiet, moving, gone = (mean_at("section4.csv", "abs_m", bw_s, **FREE) for bw_s in levels)
    jammed = mean_at("section4.csv", "jammed", "0.0", **FREE)
    return (
        "- **Sparse flocks rotate without noise, dense ones need it to move.** In `wide` noise "
        f"raises the mean rotation |m| by at least {LEAST_RISE} in {needs('50')} readings of the "
        f"model with 50 boats, and in {needs('20')} with 20 boats, most of which rotate without "
        "any (24 runs of 30 minutes per level without leaders). With the default preset "
        "`simulation` dense flocks hardly rotate at any noise. In `narrow`, 27 boats of the preset "
        f"`experiment`, whose fit had jams at low noise among its targets, are jammed in "
        f"{100 * jammed:.0f} % of the frames at bw = 0, with an |m| of {quiet:.2f}; at 1.0 s it is "
        f"{moving:.2f}, and at 2.8 s {gone:.2f} (24 runs of 8 minutes, white noise).\n"
        "- **The noise at which order is lost depends on choices that the paper leaves open.** "
        f"In `wide` 20 boats without leaders lose it at {lost('simulation, n = 20', boats)} s "
        "with white noise and the default integrator. With noise and steps as the paper prints "
        f"them it is {lost('paper, 0.1 cm, n = 20', boats)} to "
        f"{lost('paper, 0.001 cm, n = 20', boats)} s, depending on how much overlap of boats a "
        "step tolerates, which the paper does not give (24 runs of 30 minutes per level). The "
        "paper has 0.6 to 0.8 s.\n"
        "- **The measured current alone makes a flock lose its order earlier, away from the "
        f"paper.** 27 boats of `experiment` in `narrow` lose it at {own[0]} s without leaders and "
        f"at {own[1]} s with three. With the current that the paper measured in place of the "
        f"preset's they lose it at {strong[0]} and {strong[1]} s; the paper has 1.4 and 2.0 s "
        "(white noise, 24 runs at each of 15 noises). What leaders add with constants fitted "
        f"around that current is open: {alone} to {led} s in the runs that judged the fit, "
        f"{again[0]} to {again[1]} s with other seeds."
    )


FIGURES = {
    "states": ("4 to 6, Table 2", "table2"),
    "fig07": ("7", "fig07"),
    "fig08": ("8", "fig08"),
    "fig09": ("9", "fig09"),
    "fig10": ("10", "fig10"),
    "fig11": ("11", "fig11"),
    "fig12": ("12", "fig12"),
    "noise_makes_motion": ("summary", "noise_makes_motion"),
    "fig14": ("14", "fig14_paper"),
    "fig15": ("15", "fig15"),
    "fig16": ("16", "fig16"),
    "fig17": ("17", "fig17"),
}
"""The paper's figures by the name of their claims: number and picture."""


def figures() -> str:
    """Return how many statements of each figure hold, fail and are open, and which fail."""
    body = []
    for name, (number, picture) in FIGURES.items():
        claims = rows(CLAIMS, figure=name)
        found = [[row for row in claims if row["verdict"] == v] for v in VERDICTS]
        failed = dict.fromkeys(row["claim"] for row in found[1])
        cells = [str(len(each)) for each in found]
        body.append([f"[{number}](pictures/{picture}.png)", *cells, "; ".join(failed)])
    return markdown(["figure", *VERDICTS, "what fails in a reading"], body)
