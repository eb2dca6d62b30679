"""Law: a link to the live page shows its flock, and one that cannot be followed is named."""

import numpy as np
import pytest

import flockenv

pytestmark = pytest.mark.live


def test_every_scene_is_a_link_to_a_flock(open_live):
    live = open_live().go()
    names = live.script(
        "return [...document.querySelectorAll('#lessons a')].map((a) => a.dataset.lesson)"
    )
    assert names == ["steer", "noise", "leaders", "learned", "train", "forces", "opposed"]
    for name in names:
        live.click(f"#lessons a[data-lesson='{name}']")
        live.until(
            "return page.other.lesson === arguments[0] && page.simulator.open.size === 0", name
        )
        chosen = live.find(f"#lessons a[data-lesson='{name}']")
        live.until("return arguments[0].ariaCurrent === 'true'", chosen)
        assert 60 < len(live.text("#story")) < 140
        assert 40 < len(live.text("#after")) < 110
        live.run_to(live.script("return page.runs[0].end") + 3.0)
        for link in live.driver.find_elements("css selector", "#story a"):
            link.click()
            # The address changes first, and the page hears of it later.
            live.until("return arguments[0].ariaCurrent === 'true'", link)
            live.wait()
            assert live.script("return page.other.lesson") == name
            # A story that stays is not written again: the keyboard's focus remains.
            assert link.is_displayed()
    assert live.complaints() == []


def test_a_link_is_followed_where_the_address_is_written_at_the_same_moment(live):
    live.script(
        """location.hash = '#n_boats=9&seed=3';
        history.replaceState(null, '', '#n_boats=12&seed=7');"""
    )
    live.until("return page.runs[0].boats === 9")


def test_a_change_while_a_link_is_followed_is_one_of_the_links_flock(live):
    link = "#n_boats=9&seed=3&beside.n_leaders=1"
    live.script("page.follow(arguments[0]); page.set('bw_s', '0.5')", link)
    live.wait()
    for run, leaders in ((0, "0"), (1, "1")):
        found = live.parameters(run)
        assert (found["n_boats"], found["n_leaders"], found["bw_s"]) == ("9", leaders, "0.5")
    # What is refused is not what later changes start from.
    live.script("page.set('pool', 'none')")
    live.wait()
    live.script("page.set('c4', '0.2')")
    live.wait()
    assert (live.parameters()["pool"], live.parameters()["c4"]) == ("wide", "0.2")


def test_what_changed_on_the_way_is_in_the_link_the_command_and_python(open_live):
    """Whoever opens the link, or runs what stands beside it, sees the same flock, bit for bit."""
    live = open_live().go("#n_boats=12&n_leaders=2&bw_s=0.3&seed=7&start=20&leaders=learned")
    for name, value in (("bw_s", "0.8"), ("target", "ccw"), ("c4", "0.2")):
        live.run_to(live.script("return page.runs[0].end") + 1.5)
        live.script("page.set(arguments[0], arguments[1])", name, value)
        live.wait()
    live.run_to(live.script("return page.runs[0].end") + 5.0)
    live.script("page.seek(page.runs[0].end)")
    time, end = live.script("return [page.time, page.runs[0].end]")
    pose, velocity = live.rows("pose"), live.rows("velocity")
    # The command and Python.
    schedule = live.script("return page.flocks.past.changes")
    changes = [(each["time"], each["fields"]) for each in schedule]
    assert [list(fields) for _, fields in changes] == [["bw_s"], ["target"], ["c4"]]
    for time_s, fields in changes:
        for name, value in fields.items():
            assert f"--at {time_s:g}:{name}={value}" in live.find("#command").get_attribute("value")
    numbers = [
        (
            time_s,
            {name: value if name == "target" else float(value) for name, value in fields.items()},
        )
        for time_s, fields in changes
    ]
    parameters = flockenv.FlockParameters(n_boats=12, n_leaders=2, bw_s=0.3)
    native = flockenv.simulate(parameters, 7, end, policy="learned", schedule=numbers)
    assert np.array_equal(native.pose.reshape(len(native), -1), pose)
    assert np.array_equal(native.velocity.reshape(len(native), -1), velocity)
    python = live.find("#python").get_attribute("value")
    assert f'({changes[0][0]:g}, {{"bw_s": 0.8}})' in python
    # The link, as the button copies it.
    live.script("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    live.script("document.getElementById('take').open = true")
    live.click("[data-copies='address']")
    live.until("return window.copied")
    live.go("#" + live.script("return window.copied").partition("#")[2])
    assert live.status() == ""
    # It opens at this moment, and plays on.
    assert live.script("return page.time") >= time
    assert np.array_equal(live.rows("pose")[: len(pose)], pose)
    assert live.parameters()["bw_s"] == "0.8"
    assert live.complaints() == []


def test_a_link_shows_the_same_flock_again(open_live):
    live = open_live().go("#n_boats=9&bw_s=0.2&pool=narrow&seed=3&beside.bw_s=0.8&speed=4&forces=1")
    live.run_to(5.0)
    pose = live.rows("pose", 1)[:51]
    live.until("return location.hash.includes('speed=64')")
    fragment = live.script("return location.hash")
    live.go(fragment)
    assert live.parameters(1)["bw_s"] == "0.8"
    assert live.find("#forces").is_selected()
    live.run_to(5.0)
    assert np.array_equal(live.rows("pose", 1)[:51], pose)


@pytest.mark.parametrize(
    ("fragment", "words"),
    [
        ("#n_boats=1000000", "n_boats is 2 to 300 on this page"),
        ("#n_boats=NaN&bw_s=Infinity", "bw_s = inf is not accepted"),
        ("#bw_s=NaN", "bw_s = NaN is not accepted"),
        ("#bw_s=banana", "bw_s = 0.3 takes its place."),
        ("#lesson=nothing", "lesson is one of steer, noise"),
        ("#n_leaders=5&n_boats=3", "n_leaders = 5 is not accepted: 0 to n_boats = 3"),
        ("#pool=<img src=x onerror=alert(1)>", "pool = "),
        ("#leaders=<script>window.stolen=1</script>", "leaders = <script>window.stolen=1</script>"),
        ("#n_leaders=3&leaders=learned,paper's law", "one policy for each of 3 leaders"),
        ("#n_leaders=2&leaders=learned,you", "leaders = you is not accepted"),
        ("#n_boats=2&n_leaders=2&leaders=learned,tuned law", ""),
        ("#seed=-1", "seed = -1 is not accepted"),
        ("#preset=none", "preset = "),
        ("#wheels=4", "this page knows no such parameter"),
        ("#n_boats=300&pool=narrow", "boats do not fit the pool"),
        ("#target=cw,cw,ccw", "target = [cw, cw, ccw] is not accepted"),
        ("#speed_cm_s=1e300", "speed_cm_s = "),
        ("#c1=1e6&c3=1e6&dt_s=1&n_boats=40", ""),
        ("#at.5.bw_s=-1&n_boats=5", "bw_s = -1 is not accepted"),
        ("#at.5.wheels=4", "this page knows no such parameter"),
        ("#start=1e9", "start is a number of seconds up to 7200"),
        ("#%E0%A4%A&=&&&==", "this page knows no such parameter"),
    ],
)
def test_a_link_that_cannot_be_followed_is_named_and_not_executed(open_live, fragment, words):
    live = open_live().go(fragment)
    assert live.script("return document.body.dataset.ready") == "true"
    assert words in live.status()
    assert len(live.status()) < 400
    assert live.script("return window.stolen") is None
    assert live.script("return document.querySelectorAll('#status *').length") == 0
    live.choose("#speed", "8")
    live.click("#play")
    live.until("return page.runs[0].end > 1 || page.broken")
    assert live.complaints() == []


@pytest.mark.parametrize(
    ("fragment", "words"),
    [
        ("#lesson=noise&n_boats=5&bw_s=0", "mean rotation m so far "),
        ("#lesson=opposed&n_boats=5&n_leaders=2&target=cw,ccw", "mean rotation m so far "),
        ("#lesson=leaders&n_boats=5&n_leaders=1", "mean signed order so far "),
        ("#n_boats=5", "mean order Ψₒ so far "),
    ],
)
def test_a_lesson_shows_the_quantity_of_its_point(open_live, fragment, words):
    live = open_live().go(fragment)
    live.run_to(2.0)
    assert live.text(".so-far").startswith(words)
