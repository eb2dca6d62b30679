"""Law: the live page shows first, and does at once what its sentences say, by hand and by key."""

import numpy as np
import pytest

from .conftest import FLOCK, LAPTOP, PHONE, LivePage

pytestmark = pytest.mark.live

STEERED = f"{FLOCK}&leaders=you&beside.leaders=paper's law at every substep"
LOW = (1280, 720)


def boxes(live: LivePage, *selectors: str) -> list[dict]:
    source = """
        const box = (each) => document.querySelector(each).getBoundingClientRect().toJSON();
        return Array.from(arguments, box)"""
    return live.script(source, *selectors)


def test_it_opens_on_a_flock_that_circles_and_moves(open_live):
    live = open_live().go("", plays=True)
    rotation = live.script("return page.runs[0].value('rotation', page.runs[0].length - 1)")
    assert abs(rotation) > 0.8
    start = live.script("return page.time")
    live.until("return page.time > arguments[0] + 2", start)
    first, last = live.rows("pose")[-21], live.rows("pose")[-1]
    moved = np.hypot(*(last - first).reshape(-1, 3)[:, :2].T)
    assert np.median(moved) > 5.0
    # One sentence or two, and one control.
    shown = live.script("""
        return [...document.querySelectorAll("main input, main select, main textarea")]
            .filter((each) => each.checkVisibility() && each.type === "range")
            .map((each) => each.id)""")
    assert shown == ["bw_s"]
    assert not live.find("#more").get_attribute("open")


@pytest.mark.parametrize("size", [LOW, LAPTOP, PHONE])
@pytest.mark.parametrize(
    "fragment", ["", "#n_boats=27&n_leaders=1&beside.n_leaders=4&seed=7", STEERED]
)
def test_the_pool_is_whole_with_its_mean_under_it(open_live, size, fragment):
    live = open_live(size).go(fragment)
    canvas, mean, story = boxes(live, ".run canvas", ".so-far", "#story")
    assert canvas["top"] >= story["bottom"] - 1
    assert canvas["top"] < size[1] / 3
    assert canvas["bottom"] <= mean["top"] + 60
    assert mean["bottom"] <= size[1]
    assert canvas["width"] >= (340 if size == PHONE else 400)
    assert live.script("return document.documentElement.scrollWidth <= innerWidth")
    if size == PHONE:
        controls = live.find("#controls").size["height"]
        assert controls <= 64


@pytest.mark.parametrize("size", [PHONE[::-1], (667, 375), (932, 430)])
@pytest.mark.parametrize(
    "fragment", ["", "#n_boats=27&n_leaders=1&beside.n_leaders=4&seed=7", "steer", "train"]
)
def test_a_phone_on_its_side_shows_whole_pools_with_mean_and_controls(open_live, size, fragment):
    live = open_live(size).go(fragment if fragment.startswith("#") else "")
    if fragment.isalpha():
        live.script("document.querySelector(`a[data-lesson='${arguments[0]}']`).click()", fragment)
        live.until("return page.other.lesson === arguments[0] && !page.changing", fragment)
        live.wait()
    steering = "#thumb" if fragment == "steer" else "#bw_s"
    for each in (".run canvas", ".so-far", "#story", "#play", steering):
        for element in live.driver.find_elements("css selector", each):
            box = live.script("return arguments[0].getBoundingClientRect().toJSON()", element)
            assert box["width"] > 0, each
            assert 0 <= box["top"] < box["bottom"] <= size[1], each
            assert box["right"] <= size[0], each
    assert live.script("return document.documentElement.scrollWidth <= innerWidth")
    assert live.find(".run canvas").size["width"] >= 150


@pytest.mark.parametrize("touches", [False, True])
def test_keys_and_dropped_files_are_named_where_there_are_some(open_live, chromium, touches):
    asked = {"enabled": touches, "maxTouchPoints": 1}
    chromium.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", asked)
    try:
        live = open_live(PHONE).go()
        live.script("document.querySelector(\"a[data-lesson='steer']\").click()")
        live.until("return page.other.lesson === 'steer'")
        assert ("arrow keys" in live.text("#story")) != touches
        live.script("document.getElementById('take').open = true")
        assert ("Or drop one onto the page" in live.text("#load")) != touches
    finally:
        off = {"enabled": False}
        chromium.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", off)


def test_two_flocks_take_the_whole_width(open_live):
    live = open_live(LOW).go("#n_boats=27&n_leaders=1&beside.n_leaders=4&seed=7")
    first, second = boxes(live, ".run[data-run='0']", ".run[data-run='1']")
    assert first["top"] == second["top"]
    assert second["left"] > 0.5 * LOW[0]


@pytest.mark.parametrize("size", [LAPTOP, PHONE])
def test_nothing_jumps_between_lessons(open_live, size):
    live = open_live(size).go()
    tops = []
    for name in live.script(
        "return [...document.querySelectorAll('#lessons a')].map((a) => a.dataset.lesson)"
    ):
        live.script("document.querySelector(arguments[0]).click()", f"a[data-lesson='{name}']")
        live.until("return page.other.lesson === arguments[0]", name)
        live.wait()
        live.script("scrollTo(0, 0)")
        run, story = boxes(live, "#runs" if size == PHONE else "#controls", "#story")
        tops.append((run["top"], story["top"], story["height"]))
    assert len(set(tops)) == 1


CONTROLS = (
    *("#play", "#again", "#bw_s", "#speed", "#colors", "#forces", "#help", "#n_boats"),
    *("#n_leaders", "#leaders", "#beside", "#pool", "#target", "#preset", "#boat", "#thumb"),
    *("#lessons a", "#more summary"),
)


@pytest.mark.parametrize("selector", CONTROLS)
def test_arrow_keys_steer_whatever_had_the_focus(live, selector):
    live.choose("#leaders", "you")
    live.script("document.getElementById('more').open = true")
    shown, values = live.script("return [page.shown, page.flocks.values]")
    for key, heading in (("ARROW_LEFT", -15), ("ARROW_RIGHT", 0)):
        live.script("document.querySelector(arguments[0]).focus()", selector)
        live.press(key)
        assert live.script("return document.activeElement.id") == "thumb"
        assert live.script("return page.helm.value") == heading / 180
    # Nothing else was changed by them, and they started the flock.
    assert live.script("return [page.shown, page.flocks.values]") == [shown, values]
    assert live.script("return page.playing")
    assert live.complaints() == []


def test_arrow_keys_steer_neither_in_text_nor_in_a_dialog(live):
    live.choose("#leaders", "you")
    live.script("document.getElementById('take').open = true")
    from selenium.webdriver.common.keys import Keys

    live.script("document.getElementById('command').focus()")
    live.actions().key_down(Keys.ARROW_RIGHT).perform()
    assert live.script("return [document.activeElement.id, page.helm.value]") == ["command", 0]
    live.actions().key_up(Keys.ARROW_RIGHT).perform()
    live.script("document.activeElement.blur()")
    live.press("?")
    assert live.find("#keys").is_displayed()
    assert "the heading of your boats" in live.text("#keys")
    live.press("ARROW_RIGHT")
    assert live.script("return document.activeElement.id") != "thumb"
    live.press("ESCAPE")
    assert not live.find("#keys").is_displayed()


def test_without_leaders_you_are_one(open_live):
    live = open_live().go("#n_boats=12&seed=7")
    live.choose("#leaders", "you")
    assert live.parameters()["n_leaders"] == "1"
    assert live.find("#thumb").is_displayed()
    assert live.find("#leaders").get_attribute("value") == "you"


def test_a_round_waits_for_the_visitor_and_the_next_lesson_plays(open_live):
    live = open_live().go("", plays=True)
    for lesson, plays in (("steer", False), ("leaders", True), ("forces", False), ("noise", True)):
        assert live.script("return page.playing") != plays
        live.script("document.querySelector(`a[data-lesson='${arguments[0]}']`).click()", lesson)
        live.until("return page.other.lesson === arguments[0] && !page.changing", lesson)
        live.until("return page.playing === arguments[0]", plays)
        if lesson == "steer":
            assert live.script("return page.time") == 0.0
            flocks, score = live.text("#doing").split(". ")
            assert flocks.startswith("Clockwise: ")
            assert flocks.endswith(" of 12 boats")
            # The score is heard, too.
            assert score == "you –, the law –, 0 of 300 s."


def test_rounds_of_the_game_are_scored_against_the_law(open_live):
    live = open_live().go()
    live.script("document.querySelector(\"a[data-lesson='steer']\").click()")
    live.until("return page.other.lesson === 'steer'")
    live.wait()
    assert "Goal" in live.text("#story")
    assert len(live.driver.find_elements("css selector", ".run canvas")) == 3
    live.choose("#speed", "64")
    seeds = []
    for number in (1, 2):
        seeds += live.script("return page.runs.map(({seed}) => seed)")
        if not live.script("return page.playing"):
            live.click("#play")
        over = "return !page.playing && page.playback.game.rounds.length === arguments[0]"
        live.until(over, number)
        assert live.script("return page.time") >= 300.0
        means = live.script("return page.runs.map((run) => run.mean('signed_order'))")
        you, law = (
            f"{mean:+.2f}".replace("-", "−") for mean in (np.mean(means[:3]), np.mean(means[3:]))
        )
        assert live.status().startswith(f"Round {number}: ")
        assert f"you {you}, the law {law}." in live.status()
        live.script("page.show()")
        words = live.text(".so-far")
        assert words.startswith(f"you {you}")
        assert {1: "1 round: ", 2: "mean of 2 rounds: "}[number] in words
        # Another round has other flocks, and starts straight at the wall.
        live.click("#play" if number == 1 else "#again")
        live.until("return !page.playback.isOver")
        live.wait()
        assert live.script("return page.helm.value") == 0
    # The law's three flocks have the same starts, and another round has others.
    assert seeds == ["1", "2", "3", "1", "2", "3", "4", "5", "6", "4", "5", "6"]
    assert live.complaints() == []


def test_keys_switch_colors_forces_and_boats(live):
    live.script("document.activeElement.blur()")
    live.press("c")
    assert live.find("#colors").get_attribute("value") == "role"
    assert live.script("return document.body.dataset.colors") == "role"
    live.until("return location.hash.includes('colors=role')")
    live.press("f")
    assert live.find("#forces").is_selected()
    for key, boat in (("]", 0), ("]", 1), ("[", 0), ("[", 11)):
        live.press(key)
        assert live.script("return page.view.pinned") == boat
    live.press("ESCAPE")
    assert live.script("return page.view.pinned") is None


def test_contacts_are_there_at_once(open_live):
    live = open_live().go()
    live.script("document.querySelector(\"a[data-lesson='forces']\").click()")
    live.until("return page.other.lesson === 'forces'")
    live.wait()
    run = "page.runs[0]"
    assert live.script(f"return {run}.contacts({run}.length - 1).length") > 5
    assert live.find(".force-key").is_displayed()
    # Paused while the motors drive forward: bars would be gone a moment later.
    assert not live.script("return page.playing")
    assert live.find(".phase.now").get_attribute("data-phase") == "fw"
    lengths = live.script(f"""
        const {{hull_radius_cm: radius, hull_half_length_cm: half}} = {run}.lengths;
        const forces = {run}.contacts({run}.length - 1).map(({{force}}) => force);
        return forces.map((force) => Math.min(force / 40, 0.45 * (1 + half / radius)))""")
    assert sum(length > 0.15 for length in lengths) > 10
    live.click("#play")
    live.until("return page.time > 89.5")


def test_the_clock_of_a_still_picture_shows_its_time_and_no_speed(open_live):
    live = open_live().go("", plays=True)
    live.until("return document.getElementById('clock').textContent.includes('real time')")
    live.script("document.querySelector(\"a[data-lesson='forces']\").click()")
    live.until("return page.other.lesson === 'forces' && !page.changing")
    assert live.text("#clock") == "89.0 s"


def test_plots_without_data_are_not_there_and_the_expected_order_is(open_live):
    live = open_live().go(FLOCK.replace("n_leaders=2", "n_leaders=0"))
    live.script("document.getElementById('more').open = true")
    shown = {
        each: live.find(f"#{each}").is_displayed()
        for each in ("psi_o", "rotation", "signed_order", "map")
    }
    assert shown == {"psi_o": True, "rotation": True, "signed_order": False, "map": False}
    # The opening's flock is one of the paper's, whose order is known.
    live.go("")
    live.script("document.getElementById('more').open = true")
    assert live.find("#map").is_displayed()
    before = live.script("return document.getElementById('map').toDataURL()")
    live.run_to(live.script("return page.runs[0].end") + 10.0)
    assert live.script("return page.view.map.dot")[1] == pytest.approx(1.0, abs=0.4)
    assert live.script("return document.getElementById('map').toDataURL()") != before


def test_a_simulator_that_does_not_answer_can_be_stopped(live):
    live.click("#play")
    # A step without end, as far as the page can tell.
    live.script("page.simulator.worker.postMessage = () => undefined")
    live.until("return page.simulator.waiting > 1000")
    live.until("return document.getElementById('status').textContent.includes('pause stops it')")
    live.click("#play")
    live.until("return page.broken")
    assert "you stopped it in the middle of a step" in live.status()
    assert not live.script("return page.playing")
    live.click("#again")
    live.until("return !page.broken && page.simulator.open.size === 0")
    live.run_to(2.0)
    assert live.complaints() == []


def test_it_runs_in_a_frame_that_has_no_origin(open_live, file, tmp_path):
    outside = tmp_path / "outside.html"
    outside.write_text(
        f'<iframe id="inside" sandbox="allow-scripts" width="900" height="700"'
        f' src="{file.as_uri()}"></iframe>'
    )
    live = open_live()
    live.open(outside.as_uri())
    live.driver.switch_to.frame("inside")
    live.until("return document.body?.dataset.ready")
    assert live.state() == "true"
    live.until("return page.time > 181")
    live.script("page.set('bw_s', '0.5')")
    live.wait()
    assert live.parameters()["bw_s"] == "0.5"
    live.driver.switch_to.default_content()
