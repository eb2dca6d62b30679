"""Law: the window keeps real time and may be closed at any moment."""

import pickle
import sys

import pytest

import flockenv
from flockenv._io.extras import MissingExtraError

SMALL = {"n_boats": 8, "n_leaders": 2, "episode_s": 3.0, "render_size": (160, 120)}


def test_human_mode_without_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(MissingExtraError, match=r"\[render\]"):
        flockenv.LeadersEnv(render_mode="human", **SMALL)


@pytest.fixture
def pygame():
    module = pytest.importorskip("pygame")
    yield module
    module.display.quit()


@pytest.fixture
def waits(pygame, monkeypatch):
    """The rates that windows have waited for, instead of time."""
    rates = []

    class Clock:
        tick = staticmethod(rates.append)

    monkeypatch.setattr(pygame.time, "Clock", Clock)
    return rates


def test_every_reset_and_step_is_one_picture_in_real_time(waits):
    env = flockenv.parallel_env(render_mode="human", control_hz=5.0, **SMALL)
    env.reset(seed=0)
    for _ in range(5):
        env.step({agent: [0.0] for agent in env.agents})
        assert env.render() is None, "a step has shown itself"
    assert waits == [5.0] * 6
    env.close()


def test_closing_the_window_closes_the_environment_s_picture_only(pygame, waits):
    env = flockenv.LeadersEnv(render_mode="human", **SMALL)
    env.reset(seed=0)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    env.step([0.0, 0.0])
    assert not pygame.display.get_init()
    env.step([0.0, 0.0])
    assert env.render() is None
    env.close()
    env.close()
    env.reset(seed=1)
    assert not pygame.display.get_init()
    assert len(waits) == 1


def test_a_window_is_not_copied(waits):
    env = flockenv.LeadersEnv(render_mode="human", **SMALL)
    env.reset(seed=0)
    for copied in (env.clone(), pickle.loads(pickle.dumps(env))):
        assert copied.render_mode == "human"
        env.step([0.0, 0.0])
        copied.step([0.0, 0.0])
        copied.close()
    env.step([0.0, 0.0])
    env.close()
