"""Compare your own policy with the laws: `python examples/compare_policies.py FLOCKS MINUTES`."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from flockenv import FlockParameters
from flockenv.comparison import NO_LEADERS, compare_leaders
from flockenv.policies import SteeringLaw
from flockenv.statistics import summarize

# Arguments that are left out are 16 and 4.
flocks, minutes = map(int, sys.argv[1:] + ["16", "4"][len(sys.argv) - 1 :])
out = Path("results/compare_policies")
out.mkdir(parents=True, exist_ok=True)


class Gentle:
    """The paper's law with at most half of the rudder."""

    def __init__(self) -> None:
        self._law = SteeringLaw()

    def predict(self, observation, state=None, episode_start=None, deterministic=True):
        """Return rudders in [-1, 1], one per leader, as stable-baselines3's policies do."""
        rudder, state = self._law.predict(observation, state)
        return np.clip(rudder, -0.5, 0.5), state


parameters = FlockParameters(pool="wide", n_boats=27, bw_s=0.31)
policies = {"gentle": Gentle(), "paper's law": "paper's law", "tuned law": "tuned law"}
runs = compare_leaders(parameters, [0, 1, 3], policies, range(flocks), 60.0 * minutes)
runs.to_csv(out / "runs.csv", index=False)
means = summarize(runs, ["policy", "leaders"], ["signed_order"])  # with 95 % intervals
print(means.round(3).to_string(index=False))

for index, name in enumerate(policies):
    curve = means[means["policy"].isin([NO_LEADERS, name])]  # one flock without leaders for all
    order = curve["signed_order"]
    ends = [order - curve["signed_order_low"], curve["signed_order_high"] - order]
    plt.errorbar(curve["leaders"] + 0.05 * index, order, ends, marker="o", capsize=3, label=name)
plt.xticks(means["leaders"].unique())
plt.xlabel("leaders among 27 boats")
plt.ylabel(f"signed order, 95 % intervals of {flocks} flocks")
plt.legend()
plt.savefig(out / "leader_curve.png")
