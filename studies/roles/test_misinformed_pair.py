"""Law: a signed law follows its target, or steers as if it had been told the opposite."""

import numpy as np

import flockenv
from flockenv.policies import DampedLaw


def test_against_a_target_is_towards_the_other(script) -> None:
    law = DampedLaw.tuned("wide")
    told = {}
    for target in ("cw", "ccw"):
        env = flockenv.LeadersEnv(n_leaders=2, pool="wide", target=target)
        told[target], _ = env.reset(seed=3)
    towards, against = script.Signed(law, 1.0), script.Signed(law, -1.0)
    for one, other in (("cw", "ccw"), ("ccw", "cw")):
        ours = against.predict(told[one].reshape(2, -1))[0]
        np.testing.assert_allclose(ours, law.predict(told[other].reshape(2, -1))[0], atol=1e-6)
    rows = told["cw"].reshape(2, -1)
    np.testing.assert_array_equal(towards.predict(rows)[0], law.predict(rows)[0])
    assert np.abs(towards.predict(rows)[0] - against.predict(rows)[0]).max() > 0.01
