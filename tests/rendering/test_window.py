"""Law: the window keeps real time, obeys its keys, and may be closed at any moment."""

import pickle
import signal
import sys
from types import SimpleNamespace

import pytest

import flockenv
from flockenv import rendering
from flockenv._io.extras import MissingExtraError
from flockenv._io.interrupts import noted_interrupts

SHORT = {"n_boats": 8, "n_leaders": 2, "episode_s": 3.0}
SMALL = {**SHORT, "render_size": (160, 120)}


def flock():
    return flockenv.Flock(flockenv.FlockParameters().replace(n_boats=8, n_leaders=2), seed=3)


def test_human_mode_without_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(MissingExtraError, match=r"flockenv\[render\]"):
        flockenv.LeadersEnv(render_mode="human", **SHORT)


@pytest.fixture
def pygame():
    module = pytest.importorskip("pygame")
    yield module
    module.display.quit()


def press(pygame, *keys):
    for key in keys:
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=key))


@pytest.fixture
def clock(monkeypatch):
    """Real time of a window, which passes only while it waits; what happens at given times."""
    passed = SimpleNamespace(now=0.0, events={})

    def sleep(seconds):
        passed.now += seconds
        for due in [due for due in passed.events if due <= passed.now]:
            passed.events.pop(due)()

    fake = SimpleNamespace(perf_counter=lambda: passed.now, sleep=sleep)
    monkeypatch.setattr(rendering.window, "time", fake)
    return passed


def test_human_mode_keeps_real_time(pygame, clock):
    env = flockenv.parallel_env(render_mode="human", **SMALL)
    env.reset(seed=0)
    start = clock.now
    for _ in range(5):
        env.step({agent: [0.0] for agent in env.agents})
        assert env.render() is None
    # 0.1 s a step; render() has nothing new to show and does not wait.
    assert clock.now - start == pytest.approx(0.5)
    env.close()
    assert not pygame.display.get_init()


def test_window_shows_the_frame(pygame):
    scene = flock()
    window = rendering.Window(160, 120, fps=100.0)
    window.show(scene)
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
    assert (shown == rendering.frame(scene, 160, 120)).all()
    window.close()


@pytest.mark.parametrize("fps", [0.0, -1.0, float("nan"), float("inf")])
def test_rates_that_no_window_can_keep_are_refused(fps):
    pytest.importorskip("pygame")
    with pytest.raises(flockenv.ParameterError, match="fps"):
        rendering.Window(160, 120, fps=fps)


def test_keys(pygame):
    scene = flock()
    window = rendering.Window(160, 120, fps=100.0)
    press(pygame, pygame.K_PLUS, pygame.K_EQUALS, pygame.K_KP_MINUS)
    window.show(scene)
    assert window.speed == 2.0
    press(pygame, *[pygame.K_PLUS] * 20)
    window.show(scene)
    assert window.speed == window.SPEEDS[1]
    press(pygame, *[pygame.K_MINUS] * 6)
    window.show(scene)
    assert window.speed == 1.0
    # Paused, each press of the right arrow lets one step through.
    press(pygame, pygame.K_SPACE, pygame.K_RIGHT)
    window.show(scene)
    assert window.paused
    press(pygame, pygame.K_RIGHT)
    window.show(scene)
    assert window.paused
    press(pygame, pygame.K_SPACE)
    window.show(scene)
    assert not window.paused
    window.close()


def test_a_pause_lasts_until_the_key_is_pressed_again(pygame, clock):
    window = rendering.Window(160, 120, fps=100.0)
    press(pygame, pygame.K_SPACE)
    clock.events[100.0] = lambda: press(pygame, pygame.K_SPACE)
    window.show(flock())
    assert clock.now == pytest.approx(100.0, abs=0.1)
    window.close()


def test_an_interrupt_ends_a_pause(pygame, clock):
    window = rendering.Window(160, 120, fps=100.0)
    press(pygame, pygame.K_SPACE)
    clock.events[100.0] = lambda: signal.raise_signal(signal.SIGINT)
    with noted_interrupts(), pytest.raises(KeyboardInterrupt):
        window.show(flock())
    window.close()


def test_closing_the_window_closes_the_environment_s_picture_only(pygame):
    env = flockenv.LeadersEnv(render_mode="human", **SMALL)
    env.reset(seed=0)
    press(pygame, pygame.K_SPACE)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    env.step([0.0, 0.0])
    assert not pygame.display.get_init()
    for _ in range(3):
        env.step([0.0, 0.0])
        assert env.render() is None
    env.close()
    env.close()
    env.reset(seed=1)
    assert not pygame.display.get_init()


def test_a_window_is_not_copied(pygame):
    env = flockenv.LeadersEnv(render_mode="human", control_hz=50.0, **SMALL)
    env.reset(seed=0)
    for copied in (env.clone(), pickle.loads(pickle.dumps(env))):
        assert copied.render_mode == "human"
        env.step([0.0, 0.0])
        copied.step([0.0, 0.0])
        copied.close()
    env.step([0.0, 0.0])
    env.close()
