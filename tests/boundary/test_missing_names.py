"""Law: a name that there is not is answered with the one that is meant, in one sentence."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters

PARAMETERS = FlockParameters(n_boats=4, pool="narrow")
FLOCK = flockenv.Flock(PARAMETERS, 1)
RUN = flockenv.simulate(PARAMETERS, 1, 1.0)


@pytest.mark.parametrize(
    ("owner", "name", "meant"),
    [
        (FLOCK, "positions", "'pose'"),
        (FLOCK, "poses", "'pose'"),
        (FLOCK, "velocities", "'velocity'"),
        (FLOCK, "time", "'time_s'"),
        (FLOCK, "order", "'order_parameters()'"),
        (FLOCK, "step", "'advance'"),
        (FLOCK, "snapshots", "'snapshot'"),
        (FLOCK, "bw_s", "an entry of 'parameters'"),
        (RUN, "poses", "'pose'"),
        (RUN, "times", "'time_s'"),
        (RUN, "psi_o", "an entry of 'order'"),
        (RUN, "to_dataframes", "'to_dataframe'"),
        (RUN.order, "psi", "'psi_o'"),
        (RUN.order, "psi_0", "'psi_o'"),
        (RUN.order, "columnss", "'columns'"),
        (RUN.order[0], "phi", "'phi_o'"),
        (flockenv, "make", 'gymnasium.make("flockenv/Leaders-v0")'),
        (flockenv, "make_vec", "gymnasium.make_vec"),
        (flockenv, "LeaderVecEnv", "flockenv.sb3.LeaderVecEnv"),
        (flockenv, "FlockParameter", "FlockParameters"),
    ],
)
def test_the_error_names_what_is_meant(owner, name, meant):
    assert not hasattr(owner, name)
    with pytest.raises(AttributeError) as raised:
        getattr(owner, name)
    words = str(raised.value)
    assert repr(name) in words
    assert f"did you mean {meant}" in words


def test_what_resembles_nothing_is_answered_without_a_guess():
    for owner in (FLOCK, RUN, RUN.order, flockenv):
        with pytest.raises(AttributeError, match=r"has no attribute 'xyzzy'$"):
            owner.xyzzy  # noqa: B018
        # As libraries ask, whether there is something.
        assert not hasattr(owner, "_ipython_display_")


def test_copies_and_pickles_are_made_all_the_same():
    for held in (FLOCK, RUN, RUN.order, RUN.order[0]):
        for other in (copy.copy(held), copy.deepcopy(held), pickle.loads(pickle.dumps(held))):
            assert type(other) is type(held)
    assert copy.deepcopy(RUN) == RUN
    assert np.asarray(RUN.order.psi_o).shape == RUN.time_s.shape


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: FlockParameters(bw_s=(0.1, 0.4)), "environments take a range"),
        (lambda: PARAMETERS.replace(bw_s=[0.1, 0.4]), "environments take a range"),
        (lambda: FlockParameters(target="random"), 'environments take it, .* target="random"'),
        (lambda: flockenv.LeadersEnv(reward=len), "LeaderVecEnv also take a function"),
        (lambda: flockenv.parallel_env(reward=len), "LeaderVecEnv also take a function"),
        (lambda: flockenv.LeadersEnv(num_envs=4), "gymnasium.make_vec"),
        (lambda: flockenv.LeadersVectorEnv(num_flocks=4), "'num_envs' here"),
        (lambda: flockenv.parallel_env(max_cycles=500), "'episode_s' seconds"),
        (
            lambda: gymnasium.make("flockenv/Leaders-v0", horizon=500).reset(),
            "'episode_s' seconds",
        ),
        (
            lambda: pytest.importorskip("torchrl") and flockenv.torchrl.LeadersEnv(num_envs=4),
            "'num_flocks' here",
        ),
        (
            lambda: (
                pytest.importorskip("stable_baselines3") and flockenv.sb3.LeaderVecEnv(num_envs=4)
            ),
            "'num_flocks' here",
        ),
    ],
)
def test_an_argument_of_another_place_is_told_its_own(call, words):
    with pytest.raises((TypeError, flockenv.ParameterError), match=words):
        call()
