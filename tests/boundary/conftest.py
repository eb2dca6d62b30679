"""A small scene that every file here starts from."""

import hypothesis
import pytest

import flockenv

# A busy machine makes an example slow, not wrong.
hypothesis.settings.register_profile("boundary", deadline=None)
hypothesis.settings.load_profile("boundary")


@pytest.fixture
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(
        n_boats=12, n_leaders=2, pool="table-1"
    )


@pytest.fixture
def flock(parameters) -> flockenv.Flock:
    return flockenv.Flock(parameters, seed=7)
