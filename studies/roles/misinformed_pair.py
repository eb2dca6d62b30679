"""Two roles, written by hand, for the task `misinformed` of suite v2.

    python -m studies.roles.misinformed_pair    # a minute of one core

The pair has an order of 0.330 in the task's 256 flocks, and two leaders by the tuned law have none.

Two leaders get opposite directions, and only that of leader 0 counts. With one policy for both
leaders the flock follows either of them as often, and the mean signed order is 0: exchanging the
leaders together with their directions changes only the sign of the order. Here leader 0
follows the tuned law, and leader 1 follows it against the direction that it gets.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flockenv.comparison import ComparisonReport
from flockenv.comparison.suite import REFERENCE, tasks_named
from flockenv.envs.observation import observation_entries
from flockenv.policies import policy

_TOLD = [place for place, each in enumerate(observation_entries()) if each.block == "target"]


(TASK,) = tasks_named("v2", ["misinformed"])


class Signed:
    """A law towards its target (1), or against it (-1)."""

    def __init__(self, law: Any, sign: float) -> None:
        self.law, self.sign = law, sign

    def predict(
        self, observation: ArrayLike, state: Any = None, episode_start: Any = None
    ) -> tuple[Any, Any]:
        """Return the law's rudders."""
        seen = np.array(observation, np.float32)
        seen[..., _TOLD] *= self.sign
        return self.law.predict(seen, state, episode_start)

    def __repr__(self) -> str:
        return f"Signed({self.law!r}, {self.sign:g})"


def main() -> None:
    """Print the order with the pair, and with the tuned law for both leaders."""
    law = policy(REFERENCE, TASK.parameters.pool)
    policies = {
        "pair": {"leader_0": law, "leader_1": Signed(law, -1.0)},
        REFERENCE: law,
    }
    result = ComparisonReport([TASK], list(policies), TASK.run(policies))
    for row in result.means.to_dict("records"):
        ends = f"[{row['signed_order_low']:.3f}, {row['signed_order_high']:.3f}]"
        print(f"{row['policy']}: {row['signed_order']:.3f} {ends} in {row['runs']} episodes")
    print(result.in_words())


if __name__ == "__main__":
    main()
