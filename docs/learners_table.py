"""The table of docs/learners_throughput.md, from docs/learners_throughput.toml."""

import tomllib
from pathlib import Path

from committed_data import markdown

DATA = Path(__file__).parent / "learners_throughput.toml"
LEARNERS = {
    "batch": "the batch itself",
    "vector": "`LeadersVectorEnv`, in the file of PPO",
    "sb3": "`flockenv.sb3.LeaderVecEnv`",
    "torchrl": "TorchRL, `LeadersEnv` without a state",
    "torchrl features": "TorchRL, `LeadersEnv` with features of the flock",
    "torchrl boats": "TorchRL, `LeadersEnv` with the global state",
    "torchrl GymWrapper": "TorchRL, `GymWrapper` on `LeadersVectorEnv`",
    "benchmarl": "BenchMARL, with features of the flock and sums of rewards",
    "rllib native": "RLlib, `LeadersVectorEnv`",
    "rllib sync": "RLlib, single flocks in a loop",
    "rllib agents": "RLlib, leaders as agents of single flocks in a loop",
}


def learners() -> str:
    """Return the samples per second of the learners' interfaces beside the batch."""
    with DATA.open("rb") as file:
        found = tomllib.load(file)
    provenance = found["made"]
    body = [
        [
            name,
            f"{found[row]['median']:,.0f}",
            f"{found[row]['least']:,.0f} to {found[row]['most']:,.0f}",
            f"{found[row]['ratio']:.3f}",
            f"{found[row]['ratio_least']:.3f} to {found[row]['ratio_most']:.3f}",
        ]
        for row, name in LEARNERS.items()
    ]
    header = ["interface", "samples/s", "range", "of the batch", "range"]
    measured = (
        f"`make learners-throughput` measured this on {provenance['date']}: "
        f"{provenance['machine']}; {provenance['libraries']}; load average at the end "
        f"{provenance['load']:.1f}. Every number is the median of {provenance['rounds']} processes "
        f"of {provenance['seconds']:g} s each, which took turns."
    )
    return f"{markdown(header, body)}\n\n{measured}"
