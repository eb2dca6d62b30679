"""Make one leaning law of several: the mean of what searches from several seeds found.

    python baselines/average_policies.py results/evolution/500-boats/policy.npz \
        results/evolution/500-boats-1/policy.npz --out results/evolution/500-boats-mean.npz

Searches of the same form from the same beginning end around the same law, each off by the noise of
its own episodes; their mean is less far off. The search moves logarithms of gains, so the mean gain
is the geometric one. How each part was made is told in the mean's `made`.
"""

import argparse
import shlex
import sys
from pathlib import Path

import numpy as np

import flockenv
from flockenv.policies import LeaningLaw, load
from flockenv.policies.leaning_law import FEATURES, GAINS
from flockenv.provenance import made_by

#: What is told of each part.
TOLD = ("command", "commit", "seed", "samples", "wall_s")


def total(laws: list[LeaningLaw], name: str) -> int:
    """The sum of a number that every part tells; parts that do not tell it count nothing."""
    return sum(int(law.made.get(name, "0")) for law in laws)


def average(laws: list[LeaningLaw], command: str) -> LeaningLaw:
    """Return the mean law."""
    first = laws[0]
    if any(law.observation != first.observation for law in laws):
        raise flockenv.ParameterError("the laws look at different observations")
    logs = np.log([[law.gains[name] for name in GAINS] for law in laws])
    weights = np.mean([[law.weights.get(name, 0.0) for name in FEATURES] for law in laws], axis=0)
    parts = {
        f"part {number}: {name}": law.made.get(name, "unknown")
        for number, law in enumerate(laws)
        for name in TOLD
    }
    made = made_by(command, seed=0, samples=total(laws, "samples"), wall_s=total(laws, "wall_s"))
    made["seed"] = ", ".join(law.made.get("seed", "unknown") for law in laws)
    return LeaningLaw(
        dict(zip(GAINS, np.exp(logs.mean(axis=0)).tolist(), strict=True)),
        float(np.mean([law.bias for law in laws])),
        dict(zip(FEATURES, weights.tolist(), strict=True)),
        observation=first.observation,
        made={**made, **parts},
    )


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("policies", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, default=Path("results/evolution/mean.npz"))
    options = parser.parse_args(arguments)
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/average_policies.py", *given])
    try:
        laws = []
        for path in options.policies:
            law = load(path)
            if not isinstance(law, LeaningLaw):
                raise flockenv.ParameterError(f"{path} is a {law!r}, not a leaning law")
            laws.append(law)
        mean = average(laws, command)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        mean.save(options.out)
    except (flockenv.FlockError, OSError) as error:
        sys.exit(f"Error: {error}")
    print(f"{mean!r}\nwritten to {options.out}")


if __name__ == "__main__":
    main()
