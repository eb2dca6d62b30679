"""Law: a visitor trains leaders, sees how they lead, stops, goes on, and takes the policy along."""

import json

import numpy as np
import pytest

import flockenv

from .conftest import PHONE

pytestmark = pytest.mark.live

FLOCK = "#lesson=train&n_boats=6&n_leaders=2&pool=narrow&bw_s=0.3&seed=1&leaders=trained"
SETTINGS = {"flock_hours": 0.1, "pairs": 2, "step": 1.0}
JUDGES = 2


def opened(live, fragment: str = FLOCK, **settings):
    """Open the lesson with a short training and few judges."""
    live.go(fragment)
    source = "Object.assign(page.training.settings, arguments[0]); page.training.judges = 2"
    live.script(source, {**SETTINGS, **settings})
    return live


STOP = """
const taught = page.flocks.teach.bind(page.flocks);
page.flocks.teach = async (policy) => {
  await taught(policy);
  if (page.training.progress.hours > 0.1) {
    page.flocks.teach = taught;
    document.getElementById('train').click();
  }
};
page.training.slice = 0;
"""
"""Stops a training after a tenth of a flock-hour, however fast the machine is."""


def until_over(live) -> None:
    live.until("return page.training.progress?.has_ended && !page.training.isRunning")


def test_a_training_ends_in_a_curve_and_in_a_policy_that_leads_the_flock(open_live, downloads):
    # Installed for these tests alone: nothing of it may be needed to collect them.
    from selenium.webdriver.support.ui import WebDriverWait

    live = opened(open_live())
    assert not live.find("#save-policy").is_enabled()
    assert float(live.find("#save-policy").value_of_css_property("opacity")) < 0.6
    assert live.text("#train") == "train"
    live.click("#train")
    until_over(live)
    assert live.text("#trained").startswith("The training is over. Signed order in 2 other flocks:")
    assert "These are the last leaders, not the best." in live.text("#trained")
    assert live.text("#train") == "train again, other seed"
    assert not live.find("#save-before").is_displayed()
    points, law = live.script("return [page.training.curve.points, page.training.curve.law]")
    assert points[0][0] == 0.0
    assert points[-1][0] == live.script("return page.training.progress.end")
    live.click("#save-policy")
    file = downloads / "policy.json"
    WebDriverWait(live.driver, 30).until(lambda _: file.exists() and file.stat().st_size > 0)
    # Python judges alike, with the physics of trainings.
    fields = {"n_boats": 6, "n_leaders": 2, "pool": "narrow", "bw_s": 0.3}
    parameters = flockenv.FlockParameters(**fields, dt_s=0.1, tolerance_cm=1e-4)
    for policy, found in ((file, points[-1][1]), (None, law)):
        runs = [flockenv.simulate(parameters, seed, 120.0, policy=policy) for seed in range(JUDGES)]
        orders = [run.order.signed_order("cw")[1:].mean() for run in runs]
        assert found == pytest.approx(np.mean(orders), abs=1e-9)
    # The flock that is shown follows them.
    assert live.script("return page.flocks.trained") == file.read_text("utf-8")
    now = live.script("return page.runs[0].end")
    live.run_to(now + 3.0)
    assert np.abs(live.rows("rudder")[-20:]).max() > 0.0
    assert '--policy "policy.json"' in live.find("#command").get_attribute("value")
    assert live.complaints() == []


def test_it_stops_and_goes_on_to_the_same_policy(open_live):
    live = opened(open_live(), flock_hours=1.0)
    live.script(STOP)
    live.click("#train")
    live.until("return document.getElementById('trained').textContent.startsWith('Stopped.')")
    assert not live.script("return page.training.isRunning")
    hours = live.script("return page.training.progress.hours")
    assert hours < live.script("return page.training.progress.end")
    assert live.text("#train") == "go on"
    live.script("document.getElementById('train').focus()")
    live.press("ENTER")
    until_over(live)
    policy = json.loads(live.script("return page.training.progress.policy"))
    # A training of the same seed in one go; the next one has another seed.
    live = opened(open_live(), flock_hours=1.0)
    live.click("#train")
    until_over(live)
    again = json.loads(live.script("return page.training.progress.policy"))
    assert again["weights"] == policy["weights"]
    live.click("#train")
    live.until("return page.training.seed === 1")
    # Nothing is lost meanwhile.
    live.until("return document.getElementById('save-before').checkVisibility()")
    assert json.loads(live.script("return page.training.before"))["weights"] == policy["weights"]
    until_over(live)
    other = json.loads(live.script("return page.training.progress.policy"))
    assert other["weights"] != policy["weights"]
    assert live.complaints() == []


def test_the_flock_moves_on_while_leaders_learn(open_live):
    # More than any machine makes meanwhile, in steps that so long a training can bear.
    live = opened(open_live(), flock_hours=1e4, pairs=32, step=0.03)
    live.click("#train")
    live.click("#play")
    live.until("return page.training.progress?.hours > 0")
    now, hours = live.script("return [page.time, page.training.progress.hours]")
    live.until(
        "return page.time > arguments[0] + 10 && page.training.progress.hours > arguments[1]",
        now,
        hours,
    )
    assert live.script("return page.training.isRunning")
    live.click("#train")
    live.until("return !page.training.isRunning")
    assert live.complaints() == []


def test_a_training_waits_while_its_lesson_is_left(open_live):
    live = opened(open_live(), flock_hours=1e4, pairs=32, step=0.03)
    live.click("#train")
    live.until("return page.training.progress?.hours > 0")
    words = "return document.getElementById('trained').textContent"
    said = live.script(f"""
        const point = page.training.curve.points.at(-1)[1];
        return [point, ({words.replace("return ", "")})]""")
    # What is said is what the curve shows.
    assert f"your leaders {said[0]:+.2f}".replace("−", "-") in said[1].replace("−", "-")
    live.script("document.querySelector(\"a[data-lesson='opposed']\").click()")
    live.until("return page.other.lesson === 'opposed' && !page.changing")
    assert live.status() == "The training waits in its lesson."
    live.until("return document.getElementById('trained').textContent.startsWith('Stopped.')")
    hours = live.script("return page.training.progress.hours")
    live.script("page.follow(arguments[0])", FLOCK)
    live.until("return page.flocks.areTrained && !page.changing")
    assert live.text("#train") == "go on"
    live.click("#train")
    live.until("return page.training.progress.hours > arguments[0]", hours)
    live.click("#train")
    live.until("return page.training.isRunning === false")
    # Another flock is another training.
    live.script("page.set('bw_s', '0.4')")
    live.wait()
    assert live.text("#train") == "train again, this flock"
    assert live.complaints() == []


def test_less_motion_leaves_the_flock_still_and_trains(open_live, emulated):
    emulated("prefers-reduced-motion", "reduce")
    live = opened(open_live())
    live.click("#train")
    until_over(live)
    assert not live.script("return page.playing")
    label = live.find("#curve").get_attribute("aria-label")
    assert label.startswith("Learning curve. Signed order in 2 other flocks: your leaders ")


def test_a_phone_shows_the_flock_the_button_and_the_curve_together(open_live):
    live = opened(open_live(PHONE))
    live.click("#train")
    until_over(live)
    live.script("scrollTo(0, 0)")
    source = """
        const boxes = [...arguments].map((each) => document.querySelector(each));
        return boxes.map((each) => each.getBoundingClientRect().toJSON())"""
    boxes = live.script(source, ".run canvas", "#train", "#curve", "#trained", "#controls")
    tops, bottoms = ([each[side] for each in boxes] for side in ("top", "bottom"))
    assert all(above <= below for above, below in zip(bottoms, tops[1:], strict=False))
    assert tops[0] > 0
    assert bottoms[-1] <= PHONE[1]


def test_a_flock_without_leaders_is_refused_in_words(open_live):
    live = opened(open_live(), FLOCK.replace("n_leaders=2", "n_leaders=0"))
    live.click("#train")
    live.until("return document.getElementById('trained').textContent && !page.training.isRunning")
    assert "n_leaders = 0 is not accepted: at least 1 leader, who learns" in live.text("#trained")
    assert live.text("#train") == "train"
    assert live.complaints() == []


def test_a_pool_without_usual_values_is_refused_in_words(open_live):
    live = open_live().go(FLOCK.replace("pool=narrow", "pool=180,0"))
    assert "The link asks for what cannot be: pool = " in live.status()
    assert live.complaints() == []
