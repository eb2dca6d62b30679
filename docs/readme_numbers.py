"""What the README says of speed, error and the paper's answers, from committed data."""

from statistics import fmean

from committed_data import one, rows

CLAIMS = "../paper/claims.csv"
OURS = {"engine": "flockenv", "setting": "leapfrog / block-pivoting / r0", "dt_s": "0.01"}
RAPIER = {"engine": "rapier2d-f64", "setting": "4 iterations / unit 10 cm", "dt_s": "0.01"}


def speed() -> str:
    """Return the speed and the error of a step beside those of rapier."""
    step = one("speed_vs_error/speed.csv", scene="jam", n="27", **OURS)
    ours, theirs = (
        float(one("speed_vs_error/slide.csv", **engine)["slide_median_cm"])
        for engine in (OURS, RAPIER)
    )
    return (
        "A step of 0.01 s (the default is 0.02 s) with 27 boats jammed in `narrow` takes "
        f"{float(step['us_per_step']):.1f} µs on one core; the physics engine rapier takes "
        f"{float(step['faster']):.1f} times as long, and has {theirs / ours:.0f} times the error "
        "for a boat that slides along the wall ([speed against error](docs/speed_vs_error.md))."
    )


def lost(reading: str, quantity: str) -> str:
    """Return at which backward duration order is lost, in s."""
    return f"{float(one(CLAIMS, reading=reading, quantity=quantity)['measured']):.2f}"


def at(bw_s: str, name: str) -> float:
    """Return a mean over the runs of 27 boats without leaders, preset experiment."""
    known = {"preset": "experiment", "n_leaders": "0", "minutes": "8.0"}
    return fmean(
        float(row[name]) for row in rows("../paper/results/section4.csv", bw_s=bw_s, **known)
    )


def findings() -> str:
    """Return which of the paper's answers hold."""
    boats, water = "critical bw (s), k = 0", "experiment (leapfrog, white), narrow, n = 27"
    fit = rows(CLAIMS, quantity="critical bw (s), best candidate, held-out seeds")
    alone, led = (f"{float(row['measured']):.2f}" for row in fit)
    return (
        "- **Noise makes motion.** At bw = 0, 27 boats are jammed in "
        f"{100 * at('0.0', 'jammed'):.0f} % of the frames, with a mean rotation |m| of "
        f"{at('0.0', 'abs_m'):.2f}. At 1.0 s |m| is {at('1.0', 'abs_m'):.2f} with hardly a jam, "
        f"and at 2.8 s it is {at('2.8', 'abs_m'):.2f}: the order is gone (24 runs of 8 minutes "
        "per level without leaders, preset `experiment`, pool `narrow`, white noise).\n"
        "- **The noise at which order is lost depends on choices that the paper leaves open.** "
        f"In `wide` 20 boats without leaders lose it at {lost('simulation, n = 20', boats)} s "
        "with white noise and the default integrator. With noise and steps as the paper prints "
        f"them it is {lost('paper, 0.1 cm, n = 20', boats)} to "
        f"{lost('paper, 0.001 cm, n = 20', boats)} s, depending on how much overlap of boats a "
        "step tolerates, which the paper does not give (24 runs of 30 minutes per level). The "
        "paper has 0.6 to 0.8 s.\n"
        "- **What leaders add depends on the water.** Three of them hardly move the loss of "
        "order with the preset `experiment`, whose boats back up more slowly "
        f"({lost(water, 'critical bw (s), no leaders')} to "
        f"{lost(water, 'critical bw (s), 3 leaders, CW')} s), and move it from {alone} to {led} s "
        "with the current that the paper measured (`narrow`, white noise, 24 runs at each of 15 "
        "noises). The paper has 1.4 s and 2.0 s."
    )
