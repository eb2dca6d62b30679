"""Law: what a leader's contacts give is what they change of the touched boat's motion.

Without motors, drag, turning and noise nothing else changes it.
"""

import numpy as np
import pytest

import flockenv
from flockenv.envs.single import LeadersEnv
from flockenv.envs.vector import LeadersVectorEnv

CREDIT = {"contact_push": 1.0, "contact_alignment": 1.0, "touched_order": 1.0}
STEP_S = 0.1


def floating(**changes):
    constants = dict.fromkeys(("c0", "c1", "c2", "c3", "c4"), 0.0)
    return flockenv.FlockParameters(n_boats=2, n_leaders=1, **constants, **changes)


def hit(target, aside, forward=True):
    """Yield the flock before and after each step in which a leader runs into a boat at rest."""
    env = LeadersEnv(params=floating(), target=target, reward=CREDIT)
    # At (140, 0) clockwise is -y. The leader comes from counter-clockwise, and pushes clockwise.
    way = -1.0 if forward else 1.0
    heading = 0.3 if aside else np.pi / 2
    pose = [
        [140.0 + aside, -way * (14.0 if aside else 24.0), way * np.pi / 2],
        [140.0, 0.0, heading],
    ]
    state = {"pose": pose, "velocity": [[0.0, way * 12.0, 0.0], [0.0, 0.0, 0.0]]}
    env.reset(seed=0, options={"state": state})
    for _ in range(15):
        before = env.flock
        info = env.step([0.0])[4]
        yield before, env.flock, info["reward_terms"]


def along_target(flock, boat, target):
    (x, y, _), (vx, vy, _) = flock.pose[boat], flock.velocity[boat]
    return (1.0 if target == "cw" else -1.0) * (vx * y - vy * x) / np.hypot(x, y)


@pytest.mark.parametrize("target", ["cw", "ccw"])
@pytest.mark.parametrize("aside", [0.0, 2.0])
def test_the_push_is_the_momentum_of_the_touched_boat(target, aside):
    pushes = []
    for before, after, terms in hit(target, aside):
        gained = along_target(after, 1, target) - along_target(before, 1, target)
        assert terms["contact_push"] * STEP_S == pytest.approx(gained, abs=0.05)
        pushes.append(terms["contact_push"] * STEP_S)
    # Perfectly inelastic, equal masses: head on, half the speed.
    if aside == 0.0:
        assert abs(sum(pushes)) == pytest.approx(6.0, abs=0.02)
    assert np.sign(sum(pushes)) == (1.0 if target == "cw" else -1.0)


def misalignment(flock, boat, target):
    x, y, heading = flock.pose[boat]
    tangent = np.arctan2(y, x) - (1.0 if target == "cw" else -1.0) * np.pi / 2
    return np.angle(np.exp(1j * (tangent - heading)))


@pytest.mark.parametrize("target", ["cw", "ccw"])
def test_alignment_and_order_follow_the_spin_that_the_hit_gave(target):
    angle = 0.0
    seen = []
    for before, after, terms in hit(target, 3.0):
        given = after.velocity[1, 2] - before.velocity[1, 2]
        aligning = given * np.sin(misalignment(before, 1, target))
        assert terms["contact_alignment"] * STEP_S == pytest.approx(aligning, abs=0.02)
        # Nothing damps a spin here, and the angle is forgotten with 4 s.
        angle = np.exp(-STEP_S / 4.0) * (angle + after.velocity[1, 2] * STEP_S)
        delta = misalignment(after, 1, target)
        expected = np.cos(delta) - np.cos(delta + angle)
        assert terms["touched_order"] == pytest.approx(expected, abs=1e-9)
        seen.append((given, terms["touched_order"]))
    assert max(abs(given) for given, _ in seen) > 0.1
    assert abs(seen[-1][1]) > 0.01


@pytest.mark.parametrize(("c1", "c3"), [(0.0, 1.0), (5.0, 0.0)])
def test_a_spin_that_was_given_decays_as_eq_9_has_a_small_change_decay(c1, c3):
    """At the rate 3·c1·α̇² + c3·u·ẋ, which is its linearization."""
    env = LeadersEnv(params=floating().replace(c1=c1, c3=c3), target="cw", reward=CREDIT)
    # From behind, and beside the middle: one hit that sends the boat ahead, turning.
    pose = [[145.0, 24.0, -np.pi / 2], [140.0, 0.0, -np.pi / 2]]
    state = {"pose": pose, "velocity": [[0.0, -12.0, 0.0], [0.0, 0.0, 0.0]]}
    env.reset(seed=0, options={"state": state})
    spin, angle, seen = 0.0, 0.0, []
    for _ in range(15):
        terms = env.step([0.0])[4]["reward_terms"]
        (_, _, heading), (vx, vy, turning) = env.flock.pose[1], env.flock.velocity[1]
        spin = spin or turning
        angle = np.exp(-STEP_S / 4.0) * (angle + spin * STEP_S)
        rate = 3 * c1 * turning**2 + c3 * (vx * np.cos(heading) + vy * np.sin(heading))
        spin *= np.exp(-rate * STEP_S)
        delta = misalignment(env.flock, 1, "cw")
        seen.append((terms["touched_order"], np.cos(delta) - np.cos(delta + angle)))
    found, expected = np.array(seen).T
    assert found == pytest.approx(expected, abs=4e-4)
    assert abs(found).max() > 2e-3


def test_a_credit_changes_no_bits_and_survives_a_stored_state():
    options = {"n_boats": 20, "n_leaders": 3, "pool": "narrow", "action_mode": "lean"}
    plain = LeadersVectorEnv(2, **options)
    credited = LeadersVectorEnv(2, reward=CREDIT, decision_period_s=0.5, **options)
    plain.reset(seed=0)
    credited.reset(seed=0)
    for _ in range(40):
        for _ in range(5):
            seen = plain.step(np.full((2, 3), 0.2))[0]
        assert seen.tobytes() == credited.step(np.full((2, 3), 0.2))[0].tobytes()
    assert plain._batch.flock(0).statistics == credited._batch.flock(0).statistics
    copy = LeadersVectorEnv(2, reward=CREDIT, decision_period_s=0.5, **options)
    copy.reset(seed=9)
    copy.set_state(credited.get_state())
    for _ in range(5):
        one, other = (env.step(np.full((2, 3), -0.3)) for env in (credited, copy))
        assert one[1].tobytes() == other[1].tobytes()
        assert np.abs(one[1]).max() > 0.0
    without = LeadersVectorEnv(2, decision_period_s=0.5, **options)
    without.reset(seed=0)
    with pytest.raises(flockenv.FlockError, match="other options"):
        without.set_state(credited.get_state())
