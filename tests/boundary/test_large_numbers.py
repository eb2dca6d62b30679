"""Law: whole numbers of thousands of digits, which Python itself cannot print, are named errors."""

import pytest

import flockenv
from flockenv import FlockParameters, ParameterError
from flockenv.errors import shown
from flockenv.policies import SteeringLaw
from flockenv.runs.seeds import POLICY_SEEDS, check_evaluation_seeds

HUGE = 10**5000
SMALL = FlockParameters(n_boats=4, n_leaders=1)


@pytest.mark.parametrize(
    "use",
    [
        lambda: flockenv.Flock(SMALL, HUGE),
        lambda: flockenv.simulate(SMALL, HUGE, 1.0),
        lambda: flockenv.simulate(SMALL, 1, HUGE),
        lambda: flockenv.simulate(SMALL, 1, HUGE, policy=SteeringLaw()),
        lambda: flockenv.simulate(SMALL, 1, 1.0, HUGE, SteeringLaw()),
        lambda: flockenv.simulate(SMALL, 1, 1.0, 10.0, SteeringLaw(), control_hz=HUGE),
        lambda: flockenv.LeadersVectorEnv(HUGE),
        lambda: flockenv.LeadersVectorEnv(2).reset(seed=HUGE),
        lambda: flockenv.LeadersVectorEnv(2).reset(seed=[HUGE, 1]),
        lambda: flockenv.LeadersEnv(episode_s=HUGE),
        lambda: flockenv.LeadersEnv(rudder_levels=HUGE),
        lambda: flockenv.LeadersEnv().reset(seed=HUGE),
        lambda: flockenv.LeadersEnv(render_mode="rgb_array", render_size=(HUGE, HUGE)),
        lambda: check_evaluation_seeds([HUGE]),
        lambda: check_evaluation_seeds(range(HUGE)),
        lambda: POLICY_SEEDS["training"].seeds(1, HUGE),
        lambda: POLICY_SEEDS["training"].seeds(HUGE),
    ],
)
def test_whole_numbers_that_cannot_be_printed_are_named_errors(use):
    with pytest.raises(ParameterError, match=r"a value that cannot be printed|seed = 4294967296"):
        use()


def test_a_long_range_of_seeds_is_checked_at_once():
    check_evaluation_seeds(range(1 << 32))
    with pytest.raises(ParameterError, match="seeds for evaluation"):
        check_evaluation_seeds(range((1 << 32) + 1))
    check_evaluation_seeds(range(0))


def test_messages_show_values_that_fit_a_line():
    assert shown("abc") == "'abc'"
    assert len(shown("x" * 1000)) == 81
