"""Take the mean of leaning laws that several searches have found.

    python baselines/average_policies.py results/evolution/wide/policy.npz \
        results/evolution/wide-1/policy.npz --pool wide \
        --out results/evolution/wide-mean.npz

Searches of the same form from the same initial law end around the same law, and each differs from
it by the noise of its own episodes. Their mean may differ less. The search moves logarithms of
gains, so the mean gain is the geometric one. The mean's `provenance` holds that of each part.
With --pool, all laws and the tuned damped law lead in training episodes that no search uses; these
decide whether the mean is distributed, before it is run on the seeds of a comparison.
"""

import argparse
import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np
from script_end import one_line_end

import flockenv
from flockenv._io.provenance import provenance_of
from flockenv.comparison import run_episodes
from flockenv.policies import LeaningLaw, load
from flockenv.policies.leaning_law import GAINS
from flockenv.policies.pretrained import tuned_law
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.statistics.intervals import mean_interval

#: Provenance of each part.
LISTED = ("command", "commit", "seed", "samples", "wall_s")


def total(laws: list[LeaningLaw], name: str) -> int:
    """Return the sum of a number over the parts that have it."""
    return sum(int(law.provenance.get(name, "0")) for law in laws)


def average(laws: list[LeaningLaw], command: str) -> LeaningLaw:
    """Return the mean law."""
    first = laws[0]
    if any(law.observation != first.observation for law in laws):
        raise flockenv.ParameterError("the laws have different observations")
    if any(law.hidden for law in laws):
        raise flockenv.ParameterError("laws with hidden units have no mean: theirs have no order")
    names = tuple(dict.fromkeys(name for law in laws for name in law.features))
    logs = np.log([[law.gains[name] for name in GAINS] for law in laws])
    weights = np.mean([[law.weights.get(name, 0.0) for name in names] for law in laws], axis=0)
    parts = {
        f"part {number}: {name}": law.provenance.get(name, "unknown")
        for number, law in enumerate(laws)
        for name in LISTED
    }
    provenance = provenance_of(
        command, seed=0, samples=total(laws, "samples"), wall_s=total(laws, "wall_s")
    )
    provenance["seed"] = ", ".join(law.provenance.get("seed", "unknown") for law in laws)
    return LeaningLaw(
        dict(zip(GAINS, np.exp(logs.mean(axis=0)).tolist(), strict=True)),
        float(np.mean([law.bias for law in laws])),
        dict(zip(names, weights.tolist(), strict=True)),
        observation=first.observation,
        provenance={**provenance, **parts},
    )


def validate(laws: dict[str, Any], options: argparse.Namespace) -> None:
    """Print the mean signed order of each law: three leaders among 27 boats, critical noise."""
    parameters = flockenv.FlockParameters.preset("simulation").replace(
        pool=options.pool,
        n_boats=27,
        n_leaders=3,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", options.pool),
    )
    seeds = POLICY_SEEDS["averaging"].seeds(options.episodes)
    for name, law in laws.items():
        orders = run_episodes(parameters, law, seeds, 60.0 * options.minutes)["signed_order"]
        value, low, high = mean_interval(orders)
        print(f"{name}: signed order {value:.3f} [{low:.3f}, {high:.3f}]", flush=True)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("policies", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, default=Path("results/evolution/mean.npz"))
    parser.add_argument("--pool", choices=("wide", "narrow"), help="where to validate")
    parser.add_argument("--episodes", type=int, default=512, help="of the validation")
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    options = parser.parse_args(arguments)
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/average_policies.py", *given])
    with one_line_end(lambda: "nothing was written"):
        laws = []
        for path in options.policies:
            law = load(path)
            if not isinstance(law, LeaningLaw):
                raise flockenv.ParameterError(f"{path} is a {law!r}, not a leaning law")
            laws.append(law)
        mean = average(laws, command)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        mean.save(options.out)
        if options.pool:
            named = {str(path): law for path, law in zip(options.policies, laws, strict=True)}
            tuned = tuned_law("damped law", options.pool)
            validate({**named, "their mean": mean, "tuned damped law": tuned}, options)
    print(f"{mean!r}\nwritten to {options.out}")


if __name__ == "__main__":
    main()
