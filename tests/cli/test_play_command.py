"""`flockenv play`: keys steer one leader and nothing else; the same keys make the same run."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest

import flockenv
from flockenv.cli.play import Repeated, steered
from flockenv.policies import SteeringLaw

os.environ["SDL_VIDEODRIVER"] = "dummy"
pygame = pytest.importorskip("pygame")

from flockenv import rendering  # noqa: E402 - after the extra is known to be there

PARAMETERS = flockenv.FlockParameters(n_boats=9, n_leaders=3, pool="narrow")


@pytest.fixture(autouse=True)
def _no_window_is_left():
    yield
    pygame.display.quit()


def post(kind, key):
    pygame.event.post(pygame.event.Event(kind, key=key))


class Scripted(rendering.SteeringWindow):
    """A window at which keys go down and up at given steps, as fast as the steps can be taken."""

    def __init__(self, script, boat=0):
        super().__init__(160, 120, fps=1e6, boat=boat)
        self.script, self.step = script, 0

    def show(self, flock):
        for kind, key in self.script.get(self.step, ()):
            post(kind, key)
        self.step += 1
        super().show(flock)


LEFT_THEN_RIGHT = {
    2: [(pygame.KEYDOWN, pygame.K_LEFT)],
    5: [(pygame.KEYUP, pygame.K_LEFT), (pygame.KEYDOWN, pygame.K_RIGHT)],
    9: [(pygame.KEYDOWN, pygame.K_LEFT)],
    12: [(pygame.KEYUP, pygame.K_LEFT), (pygame.KEYUP, pygame.K_RIGHT)],
}


def test_keys_hold_the_rudder_of_one_leader_and_the_law_the_others():
    rudders = steered(PARAMETERS, 3, 2.0, Scripted(LEFT_THEN_RIGHT))
    assert rudders.shape == (20, 3)
    expected = [0, 0, 1, 1, 1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    assert rudders[:, 0].tolist() == expected

    class KeysAndLaw:
        def predict(self, observation, state=None, episode_start=None):
            rudder = SteeringLaw().predict(observation)[0].reshape(-1)
            rudder[0] = expected[min(state or 0, 19)]
            return rudder, (state or 0) + 1

    by_law, repeated = (
        flockenv.simulate(PARAMETERS, 3, 2.0, policy=policy)
        for policy in (KeysAndLaw(), Repeated(rudders))
    )
    assert replace(repeated, policy=by_law.policy) == by_law


def test_the_same_keys_make_the_same_run_bit_for_bit():
    first, second = (steered(PARAMETERS, 3, 3.0, Scripted(LEFT_THEN_RIGHT)) for _ in range(2))
    assert np.array_equal(first, second)
    flock = flockenv.Flock(PARAMETERS, 3)
    for rudder in first:
        flock.advance(0.1, rudder)
    run = flockenv.simulate(PARAMETERS, 3, 3.0, policy=Repeated(first))
    assert np.array_equal(run.pose[-1], flock.pose)
    assert not np.array_equal(steered(PARAMETERS, 3, 3.0, Scripted({})), first)


def test_closing_the_window_ends_the_run():
    quit_at_7 = {7: [(pygame.QUIT, 0)]}
    assert steered(PARAMETERS, 3, 60.0, Scripted(quit_at_7)).shape == (7, 3)


def test_the_steered_boat_has_a_ring_around_it():
    window = rendering.SteeringWindow(300, 300, fps=1e6, boat=1)
    flock = flockenv.Flock(PARAMETERS, 3)
    window.show(flock)
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
    plain = rendering.frame(flock, 300, 300)
    rows, columns = np.nonzero((shown != plain).any(axis=2))
    # The pool's middle is the frame's; its outer wall leaves a margin of three hundredths.
    scale = 300 * 0.47 / 90.0
    center = 150 + scale * flock.pose[1, 0], 150 - scale * flock.pose[1, 1]
    apart = np.hypot(columns + 0.5 - center[0], rows + 0.5 - center[1])
    assert len(rows) > 50
    assert np.ptp(apart) < 4.0
    assert apart.min() > 7.5 * scale


def test_other_keys_change_the_speed_and_pause():
    window = rendering.SteeringWindow(160, 120, fps=1e6, boat=0)
    flock = flockenv.Flock(PARAMETERS, 3)
    for key, speed in ((pygame.K_UP, 2.0), (pygame.K_PLUS, 4.0), (pygame.K_DOWN, 2.0)):
        post(pygame.KEYDOWN, key)
        window.show(flock)
        assert window.speed == speed
    post(pygame.KEYDOWN, pygame.K_RIGHT)
    window.show(flock)
    assert (window.paused, window.rudder) == (False, -1.0)


def test_the_score_is_printed_beside_that_of_the_law(cli, page_runs, tmp_path):
    fields = [f"--set={field}" for field in ("n_boats=9", "n_leaders=2", "pool=narrow")]
    page = tmp_path / "play.html"
    done = cli("play", *fields, "--minutes", 2, "--speed", 64, "--json", "--out", page)
    assert done.returncode == 0, done.stderr
    scores = json.loads(done.stdout)["runs"]
    assert list(scores) == ["you", "paper's law"]
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=2, pool="narrow")
    law = flockenv.simulate(parameters, 7, 120.0, policy=SteeringLaw())
    late = law.in_analysis_window & (law.time_s > 12.0)
    assert scores["paper's law"]["signed_order"] == law.order.signed_order("cw")[late].mean()
    assert scores["you"]["signed_order"] != scores["paper's law"]["signed_order"]
    assert page_runs(page) == [(name, "7", 1201, 9) for name in scores]


@pytest.mark.parametrize(
    ("arguments", "driver", "words"),
    [
        (["--set", "n_leaders=0"], "dummy", "you steer leader 0"),
        ([], "offscreen", "there is no screen here"),
    ],
)
def test_what_cannot_be_played_is_named(arguments, driver, words, cli, monkeypatch, tmp_path):
    monkeypatch.setattr(pygame.display, "get_driver", lambda: driver)
    done = cli("play", *arguments, "--out", tmp_path / "play.html")
    assert done.returncode == 2
    assert words in done.stderr
    assert list(tmp_path.iterdir()) == []
