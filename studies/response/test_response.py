"""Law: responses of groups add up with their signs, and a factor is per leader."""

import numpy as np
import pandas as pd
import pytest


def table(script, responses: dict, group=None, spread: float = 0.01) -> pd.DataFrame:
    """Runs of a group with these means of m in the last window; a cell may have fewer seeds."""
    group, random = group or script.MAIN, np.random.default_rng(0)
    flock = {"n_boats": group.n_boats, "bw_s": group.bw_s, "dt_s": group.dt_s}
    rows = []
    for cell, (mean, seeds) in responses.items():
        luck = random.normal(size=seeds)
        luck -= luck.mean()
        rows += [
            flock | cell._asdict() | {"seed": seed, "m_4": mean + spread * luck[seed]}
            for seed in range(seeds)
        ]
    return pd.DataFrame(rows)


@pytest.mark.parametrize("unlike", [0.0, 0.03])
def test_opposed_groups_are_compared_with_the_difference_of_their_responses(script, unlike) -> None:
    cell, law = script.Cell, script.LAW
    responses = {cell(law, 1): 0.07, cell(law, 3): 0.2, cell(law, 3, 1): 0.13 + unlike}
    found = table(script, {each: (mean, 20) for each, mean in responses.items()})
    rest = script.rest(found, script.MAIN, law, 3, "m_4")
    assert rest[0] == pytest.approx(unlike / 0.07)
    assert rest[1] < rest[0] < rest[2]


def test_seeds_that_a_cell_lacks_do_not_count(script) -> None:
    cell, law = script.Cell, script.LAW
    found = table(script, {cell(law, 1): (0.05, 40), cell(law, 2): (0.12, 20)})
    assert script.linear(found, script.MAIN, law, 2, "m_4")[0] == pytest.approx(1.2)
    assert np.isnan(script.linear(found, script.MAIN, law, 3, "m_4")).all()


def test_a_factor_is_per_leader(script) -> None:
    """As many leaders in 27 boats as in 400 would move twice as much per fluctuation."""
    cell, law, large = script.Cell, script.LAW, script.SIZES[1]
    small = table(script, {cell(law, 3): (0.3, 20), script.FREE: (0.05, 20)})
    other = table(script, {cell(law, 15): (0.3, 20), script.FREE: (0.005, 20)}, large, 1e-4)
    assert script.factor(small, script.MAIN, "m_4")[0] == pytest.approx(0.3 / 3 / 0.05)
    found = script.factors(pd.concat([small, other]), large, "m_4", "m_4")
    assert found[0] == pytest.approx((0.3 / 15 / 0.005) / (0.3 / 3 / 0.05))
