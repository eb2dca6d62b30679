"""Compare your own policy with the laws: `python examples/compare_policies.py FLOCKS MINUTES`."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders
from flockenv.policies import SteeringLaw

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
means = runs.groupby(["policy", "leaders"])["signed_order"].agg(["mean", "sem"])
print(means.round(3))

for name in policies:
    curve = means.loc[name]
    plt.errorbar(curve.index, curve["mean"], curve["sem"], marker="o", label=name)
plt.xlabel("leaders among 27 boats")
plt.ylabel("signed order")
plt.legend()
plt.savefig(out / "leader_curve.png")
