"""Law: a replay starts where its link or its data say, and does what is clicked and typed."""

import pytest

from flockenv.replay.quantities import decisive_minute

pytestmark = pytest.mark.browser


def test_it_opens_playing_at_its_most_decisive_minute(open_page, pages, law, damped):
    for name, recordings in (("one", [law]), ("two", [law, damped])):
        moment, _ = decisive_minute(recordings)
        page = open_page(pages / f"{name}.html", rests=False)
        assert page.is_playing()
        assert page.find("#speed").get_attribute("value") == "8"
        assert moment > 0.0
        assert moment <= page.time() < moment + 30.0
        assert f"opens at {moment:g} s" in page.text("#note")


def test_it_rests_where_less_motion_is_wanted(open_page, pages, emulated):
    emulated("prefers-reduced-motion", "reduce")
    assert not open_page(pages / "one.html", rests=False).is_playing()


def test_a_link_leads_to_a_time_and_a_speed(open_link, pages, law):
    page = open_link(pages / "one.html", "#t=40&speed=0.25")
    assert 40.0 <= page.time() < 42.0
    assert page.find("#speed").get_attribute("value") == "0.25"
    assert page.text("#status") == ""
    page.click("#play")
    page.script("location.hash = 't=80.5&speed=4'")
    page.wait_until_drawn()
    assert page.time() == 80.5
    assert page.find("#speed").get_attribute("value") == "4"
    page.check(law)


@pytest.mark.parametrize("fragment", ["#t=1e9", "#t=soon", "#speed=7", "#t=40&speed=", "#top"])
def test_a_link_that_cannot_be_followed_is_reported(open_link, pages, law, fragment):
    page = open_link(pages / "one.html", fragment)
    assert page.state() == "true"
    assert page.find("#status").is_displayed()
    wrong = fragment[1:].split("&")[-1]
    assert f"link's {wrong}" in page.text("#status")
    assert "ignored" in page.text("#status")
    start = 40.0 if "t=40" in fragment else decisive_minute([law])[0]
    assert start <= page.time() < start + 30.0
    assert page.find("#speed").get_attribute("value") == "8"


def test_it_stops_at_the_end_and_starts_again(page):
    page.press("END")
    assert page.time() == 120.0
    page.click("#play")
    page.wait_until_drawn()
    assert page.time() < 120.0


def test_steps_and_keys(page, law):
    page.click("#forward")
    page.wait_until_drawn()
    assert page.time() == 0.1
    page.press("ARROW_RIGHT", "ARROW_RIGHT")
    assert page.time() == 0.3
    page.press("ARROW_LEFT")
    assert page.time() == 0.2
    page.click("#back")
    page.wait_until_drawn()
    assert page.time() == 0.1
    page.press("+")
    assert page.find("#speed").get_attribute("value") == "2"
    page.press("HOME")
    assert page.time() == 0.0
    page.script("document.activeElement.blur()")
    page.press(" ")
    assert page.find("#play").get_attribute("aria-label") == "Pause"
    page.press(" ")
    assert page.find("#play").get_attribute("aria-label") == "Play"
    page.check(law)


def test_keys_are_reported_and_can_be_switched_off(page):
    page.press("?")
    assert page.find("#keys").is_displayed()
    page.click("#letters")
    page.press("ESCAPE")
    assert not page.find("#keys").is_displayed()
    page.script("document.activeElement.blur()")
    page.press("]")
    assert not page.find(".card", 0).is_displayed()
    page.press("PAGE_UP")
    assert page.time() == 60.0
    page.click("#help")
    page.click("#letters")
    page.click("#keys button")
    page.script("document.activeElement.blur()")
    page.press("[")
    assert page.text(".card .head", 0) == "boat 11"
    assert page.find("#boat").get_attribute("value") == "11"


def test_everything_can_be_reached_and_has_a_name(page):
    reached = []
    for _ in range(12):
        page.press("TAB")
        reached.append(
            page.script("return document.activeElement.id || document.activeElement.tagName")
        )
    player = ["play", "back", "forward", "scrub", "speed"]
    shown = ["trails", "boat", "colors", "forces", "quantity"]
    assert reached == [*player, *shown, "help", "SUMMARY"]
    unnamed = page.script("""
        return [...document.querySelectorAll("button, input, select, canvas")]
            .filter((each) => !each.ariaLabel && !each.closest("label") && !each.innerText.trim())
            .map((each) => each.outerHTML)""")
    assert unnamed == []
