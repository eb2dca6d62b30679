"""Law: the live page shows the simulator's own flock, does what is clicked, says what it cannot."""

import numpy as np
import pytest

import flockenv

from .conftest import FLOCK, PHONE

pytestmark = pytest.mark.live


def test_it_opens_and_plays_without_a_network_or_a_complaint(open_live):
    live = open_live().go("", plays=True)
    assert live.script("return document.body.dataset.ready") == "true"
    live.until("return page.time > 5")
    live.wait()
    assert live.complaints() == []
    requested = live.requested()
    assert requested
    assert [url for url in requested if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.mark.parametrize("policy", ["paper's law at every substep", "tuned law", "learned"])
def test_its_numbers_are_those_of_python(open_live, policy):
    """A minute of 27 boats, bit for bit, and the order that is shown."""
    live = open_live().go(f"{FLOCK.replace('n_boats=12', 'n_boats=27')}&leaders={policy}")
    live.run_to(60.0)
    parameters = flockenv.FlockParameters(n_boats=27, n_leaders=2, bw_s=0.3)
    native = flockenv.simulate(parameters, 7, 60.0, policy=policy)
    pose, velocity = (live.rows(name)[:601] for name in ("pose", "velocity"))
    assert np.array_equal(pose.reshape(-1, 27, 3), native.pose)
    assert np.array_equal(velocity.reshape(-1, 27, 3), native.velocity)
    assert np.array_equal(live.rows("in_analysis_window")[:601, 0] > 0, native.in_analysis_window)
    names = live.script("return page.quantities.map(({key}) => key)")
    series = dict(zip(names, live.rows("series")[:601].T, strict=True))
    for name in ("psi_o", "phi_o", "milling", "rotation", "signed_order"):
        assert np.allclose(series[name], native.order.series(name, "cw"), atol=1e-12)


@pytest.mark.parametrize(
    ("name", "key", "continues"),
    [
        ("n_boats", "ARROW_RIGHT", False),
        ("n_leaders", "ARROW_RIGHT", True),
        ("bw_s", "ARROW_RIGHT", True),
        ("c4", "ARROW_LEFT", True),
        ("boat_shape", "ARROW_RIGHT", True),
    ],
)
def test_sliders_change_the_flock_from_where_it_is_or_say_that_it_starts_again(
    live, name, key, continues
):
    live.run_to(3.0)
    before, time = live.parameters(), live.script("return page.runs[0].end")
    live.unfold(f"#{name}")
    live.script("document.getElementById(arguments[0]).focus()", name)
    live.press(key)
    live.wait()
    after = live.parameters()
    changed = {each for each in after if after[each] != before[each]}
    assert changed - {"gyration_radius_cm"} == {name}
    assert (float(after[name]) > float(before[name])) == (key == "ARROW_RIGHT")
    assert live.script("return page.runs[0].end") == (time if continues else 0)
    assert ("continues" if continues else "starts again") in live.status()
    assert live.text(f"label:has(#{name}) output") == f"{float(after[name]):g}"
    live.until("return location.hash.includes(arguments[0])", f"{name}={float(after[name]):g}")
    assert live.complaints() == []


@pytest.mark.parametrize(
    ("name", "value", "field", "expected", "continues"),
    [
        ("pool", "narrow", "pool", "narrow", True),
        ("pool", "180,0", "pool", "180,0", True),
        ("pool", "inf,0", "pool", "inf,0", False),
        ("target", "ccw", "target", "ccw", True),
        ("target", "opposed", "target", "cw,ccw", True),
        ("scheme", "moreau", "scheme", "moreau", True),
        ("noise_scheme", "per-step", "noise_scheme", "per-step", True),
        ("preset", "experiment", "c3", "0.1906", True),
    ],
)
def test_choices(live, name, value, field, expected, continues):
    live.run_to(3.0)
    live.choose(f"#{name}", value)
    assert live.parameters()[field] == expected
    assert ("continues" if continues else "starts again") in live.status()
    live.run_to(live.script("return page.runs[0].end") + 2.0)
    assert live.complaints() == []


def test_leaders_steer_as_they_are_told(live):
    live.choose("#leaders", "tuned law")
    assert live.script("return page.shown.flock.leaders") == "tuned law"
    live.choose("#pool", "180,0")
    assert "the damped law is tuned only in the pools" in live.status()
    # What was refused is not shown.
    assert live.find("#pool").get_attribute("value") == "wide"
    assert live.parameters()["pool"] == "wide"
    live.choose("#leaders", "learned")
    live.choose("#pool", "narrow")
    assert "in narrow none led better than the tuned law" in live.status()
    assert live.parameters()["pool"] == "wide"
    live.run_to(2.0)
    assert live.complaints() == []


def test_each_leader_steers_by_a_policy_of_its_own(live):
    live.choose("#leaders", "each")
    assert live.script("return page.shown.flock.leaders") == "paper's law,paper's law"
    live.choose("#each label:nth-child(2) select", "learned")
    assert live.find("#leaders").get_attribute("value") == "each"
    policy = {"leader_0": "paper's law", "leader_1": "learned"}
    assert 'policy={"leader_0": "paper\'s law", "leader_1": "learned"}' in live.find(
        "#python"
    ).get_attribute("value")
    live.click("#again")
    live.run_to(10.0)
    parameters = flockenv.FlockParameters(n_boats=12, n_leaders=2, bw_s=0.3)
    native = flockenv.simulate(parameters, 7, 10.0, policy=policy)
    assert np.array_equal(live.rows("pose")[:101].reshape(-1, 12, 3), native.pose)
    # A third leader does as the last one, and one alone needs no list.
    live.script("page.set('n_leaders', '3')")
    live.wait()
    assert live.script("return page.shown.flock.leaders") == "paper's law,learned,learned"
    live.script("page.set('n_leaders', '1')")
    live.wait()
    assert live.script("return page.shown.flock.leaders") == "paper's law"
    assert not live.driver.find_elements("css selector", "#each select")
    live.choose("#leaders", "each")
    assert live.script("return page.shown.flock.leaders") == "paper's law"
    assert live.complaints() == []


def test_another_start_has_other_places(live):
    live.run_to(2.0)
    first = live.rows("pose")[0]
    live.click("#again")
    live.wait()
    assert np.array_equal(live.rows("pose")[0], first)
    live.click("#another")
    live.wait()
    assert not np.array_equal(live.rows("pose")[0], first)
    seed = live.script("return page.shown.flock.seed")
    live.until("return location.hash.includes(arguments[0])", f"seed={seed}")
    assert live.complaints() == []


def test_forces_are_shown_when_asked_for(live):
    live.run_to(3.0)
    assert not live.find(".force-key").is_displayed()
    live.click("#forces")
    assert live.find(".force-key").is_displayed()
    live.until("return location.hash.includes('forces=1')")


def test_a_second_flock_runs_beside(live):
    for value, leaders in (("n_leaders=0", "0"), ("n_leaders=4", "4")):
        live.choose("#beside", value)
        assert live.parameters(1)["n_leaders"] == leaders
        assert live.script("return page.runs.map((run) => run.end)") == [0, 0]
    live.choose("#beside", "leaders=tuned law")
    live.run_to(20.0)
    assert np.array_equal(live.rows("time_s", 0), live.rows("time_s", 1))
    first, second = live.rows("pose", 0), live.rows("pose", 1)
    assert np.array_equal(first[0], second[0])
    assert not np.array_equal(first[-1], second[-1])
    assert [run.text for run in live.driver.find_elements("css selector", ".run .name")] == [
        "the paper's law",
        "the tuned law",
    ]
    for run, mean in enumerate(
        live.script("return page.runs.map((each) => each.mean('signed_order'))")
    ):
        words, _, number = live.text(".so-far .own", run).rpartition(" ")
        assert words == "mean signed order so far"
        assert float(number.replace("−", "-")) == pytest.approx(mean, abs=0.006)
    live.choose("#beside", "")
    assert live.script("return page.runs.length") == 1
    assert live.complaints() == []


def test_the_arrow_keys_turn_all_leaders(live):
    live.choose("#leaders", "you")
    assert live.find("#thumb").is_displayed()
    live.script("document.activeElement.blur()")
    for _ in range(5):
        live.press("ARROW_RIGHT")
    assert live.text("#heading") == "clockwise, 15° outward"
    # The first key started it.
    live.until("return page.playing")
    live.until("return page.runs[0].end > 5")
    live.click("#play")
    live.wait()
    assert (np.abs(live.rows("rudder")[:, :2]).max(axis=0) > 0.1).all()
    assert "you" in live.text(".so-far")
    assert "the law" in live.text(".so-far")
    assert live.complaints() == []


def test_a_thumb_steers_on_a_phone(open_live):
    live = open_live(PHONE).go(f"{FLOCK}&leaders=you&beside.leaders=paper's law at every substep")
    thumb = live.find("#thumb")
    # In reach wherever the page is scrolled, and named.
    assert live.text("#steer label") == "your boats head straight at the wall"
    for top in (0, 400):
        live.script("window.scrollTo(0, arguments[0])", top)
        box = live.script(
            "return document.getElementById('thumb').getBoundingClientRect().toJSON()"
        )
        assert 0 < box["top"] < box["bottom"] <= PHONE[1]
        assert box["height"] >= 44
    width = thumb.size["width"]
    held = live.actions().move_to_element(thumb).click_and_hold()
    held.move_by_offset(round(0.25 * width), 0).release().perform()
    # It stays where it was left, and the round has started.
    assert live.script("return page.helm.value") == pytest.approx(0.5, abs=0.1)
    assert "clockwise" in live.text("#heading")
    assert live.script("return page.playing")


@pytest.mark.parametrize("missing", ["Worker", "WebAssembly", "DecompressionStream"])
def test_a_browser_without_what_it_needs_gets_a_sentence(open_live, chromium, missing):
    source = {"source": f"delete window.{missing}"}
    script = chromium.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", source)
    try:
        live = open_live().go()
        assert live.script("return document.body.dataset.ready") == "failed"
        assert f"this browser has no {missing}" in live.status()
        assert "Backing frees a jam" not in live.status()
    finally:
        chromium.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)


def test_a_boats_numbers_frame_and_observation(live):
    live.script("document.getElementById('observes').open = true")
    live.choose("#boat", "1")
    assert live.text(".card .head").startswith("boat 1")
    # At the start, and then where the flock has run to.
    for time_s in (0.0, 3.0):
        if time_s > 0.0:
            live.run_to(time_s)
        live.until("return document.querySelectorAll('#observation td').length > 0")
        live.wait()
        source = "return page.runs[0].posesAt(page.runs[0].end)[1]"
        x, y, heading = live.script(source)
        names = live.script("return page.entries.map(({name}) => name)")
        seen = dict(zip(names, live.script("return Array.from(page.view.observed)"), strict=True))
        phi = np.arctan2(y, x) - heading
        assert seen["cos_orientation"] == pytest.approx(np.cos(phi), abs=1e-6)
        rudder = live.script("return page.runs[0].rudder(1, page.runs[0].length - 1)")
        assert seen["rudder"] == pytest.approx(rudder, abs=1e-6)
        assert seen["sin_orientation"] == pytest.approx(np.sin(phi), abs=1e-6)
        assert len(live.driver.find_elements("css selector", "#observation tr")) == len(names)
    live.choose("#boat", "5")
    assert not live.find("#observes").is_displayed()
    live.press("ESCAPE")
    live.script("document.activeElement.blur()")
    live.press("ESCAPE")
    assert live.script("return page.view.pinned") is None


def test_texts_of_the_flock_are_shown_and_copied(live, chromium):
    live.script("document.getElementById('take').open = true")
    command = live.find("#command").get_attribute("value")
    assert command == ("flockenv run --n-boats 12 --n-leaders 2 --bw-s 0.3 --seed 7 --minutes 8")
    assert "flockenv.simulate(parameters, seed=7" in live.find("#python").get_attribute("value")
    live.choose("#beside", "leaders=learned")
    live.until("return page.runs.length === 2")
    commands = live.find("#command").get_attribute("value").split("\n")
    assert commands == [command, command.replace("--seed", '--policy "learned" --seed')]
    assert 'policy="learned"' in live.find("#python").get_attribute("value")
    live.script("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    box = "return arguments[0].getBoundingClientRect().toJSON()"
    for button in live.driver.find_elements("css selector", "[data-copies]"):
        live.script("arguments[0].scrollIntoView({block: 'center'})", button)
        words, place = button.text, live.script(box, button)
        button.click()
        live.until("return arguments[0].textContent === 'copied'", button)
        # It is said where somebody looks and to who listens, and nothing moves: twice is no harm.
        assert live.script("return arguments[0].nextSibling.textContent", button) == "Copied."
        assert live.script(box, button) == place
        button.click()
        live.until("return arguments[0].textContent === arguments[1]", button, words)
        assert live.script(box, button) == place
        assert live.status() == ""
        assert live.script("return window.copied")
    live.script("navigator.clipboard.writeText = async () => { throw new Error('no'); }")
    button.click()
    live.until("return arguments[0].nextSibling.textContent.includes('here it is')", button)
    assert live.script("return arguments[0].nextSibling.checkVisibility()", button)


def test_there_is_a_pool_and_a_word_until_the_core_has_started(open_live, chromium):
    """The simulator's thread starts when the test lets it."""
    source = """
        window.Worker = class {
            constructor() { window.held = this; }
            addEventListener() {}
            postMessage() {}
        }"""
    held = chromium.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": source})
    try:
        live = open_live()
        live.open(live.file.as_uri())
        live.until("return Boolean(window.held)")
        assert live.find("#loading").is_displayed()
        assert "loading" in live.text("#loading")
        width, height = live.find("#loading").size.values()
        assert min(width, height) > 300
        assert live.status() == ""
    finally:
        chromium.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", held)
    live.go()
    assert not live.driver.find_elements("css selector", "#loading")


def test_the_file_is_small(file):
    assert file.stat().st_size < 500_000
