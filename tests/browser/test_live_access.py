"""Law: everybody can use the live page: by keyboard, finger or screen reader, in any window."""

import pytest

from .conftest import FLOCK, LAPTOP, PHONE, LivePage, resize

pytestmark = pytest.mark.live


@pytest.mark.parametrize("size", [PHONE, LAPTOP])
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(
    "fragment", ["", "#n_boats=27&n_leaders=4&seed=7&beside.n_leaders=1&boat=0"]
)
def test_nothing_is_wider_than_the_window(open_live, emulated, size, scheme, fragment):
    emulated("prefers-color-scheme", scheme)
    live = open_live(size).go(fragment)
    assert live.script("return document.documentElement.scrollWidth <= innerWidth")
    ground = live.script("return getComputedStyle(document.body).backgroundColor")
    assert (ground == "rgb(20, 25, 31)") == (scheme == "dark")


def test_the_page_stays_where_it_was_scrolled_to_while_a_boats_numbers_change(open_live):
    live = open_live(PHONE).go(f"{FLOCK}&boat=0", plays=True)
    assert live.find(".card").is_displayed()
    top, now = live.script("""
        scrollTo(0, document.documentElement.scrollHeight);
        return [scrollY, page.runs[0].end]""")
    assert top > 0
    live.until("return page.runs[0].end > arguments[0] + 2", now)
    assert live.script("return scrollY") == top


def test_everything_is_reached_by_the_keyboard_and_has_a_name(live):
    live.script("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    wanted = live.script("""
        return [...document.querySelectorAll("a, button, input, select, textarea, summary")]
            .filter((each) => each.checkVisibility()).map((each) => each.id || each.textContent)""")
    live.script("document.activeElement.blur()")
    reached = []
    for _ in range(len(wanted) + 2):
        live.press("TAB")
        reached.append(
            live.script("const at = document.activeElement; return at.id || at.textContent")
        )
    assert [each for each in wanted if each not in reached] == []
    tree = live.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    roles = {"button", "slider", "combobox", "checkbox", "textbox", "link", "img"}
    unnamed = [
        node["role"]["value"]
        for node in tree
        if not node.get("ignored")
        and node.get("role", {}).get("value") in roles
        and not node.get("name", {}).get("value")
    ]
    assert unnamed == []
    live.choose("#boat", "1")
    live.until("return document.querySelectorAll('#observation td').length > 0")
    named = {(role, name) for role, name, _ in tree_of(live) if role in ("table", "region")}
    assert ("region", "What this leader observes") in named
    tables = [name for role, name in named if role == "table"]
    assert sorted(tables) == ["Observation", "Parameters", "Since the start"]
    buttons = [name for role, name, _ in tree_of(live) if role == "button"]
    assert sorted({*buttons}) == sorted(buttons)


def test_a_control_is_called_what_stands_beside_it(open_live):
    """Whoever speaks to the page says what the page shows."""
    live = open_live().go(f"{FLOCK}&leaders=you")
    shown = live.text("#steer label").removesuffix(live.text("#heading")).strip()
    named = [name for role, name, _ in tree_of(live) if role == "slider"]
    assert shown in named
    # Its value is said once, by the slider.
    assert live.script("return thumb.ariaValueText") == live.text("#heading")
    outputs = "return [...document.querySelectorAll('output')].map((each) => each.ariaLive)"
    assert {*live.script(outputs)} == {"off"}


def test_less_motion_is_respected_and_it_plays_when_asked(open_live, emulated):
    emulated("prefers-reduced-motion", "reduce")
    live = open_live().go("", plays=True)
    assert not live.script("return page.playing")
    assert "Paused, since your system asks for less motion" in live.status()
    now = live.script("return page.time")
    live.script("document.activeElement.blur()")
    live.press(" ")
    live.until("return page.time > arguments[0] + 0.5", now)
    assert live.status() == ""
    # An arrow key starts the game.
    live.script("document.querySelector(\"a[data-lesson='steer']\").click()")
    live.until("return page.other.lesson === 'steer'")
    live.wait()
    live.script("if (page.playing) page.toggle(); document.activeElement.blur()")
    live.press("ARROW_LEFT")
    live.until("return page.playing")


def tree_of(live) -> list[tuple[str, str, str]]:
    """Roles, names and values, as a screen reader has them."""
    nodes = live.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    said = [each for each in nodes if not each.get("ignored")]
    parts = ("role", "name", "value")
    return [tuple(str(each.get(part, {}).get("value", "")) for part in parts) for each in said]


def test_a_screen_reader_hears_names_values_and_what_the_flock_does(open_live):
    live = open_live().go("#preset=experiment&n_boats=27&bw_s=0.8&seed=5&start=180")
    slider = live.script("return document.getElementById('bw_s').ariaValueText")
    assert slider == "0.8 seconds"
    tree = tree_of(live)
    assert [name for role, name, _ in tree if role == "slider"] == ["backward duration"]
    # No range of a field that the slider does not reach.
    title = live.find("#bw_s").get_attribute("title")
    assert title == "Duration of the backward phase: the source of disorder."
    pictures = [name for role, name, _ in tree if role in ("image", "img")]
    said = {
        f"27 boats; {share} {way}."
        for share in ("all", "nearly all", "most")
        for way in ("clockwise", "counter-clockwise")
    }
    assert said & set(pictures)
    assert live.text("#doing") in said
    # It changes with the flock, which is another one here.
    live.script("page.follow('#preset=experiment&n_boats=27&bw_s=0&seed=16&start=180')")
    live.wait()
    live.until(
        "return !arguments[0].includes(document.getElementById('doing').textContent)", [*said]
    )
    assert live.text("#doing").startswith("27 boats; ")
    # A boat that is chosen while it is paused is named at once.
    live.script("document.activeElement.blur()")
    live.press("]")
    assert live.text("#doing").startswith("Boat 0: ")


def test_what_is_said_is_that_of_the_lesson_and_short(open_live):
    live = open_live().go("#n_boats=12&n_leaders=2&bw_s=0.3&seed=7", plays=True)
    live.until("return page.time > 1")
    assert live.find("#after").get_attribute("aria-live") == "polite"
    source = """
        const heard = [];
        const doing = document.getElementById("doing");
        const note = () => heard.push([page.changing, doing.textContent, performance.now()]);
        new MutationObserver(note).observe(doing, {childList: true});
        window.heard = heard;
        window.arrived = page.follow(document.querySelector(arguments[0]).hash)
            .then(() => performance.now());"""
    live.script(source, "a[data-lesson='leaders']")
    live.until("return window.heard.length > 1")
    first, second, *_ = live.script("return heard")
    assert first[1] == ""
    assert second[1].startswith("1 leader: 27 boats")
    assert live.driver.execute_async_script("arrived.then(arguments[0])") > second[2] - 500
    live.script("page.follow(document.querySelector(\"a[data-lesson='steer']\").hash)")
    live.until("return page.other.lesson === 'steer' && !page.changing")
    live.until("return document.getElementById('doing').textContent.startsWith('Clockwise: ')")
    assert len(live.text("#doing")) < 90


def test_a_slider_that_cannot_show_a_value_is_not_read_as_another_one(open_live):
    live = open_live().go("#preset=experiment&n_boats=12&seed=1")
    c4 = float(live.parameters()["c4"])
    live.unfold("#c4")
    assert float(live.find("#c4").get_property("value")) == pytest.approx(c4, abs=1e-6)
    live.script("document.getElementById('c4').focus()")
    live.press("ARROW_RIGHT")
    live.wait()
    moved = float(live.parameters()["c4"])
    assert moved == pytest.approx(round(moved, 2))


FINGERS = """
    document.querySelectorAll("details").forEach((each) => { each.open = true; });
    const controls = [...document.querySelectorAll("main :is(a, button, input, select, summary)")];
    return controls.filter((each) => each.checkVisibility()).flatMap((each) => {
        each.scrollIntoView({block: "center", inline: "center"});
        const box = each.getBoundingClientRect();
        const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
        const own = (dx, dy) => {
            const at = document.elementFromPoint(x + dx, y + dy);
            return at && (each.contains(at) || at.contains(each) && at.matches("label"));
        };
        const tall = own(0, -21) && own(0, 21);
        const wide = box.width >= 44 || own(-21, 0) && own(21, 0);
        return tall && wide ? [] : [each.id || each.textContent];
    })"""


@pytest.mark.parametrize("fragment", ["", "#n_boats=12&n_leaders=2&seed=7&beside.n_leaders=0"])
def test_a_finger_of_44_pixels_hits_what_it_touches(open_live, fragment):
    live = open_live(PHONE).go(fragment)
    assert live.script(FINGERS) == []


def test_a_finger_of_44_pixels_hits_what_every_lesson_has(open_live):
    live = open_live(PHONE).go()
    names = "return [...document.querySelectorAll('#lessons a')].map((a) => a.dataset.lesson)"
    for name in live.script(names):
        live.script("document.querySelector(`a[data-lesson='${arguments[0]}']`).click()", name)
        live.until("return page.other.lesson === arguments[0] && !page.changing", name)
        # The chosen lesson is seen in its row.
        left, right, end = live.script(
            """const [chosen, row] = [`a[data-lesson='${arguments[0]}']`, "#lessons"].map((each) =>
                document.querySelector(each).getBoundingClientRect());
            return [chosen.left - row.left, chosen.right - row.left, row.width]""",
            name,
        )
        assert 0 <= left < right <= end + 1
        assert (name, live.script(FINGERS)) == (name, [])


def test_a_phone_shows_both_means_of_two_flocks(open_live):
    live = open_live(PHONE).go()
    live.script("document.querySelector(\"a[data-lesson='learned']\").click()")
    live.until("return page.other.lesson === 'learned'")
    live.wait()
    live.run_to(20.0)
    means = live.script("return page.runs.map((run) => run.mean('signed_order').toFixed(2))")
    for word in ("left", "right", "Left", "Right"):
        assert word not in live.text("#story").split()
    for shown in (0, 1):
        live.script("document.querySelectorAll('.switch button')[arguments[0]].click()", shown)
        words = live.text(".so-far", shown).replace("−", "-").replace("+", "").split()
        assert [each for each in words if each in means] == means
        right = "return arguments[0].getBoundingClientRect().right"
        assert live.script(right, live.find(".so-far", shown)) <= PHONE[0]


def test_nothing_is_lost_when_a_phone_turns_amid_a_game_or_the_page_is_there_twice(open_live):
    live = open_live(PHONE).go()
    live.script("document.querySelector(\"a[data-lesson='steer']\").click()")
    live.until("return page.other.lesson === 'steer'")
    live.wait()
    live.press("ARROW_RIGHT")
    live.until("return page.runs[0].end > 5")
    resize(live.driver, *PHONE[::-1])
    now, heading = live.script("return [page.runs[0].end, page.helm.value]")
    live.until("return page.runs[0].end > arguments[0] + 5", now)
    assert live.script("return page.helm.value") == heading
    assert live.script("return document.documentElement.scrollWidth <= innerWidth")
    live.driver.switch_to.new_window("tab")
    second = LivePage(live.driver, live.file, PHONE).go(plays=True)
    second.until("return page.runs[0].end > 2")
    assert second.complaints() == []
    live.driver.close()
    live.driver.switch_to.window(live.driver.window_handles[0])
    live.until("return page.runs[0].end > arguments[0] + 10", now)
    assert live.complaints() == []
