"""Law: the live page saves and loads recordings, and refuses what is none in words."""

import base64

import numpy as np
import pytest

import flockenv

pytestmark = pytest.mark.live


def shown_statistics(live) -> dict[str, float]:
    """Return what the parameters of the page say of the substeps of the first run."""
    live.script("document.getElementById('about-flock').open = true")
    live.until("return document.querySelectorAll('#statistics tr').length > 0")
    rows = live.script(
        """return [...document.querySelectorAll('#statistics tr')].map(
            (row) => [...row.children].slice(0, 2).map((cell) => cell.textContent))"""
    )
    return {name: float(value) for name, value in rows}


def test_a_recording_is_saved_loaded_and_played(live, downloads):
    from selenium.webdriver.support.ui import WebDriverWait

    live.run_to(8.0)
    live.script("document.getElementById('take').open = true")
    live.click("#save")
    saved = downloads / "flock.npz"
    WebDriverWait(live.driver, 30).until(lambda _: saved.exists() and saved.stat().st_size > 0)
    recording = flockenv.Recording.load(saved)
    native = flockenv.simulate(recording.parameters, 7, recording.duration_s)
    assert recording.parameters == flockenv.FlockParameters(n_boats=12, n_leaders=2, bw_s=0.3)
    assert recording == native
    assert recording.statistics.worst_overlap_cm > 0.0
    assert type(recording.statistics.unsolved) is int
    # Times, and the file that Python writes, are played alike.
    packed = downloads / "packed.npz"
    recording.save(packed, compressed=True)
    for file in (saved, packed):
        live.go()
        live.script("document.getElementById('take').open = true")
        live.find("#open").send_keys(str(file))
        live.until("return page.recorded")
        assert file.name in live.status()
        assert np.array_equal(live.rows("pose").reshape(-1, 12, 3), recording.pose)
        assert live.find("#scrub").is_displayed()
        live.choose("#speed", "64")
        live.click("#play")
        live.until("return !page.playing")
        assert live.script("return page.time") == pytest.approx(recording.time_s[-1])
        assert shown_statistics(live) == {
            name: pytest.approx(value, rel=5e-3)
            for name, value in vars(recording.statistics).items()
        }
        assert live.complaints() == []
    live.click("#again")
    live.wait()
    assert not live.script("return page.recorded")
    assert live.parameters()["n_boats"] == "12"


DROP = """
    const [name, text] = arguments;
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const data = new DataTransfer();
    data.items.add(new File([bytes], name));
    const options = {bubbles: true, cancelable: true, dataTransfer: data};
    document.body.dispatchEvent(new DragEvent("drop", options))"""


@pytest.fixture
def recording(tmp_path) -> flockenv.Recording:
    parameters = flockenv.FlockParameters(n_boats=5, n_leaders=1)
    recording = flockenv.simulate(parameters, 3, 4.0, contacts=True)
    recording.save(tmp_path / "dropped.npz")
    return recording


@pytest.mark.parametrize("lesson", ["steer", "learned", "train", "forces"])
def test_a_file_is_dropped_onto_a_lesson_and_its_flocks_come_back(
    live, tmp_path, recording, lesson
):
    live.script("document.querySelector(`a[data-lesson='${arguments[0]}']`).click()", lesson)
    live.until("return page.other.lesson === arguments[0] && !page.changing", lesson)
    live.script("if (!page.playing) page.toggle()")
    flocks = live.script("return page.runs.length")
    seen = len(live.driver.find_elements("css selector", ".run canvas"))
    content = (tmp_path / "dropped.npz").read_bytes()
    live.script(DROP, "dropped.npz", base64.b64encode(content).decode())
    live.until("return document.getElementById('status').textContent.startsWith('dropped.npz')")
    waits = "dropped.npz waits for “play”. “Again” returns to the flock where it was."
    assert live.status() == waits
    assert live.text("#story").startswith("This is a recording, from a file.")
    assert len(live.driver.find_elements("css selector", ".run canvas")) == 1
    assert np.array_equal(live.rows("pose").reshape(-1, 5, 3), recording.pose)
    live.click("#play")
    live.until("return page.time > 1")
    live.click("#again")
    live.until("return !page.recorded")
    assert live.script("return page.runs.length") == flocks
    assert len(live.driver.find_elements("css selector", ".run canvas")) == seen
    assert live.complaints() == []


@pytest.mark.parametrize("lesson", [None, "steer"])
def test_a_flock_goes_on_where_it_was_after_a_recording(live, tmp_path, recording, lesson):
    """The same flock, bit for bit, as without the recording: nothing of it is lost."""
    if lesson:
        live.script("document.querySelector(`a[data-lesson='${arguments[0]}']`).click()", lesson)
        live.until("return page.other.lesson === arguments[0] && !page.changing", lesson)
        live.script("document.activeElement.blur()")
        live.press("ARROW_RIGHT")
    else:
        live.click("#play")
    live.until("return page.time > 20")
    content = base64.b64encode((tmp_path / "dropped.npz").read_bytes()).decode()
    live.script(DROP, "dropped.npz", content)
    live.until("return page.recorded")
    live.script("document.getElementById('take').open = true")
    assert not live.find("[data-copies='address']").is_displayed()
    # The mean is that until the time of the picture.
    for time_s in (1.0, 3.0):
        live.script("page.seek(arguments[0])", time_s)
        counted = recording.in_analysis_window & (recording.time_s <= time_s + 1e-9)
        mean = recording.order.signed_order("cw")[counted].mean() if counted.any() else np.nan
        shown = live.text(".so-far b").replace("−", "-")
        assert shown == ("–" if np.isnan(mean) else f"{mean:+.2f}")
    heading = live.script("return page.helm.value")
    live.click("#again")
    live.until("return !page.recorded")
    assert live.script("return page.time") > 20
    assert live.script("return [page.playing, page.helm.value]") == [True, heading]
    live.until("return page.time > 26")
    live.click("#play")
    live.wait()
    assert np.allclose(np.diff(live.rows("time_s")[:, 0]), 0.1)
    if not lesson:
        pose = live.rows("pose")
        parameters = flockenv.FlockParameters(n_boats=12, n_leaders=2, bw_s=0.3)
        native = flockenv.simulate(parameters, 7, live.script("return page.runs[0].end"))
        assert np.array_equal(native.pose.reshape(len(native), -1), pose)
    assert live.complaints() == []


def test_a_file_is_dropped_onto_the_page(live, tmp_path, recording):
    for name, content in (("dropped.npz", None), ("picture.png", b"\x89PNG\r\n"), ("a", b"")):
        content = (tmp_path / name).read_bytes() if content is None else content
        live.script(DROP, name, base64.b64encode(content).decode())
        live.until(
            "return document.getElementById('status').textContent.startsWith(arguments[0])", name
        )
        assert ("is not an .npz file" in live.status()) == (name != "dropped.npz")
    # What was shown before stays.
    assert np.array_equal(live.rows("pose").reshape(-1, 5, 3), recording.pose)
    # Text that is dropped, not a file, is ignored.
    live.script("document.body.dispatchEvent(new DragEvent('drop', {bubbles: true}))")
    assert live.complaints() == []


def test_what_is_no_recording_is_refused_in_words(live, tmp_path):
    files = {
        "text.npz": b"<script>alert(1)</script>",
        "empty.npz": b"",
        "half.npz": None,
        "other.npz": None,
    }
    recording = flockenv.simulate(flockenv.FlockParameters(n_boats=3), 1, 1.0)
    recording.save(tmp_path / "whole.npz")
    files["half.npz"] = (tmp_path / "whole.npz").read_bytes()[:2000]
    np.savez(tmp_path / "arrays.npz", a=np.zeros(3))
    files["other.npz"] = (tmp_path / "arrays.npz").read_bytes()
    live.script("document.getElementById('take').open = true")
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
        live.find("#open").send_keys(str(tmp_path / name))
        live.until(
            "return document.getElementById('status').textContent.startsWith(arguments[0])", name
        )
        why = {
            "half.npz": "is not a complete, undamaged .npz file: its end is missing.",
            "other.npz": "is not a recording",
        }
        assert live.status().startswith(f"{name} {why.get(name, 'is not an .npz file')}")
        assert not live.script("return page.recorded")
    live.run_to(2.0)
    assert live.complaints() == []
