"""What ships: laws with tuned gains and learned leaders for the named pools."""

import numpy as np
import pytest

import flockenv
from flockenv.comparison import POOL_POLICIES, named_policy, run_episodes
from flockenv.policies import SteeringLaw
from flockenv.policies.pretrained import TUNED_GAINS, learned, tuned_law

POOLS = ("wide", "narrow")


@pytest.mark.parametrize("pool", POOLS)
def test_every_one_is_there_for_every_pool(pool: str) -> None:
    for law, gains in TUNED_GAINS.items():
        assert tuned_law(law, pool).gains == gains[pool]
    provenance = learned(pool).provenance
    assert {"command", "seed", "commit", "samples", "wall_s"} <= provenance.keys()
    assert "baselines/" in provenance["command"]
    for name in POOL_POLICIES:
        assert repr(named_policy(name, pool)()) == repr(POOL_POLICIES[name](pool))


@pytest.mark.parametrize("pool", ["500 boats", (90.0, 48.5), None])
def test_other_pools_have_none(pool) -> None:
    for name in POOL_POLICIES:
        with pytest.raises(flockenv.ParameterError, match="wide, narrow"):
            named_policy(name, pool)


@pytest.mark.parametrize("pool", POOLS)
def test_learned_leaders_lead_better_than_the_papers(pool: str) -> None:
    """By more than twice in `narrow` and half as much again in `wide`, where measured."""
    parameters = flockenv.FlockParameters(
        n_boats=27,
        n_leaders=3,
        pool=pool,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", pool),
    )
    seeds = range(32)
    ours, papers = (
        run_episodes(parameters, policy, seeds, 240.0)["signed_order"]
        for policy in (learned(pool), SteeringLaw())
    )
    difference = ours - papers
    assert difference.mean() > 3 * difference.std(ddof=1) / np.sqrt(len(seeds))
