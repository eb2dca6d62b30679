"""What the README and docs/leaders.md say of leaders in words, from committed data."""

import numpy as np
from committed_data import MEANS, Row, one, rows

from flockenv.statistics import student_interval

CASES = {"wide": "wide-bw-0.31", "narrow": "narrow-bw-0.45"}
"""The comparisons of each pool, at the noise that the pages show."""
CLOSE_MEANS, CLOSE = "leaders/close_means.csv", "leaders/close_differences.csv"
TUNED, LEARNED, PAPERS = "tuned law", "learned", "paper's law"


def compared(row: Row) -> str:
    """Return how learned leaders lead in comparison with the tuned law, by a paired difference."""
    mean, low, high = (float(row[name]) for name in ("mean", "low", "high"))
    if low > 0.0 or high < 0.0:
        return f"{'better' if low > 0.0 else 'worse'} than the tuned law, by {abs(mean):.2f}"
    return f"about as well as the tuned law, within {max(-low, high):.3f}"


def order(policy: str, pool: str) -> str:
    """Return the mean signed order of three leaders, of the 2048 flocks where those were led."""
    file = CLOSE_MEANS if pool == "wide" and policy in (LEARNED, TUNED) else MEANS
    row = one(file, case=CASES[pool], policy=policy, leaders="3")
    return f"{float(row['signed_order']):.2f}"


def _wide(leaders: str = "3") -> Row:
    return one(CLOSE, case=CASES["wide"], policy=LEARNED, leaders=leaders)


def _recipe() -> str:
    """Return what the trainings of `make pretrained` gain on the tuned law with three leaders."""
    found = one("training/pretrained/algorithms.csv", algorithm="seed")
    mean, low, high = (float(found[name]) for name in ("gain", "gain_low", "gain_high"))
    gain = f"gain {mean:.2f} on the tuned law in the mean ({low:.2f} to {high:.2f})"
    return f"{found['seeds']} trainings {gain}"


def verdict() -> str:
    """Return how learned leaders compare with the tuned law, for the README."""
    wide = _wide()
    return (
        f"With three leaders, {_recipe()}. The one that ships, chosen in other flocks, leads "
        f"{compared(wide)} ({order(LEARNED, 'wide')} against {order(TUNED, 'wide')}, {wide['n']} "
        "episodes). In the pool `narrow` no leaders have learned to lead better than it "
        "([leaders](docs/leaders.md))."
    )


def summary() -> str:
    """Return what docs/leaders.md begins with."""
    wide, single = _wide(), _wide("1")
    return (
        f"In the pool `wide`, with three leaders among 27 boats, {_recipe()}. The one that ships, "
        f"chosen in other flocks, reaches a signed order of {order(LEARNED, 'wide')}. It leads "
        f"{compared(wide)}, and with a single leader {compared(single)} (bw = 0.31 s, {wide['n']} "
        f"episodes each). The paper's own law, eq. (10), reaches {order(PAPERS, 'wide')}. In the "
        "pool `narrow` (bw = 0.45 s) no leaders have learned to lead better than the tuned law: "
        f"it reaches {order(TUNED, 'narrow')}, and the paper's law {order(PAPERS, 'narrow')}."
    )


def planned(noise: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the signed orders of the learned leaders and of a planner, in the same episodes."""
    found = rows(f"leaders/plan_{noise}.csv")
    learned, plan = ([float(row[name]) for row in found] for name in ("learned", "planned"))
    return np.array(learned), np.array(plan)


def plans() -> str:
    """Return what planning ahead adds to the learned leaders."""
    (learned, known), (_, fresh) = planned("known"), planned("fresh")
    mean, low, high = student_interval(fresh - learned)
    return (
        f"**A planner that knows the noise reaches a signed order of {known.mean():.2f}, and the "
        f"learned leaders {learned.mean():.2f}. A planner that does not know it reaches "
        f"{fresh.mean():.2f}: a difference of {mean:+.2f} ± {(high - low) / 2:.2f}.**"
    ).replace("-", "−")
