"""Law: what a replay draws has the place, length and color of what it shows; no words are cut."""

import numpy as np
import pytest

import flockenv
from flockenv import rendering
from flockenv.replay import write_replay

pytestmark = pytest.mark.browser

NORMAL, LEADER, FORCE = (0x00, 0x72, 0xB2), (0xF0, 0xA2, 0x02), (0xC2, 0x18, 0x5B)


def test_boats_are_drawn_where_they_are(page, law):
    page.choose("#trails", "0")
    seen = set()
    for share in (0.2, 0.6):
        page.click_at("#scrub", share)
        page.press("ARROW_LEFT")
        k = page.sample(law)
        frame = rendering.frame(law, float(law.time_s[k]), 900, 900)
        for colors in ("direction", "role"):
            page.choose("#colors", colors)
            for boat, (x, y, heading) in enumerate(law.pose[k]):
                # Towards the stern there is no direction mark.
                stern = (x - 4 * np.cos(heading), y - 4 * np.sin(heading))
                color = page.color(0, *page.pixels(0, *stern))
                if colors == "role":
                    assert color == (LEADER if boat < 2 else NORMAL)
                else:
                    # As in frames, where 47 % of the side are the pool's radius.
                    column, row = (450 + 0.47 * 900 / 90 * np.array([1, -1]) * stern).astype(int)
                    assert color == tuple(frame[row, column])
                    seen.add(color)
    assert len(seen) == 3


def test_a_switch_of_colors_has_a_key_and_a_legend(page):
    assert page.text("#color-key") == "clockwise\ncounter-clockwise\nneither, as in a jam"
    before = page.picture(".run canvas")
    page.press("c")
    assert page.find("#colors").get_attribute("value") == "role"
    assert page.picture(".run canvas") != before
    assert not page.find("#color-key").is_displayed()
    page.press("c")
    assert page.picture(".run canvas") == before


def test_a_forces_drawn_area_reports_its_size(page, law):
    """A bar is less than half a boat long, and wider for what is more."""
    page.choose("#trails", "0")
    page.click("#forces")
    page.wait_until_drawn()
    hull_px = 2 * law.parameters.boat_radius_cm * page.script("return player.panels[0].scene.scale")
    scale = page.script("return player.forceScale")
    assert page.text(".force-key", 0) == f"force {scale:g} cm/s²"
    key = page.find(".force-bar", 0).size
    assert (key["width"], key["height"]) == pytest.approx((0.5 * hull_px, 0.2 * hull_px), abs=1.0)
    sample = np.repeat(np.arange(len(law)), law.contacts.count)
    points = law.contacts.point_cm
    # Bars of other contacts must not lie across.
    near = [
        np.hypot(*(points[sample == k] - p).T) < 40.0 for k, p in zip(sample, points, strict=True)
    ]
    alone = np.flatnonzero([each.sum() == 1 for each in near])
    longest = 0.45 * (1.0 + law.parameters.boat_shape)
    shown = []
    for force in np.linspace(0.5, 3.0, 6) * scale:
        c = alone[np.abs(law.contacts.force[alone] - force).argmin()]
        page.script("player.seek(arguments[0]); player.show()", law.time_s[sample[c]])
        start = np.array(page.pixels(0, *map(float, points[c])))
        normal = law.contacts.normal[c] * (1, -1)
        places = np.arange(0.0, 6.0 * hull_px, 0.5)[:, None]
        along = start + places * normal
        across = start + 0.2 * hull_px * normal + (places - 3.0 * hull_px) * (-normal[1], normal[0])
        # From the contact, and from edge to edge: a mark may lie on the bar between.
        (_, end), (left, right) = (
            0.5 * np.flatnonzero([page.color(0, *at) == FORCE for at in line])[[0, -1]]
            for line in (along, across)
        )
        shown.append((0.5 * float(law.contacts.force[c]) / scale, end, right - left))
    assert min(shown)[0] < longest < max(shown)[0]
    for widths, length, width in shown:
        assert length == pytest.approx(hull_px * min(widths, longest), abs=2.0)
        # Both edges are blended with the mark around the bar.
        assert 0.0 <= 0.2 * hull_px * max(widths / longest, 1.0) - width < 3.0


def test_trails_can_be_switched_off(page):
    page.press("END")
    with_trails = page.picture(".run canvas")
    page.choose("#trails", "0")
    assert page.picture(".run canvas") != with_trails


def test_phases_are_words_with_a_title(page, law):
    words = [each.text for each in page.driver.find_elements("css selector", ".phase")]
    assert words == ["forward", "off", "backward", "off"]
    assert page.text(".phases").startswith("motors")
    for name in ("fw", "nop1", "bw", "nop2"):
        title = page.find(f".phase[data-phase={name}]").get_attribute("title")
        assert title.startswith(f"{name}, {getattr(law.parameters, name + '_s')} s: the motors")


@pytest.mark.parametrize("size", [(1440, 900), (900, 638), (768, 1024), (390, 844), (320, 640)])
@pytest.mark.parametrize("name", ["one", "two", "long"])
def test_no_words_are_cut(open_page, law, pages, tmp_path, name, size):
    path = pages / f"{name}.html"
    if name == "long":
        path = tmp_path / "long.html"
        write_replay(path, {"a_name_without_a_space_" * 8: law, "many words in a name " * 9: law})
    page = open_page(path, size=size)
    page.script("player.pin(0); document.getElementById('about').open = true")
    page.wait_until_drawn()
    cut = page.script("""
        const isCut = (each) => each.clientWidth > 0 && each.scrollWidth > each.clientWidth + 1
            || each.getBoundingClientRect().right > innerWidth + 1
            || getComputedStyle(each).textOverflow === "ellipsis";
        return [...document.querySelectorAll("main *")]
            .filter((each) => !each.closest(".unseen, select, svg, table"))
            .filter((each) => each.innerText?.trim() && isCut(each))
            .map((each) => each.outerHTML)""")
    assert cut == []
    assert page.script("return document.documentElement.scrollWidth") <= size[0]
    sizes = page.script("""
        return [...document.querySelectorAll("main *")].filter((each) => each.innerText?.trim())
            .map((each) => parseFloat(getComputedStyle(each).fontSize))""")
    assert min(sizes) >= 11


@pytest.mark.parametrize("size", [(1440, 900), (768, 1024), (390, 844)])
@pytest.mark.parametrize("name", ["one", "two"])
def test_a_boats_card_covers_no_words_and_no_water(open_page, pages, name, size):
    page = open_page(pages / f"{name}.html", size=size)
    for time_s in (20, 80):
        for boat in (0, 5):
            page.script("player.seek(arguments[0]); player.pin(arguments[1])", time_s, boat)
            page.wait_until_drawn()
            covered, farthest, hole, is_below = page.script("""
                const [card, ...corners] = [".card", ...["top", "bottom"].flatMap((side) =>
                    ["left", "right"].map((end) => `.corner.${side}.${end}`))]
                    .map((name) => document.querySelector(name).getBoundingClientRect());
                const [panel] = player.panels;
                const canvas = panel.canvas.getBoundingClientRect();
                const [x, y] = panel.scene.pixel(0, 0);
                const [left, top] = [canvas.left + x, canvas.top + y];
                const away = (right, down) => Math.hypot(right - left, down - top);
                return [corners.filter((each) => each.right > card.left && each.left < card.right
                    && each.bottom > card.top && each.top < card.bottom).length,
                    Math.max(away(card.left, card.top), away(card.right, card.bottom)),
                    panel.run.lengths.inner_radius_cm * panel.scene.scale,
                    card.top >= canvas.bottom]""")
            assert covered == 0, f"boat {boat} at {time_s} s"
            assert is_below or farthest <= hole + 1
    # Large pictures have room in the hole.
    assert not is_below or size != (1440, 900) or name == "two"


def test_two_runs_have_their_charts_above_the_fold(open_page, pages):
    page = open_page(pages / "two.html", size=(1280, 800))
    assert (
        page.script("return document.getElementById('charts').getBoundingClientRect().bottom") < 800
    )


def test_a_phone_shows_one_of_two_runs(open_page, pages):
    page = open_page(pages / "two.html", size=(390, 844))
    assert not page.find("#forces").is_selected()
    for shown in (1, 0):
        page.click(f".switch button:nth-child({shown + 1})")
        page.wait_until_drawn()
        seen = [page.find("canvas", run).is_displayed() for run in (0, 1)]
        assert seen == [shown == 0, shown == 1]
        assert (
            page.script(
                "return document.querySelectorAll('.run canvas')[arguments[0]].width", shown
            )
            > 300
        )


def test_nothing_is_aimed_at_without_leaders(open_page, parameters, tmp_path):
    run = flockenv.simulate(parameters.replace(n_leaders=0, pool="wide"), 7, 30.0)
    write_replay(tmp_path / "free.html", run)
    page = open_page(tmp_path / "free.html")
    assert "target" not in page.text("main")
    assert page.find("#quantity").get_attribute("value") == "rotation"
    page.press("END")
    assert page.number(".signed", 0) == pytest.approx(run.order.rotation()[-1], abs=0.0056)
    assert "rotation" in page.text(".bottom.right", 0)
    arrow = page.script("return player.palette.target")
    target = tuple(int(arrow[k : k + 2], 16) for k in (1, 3, 5))
    assert target not in ring(page)
    led = flockenv.simulate(parameters.replace(pool="wide"), 7, 1.0)
    write_replay(tmp_path / "led.html", {"led": led, "free": run})
    pair = open_page(tmp_path / "led.html")
    assert target in ring(pair)
    assert [
        len(pair.driver.find_elements("css selector", f"[data-run='{k}'] .target")) for k in (0, 1)
    ] == [1, 0]


def ring(page) -> set[tuple[int, ...]]:
    """Colors where a run's arrow is, in the middle of its pool."""
    scale = page.script("return player.panels[0].scene.scale")
    inner = page.script("return player.runs[0].lengths.inner_radius_cm")
    x, y = page.script("return player.panels[0].scene.pixel(0, 0)")
    angles = np.linspace(0, 2 * np.pi, 40)
    radius = 0.66 * inner * scale
    return {page.color(0, x + radius * np.cos(a), y + radius * np.sin(a)) for a in angles}
