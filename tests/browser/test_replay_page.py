"""Law: a replay shows what the recording says, and needs no network."""

import dataclasses
import time

import numpy as np
import pytest

import flockenv
from flockenv.replay import write_replay

from .conftest import LAST_DIGIT, number

pytestmark = pytest.mark.browser


def test_it_opens_without_a_network_or_a_complaint(page, law):
    assert page.state() == "true"
    assert page.driver.title == "law – flockenv replay"
    assert "seed 7" in page.text(".origin", 0)
    assert f"flockenv {law.version}" in page.text(".origin", 0)
    page.click("#play")
    time.sleep(0.5)
    assert page.complaints() == []
    requested = page.requested()
    assert requested
    assert [url for url in requested if not url.startswith(("file:", "data:", "blob:"))] == []


def test_its_policy_forbids_the_network(page):
    source = """
        const done = arguments[0];
        fetch("http://127.0.0.1:9/").then(() => done("sent"), () => done("refused"))"""
    assert page.driver.execute_async_script(source) == "refused"
    assert "Content Security Policy" in " ".join(page.complaints())


def test_scrubbing_shows_the_recordings_numbers(page, law):
    page.check(law)
    seen = set()
    for share in (0.1, 0.33, 0.5, 0.77, 0.95):
        page.click_at("#scrub", share)
        assert page.time() == pytest.approx(share * 120.0, abs=3.0)
        page.check(law)
        seen.add(page.text(".psi", 0))
    assert len(seen) > 2


def test_hovering_reports_a_boats_numbers(page, law):
    page.click_at("#scrub", 0.6)
    page.press("ARROW_LEFT")
    k = page.sample(law)
    for boat in (0, 7):
        page.point_at(0, *page.place_of(law, boat))
        assert page.text(".card .head", 0).split()[:2] == ["boat", str(boat)]
        assert ("leader" in page.text(".card .head", 0)) == (boat < 2)
        x, y, heading = law.pose[k, boat]
        speed, turning = np.hypot(*law.velocity[k, boat, :2]), law.velocity[k, boat, 2]
        read = {
            name: page.number(f"dd[data-number='{name}']", 0)
            for name in ("x", "y", "heading", "speed", "turning", "contacts", "strongest push")
        }
        assert (read["x"], read["y"]) == pytest.approx((x, y), abs=0.056)
        assert np.cos(read["heading"] - heading) == pytest.approx(1.0, abs=1e-4)
        assert read["speed"] == pytest.approx(speed, abs=0.076)
        angles = page.driver.find_elements("css selector", ".card dd[data-number='φ']")
        assert len(angles) == (boat < 2)
        if boat < 2:
            rudder = law.rudder[k, boat]
            assert page.number("dd[data-number='rudder']", 0) == pytest.approx(rudder, abs=0.0061)
            # Figure 3: 0 points outward, clockwise is positive.
            phi = np.arctan2(y, x) - heading
            assert np.cos(page.number("dd[data-number='φ']", 0) - phi) == pytest.approx(
                1.0, abs=1e-4
            )
        assert read["turning"] == pytest.approx(turning, abs=0.0076)
        first = law.contacts.count[:k].sum()
        now = slice(first, first + law.contacts.count[k])
        touches = (law.contacts.i[now] == boat) | (law.contacts.j[now] == boat)
        assert read["contacts"] == touches.sum()
        strongest = law.contacts.force[now][touches].max(initial=0.0)
        assert read["strongest push"] == pytest.approx(strongest, abs=0.11)
    page.point_at(0, 5, 300)
    assert not page.find(".card", 0).is_displayed()


def test_a_click_keeps_a_boats_numbers(page, law):
    page.point_at(0, *page.place_of(law, 3))
    page.actions().click().perform()
    page.point_at(0, 5, 300)
    page.click_at("#scrub", 0.9)
    assert page.text(".card .head", 0) == "boat 3"
    page.press("ARROW_LEFT")
    x = law.pose[page.sample(law), 3, 0]
    assert page.number("dd[data-number='x']", 0) == pytest.approx(x, abs=0.056)
    page.press("]")
    assert page.text(".card .head", 0) == "boat 4"
    page.press("ESCAPE")
    assert not page.find(".card", 0).is_displayed()


def test_the_chart_follows_and_leads(page, law):
    before = page.picture("#overview")
    page.click_at("#overview", 0.5)
    # Clicked in the middle of the canvas, of which the axis takes 40 pixels and the edge 10.
    width = page.find("#overview").size["width"]
    assert page.time() == pytest.approx(120.0 * (0.5 * width - 40) / (width - 50), abs=0.5)
    assert page.picture("#overview") != before
    page.check(law)
    for key in ("psi_o", "psi_v", "c_v"):
        page.choose("#quantity", key)
        value = getattr(law.order, key)[page.sample(law)]
        decimals = len(page.text("#legend b").partition(".")[2])
        shown = page.number("#legend b")
        assert shown == pytest.approx(value, abs=0.5 * 10.0**-decimals + 0.03)


def test_two_runs_side_by_side(pair, law, damped):
    assert [pair.text(".name", run) for run in (0, 1)] == ["law", "damped"]
    assert pair.find(".run[data-run='0']").rect["y"] == pair.find(".run[data-run='1']").rect["y"]
    pair.click_at("#scrub", 0.5)
    pair.press("ARROW_LEFT")
    pair.check(law, 0)
    pair.check(damped, 1)
    assert law.order.psi_o[600] != damped.order.psi_o[600]
    pair.point_at(0, *pair.place_of(law, 4))
    heads = [pair.text(".card .head", run) for run in (0, 1)]
    assert heads == ["boat 4", "boat 4"]
    # The shorter run stays at its end.
    pair.press("END")
    assert pair.time() == 120.0
    assert pair.number(".time", 1) == 90.0
    pair.check(damped, 1)


def test_it_says_what_to_watch_and_the_means_so_far(pair, law, damped):
    assert "the signed order is 1 if all do" in pair.text("#watch")
    pair.press("END")
    for place, recording in enumerate((law, damped)):
        seen = recording.in_analysis_window
        signed = recording.order.signed_order("cw")[seen]
        shown = pair.driver.find_elements("css selector", "#legend .mean")[place].text
        assert number(shown.removeprefix("mean ")) == pytest.approx(signed.mean(), abs=LAST_DIGIT)


def test_recorded_words_are_not_run(open_page, law, tmp_path):
    evil = (
        "</script><script>window.hacked=1</script><img src=x onerror='window.hacked=2'>{{script}}"
    )
    run = dataclasses.replace(law, version=evil)
    write_replay(tmp_path / "evil.html", {evil: run, f"{evil}2": law})
    page = open_page(tmp_path / "evil.html")
    assert page.state() == "true"
    assert page.script("return window.hacked") is None
    assert page.text(".name", 0) == evil
    assert page.text(".origin", 0) == f"seed 7 · flockenv {evil}"
    assert page.script("return document.images.length") == 0


def test_a_damaged_page_says_so(open_page, pages, tmp_path):
    text = (pages / "one.html").read_text()
    place = text.index('"data":"') + 1000
    damaged = tmp_path / "damaged.html"
    damaged.write_text(text[:place] + ("A" * 400) + text[place + 400 :])
    page = open_page(damaged)
    assert page.state() == "failed"
    assert "damaged" in page.text("#note")


def test_without_contacts_or_normal_boats(open_page, parameters, tmp_path):
    run = flockenv.simulate(parameters.replace(n_boats=2), 1, 5.0)
    write_replay(tmp_path / "leaders.html", {"leaders": run})
    page = open_page(tmp_path / "leaders.html")
    assert page.state() == "true"
    assert not page.find("#forces").is_enabled()
    assert page.text(".psi", 0) == "–"
    assert page.complaints() == []
