"""A small flock that every file here starts from."""

import pytest

import flockenv


@pytest.fixture
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(
        n_boats=12, n_leaders=2, pool="narrow"
    )


@pytest.fixture
def flock(parameters) -> flockenv.Flock:
    return flockenv.Flock(parameters, seed=7)
