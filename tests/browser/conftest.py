"""A headless Chromium, and the replay page and the live page as one who clicks and reads them."""

import json
import math
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv.replay import write_replay

SIZE = (1366, 768)
PHONE, LAPTOP = (390, 844), (1280, 800)
FLOCK = "#n_boats=12&n_leaders=2&bw_s=0.3&seed=7"
"""A small flock, which is there at once."""
OUTER_CM = 90.0
"""Of the pool of `parameters`."""
# Nothing that a fresh browser does on its own account.
_QUIET = (
    "disable-gpu",
    "disable-quic",
    "no-first-run",
    "disable-background-networking",
    "disable-component-update",
    "disable-sync",
)
LAST_DIGIT = 0.0056
"""Numbers with two decimals, and what they were rounded to in the page."""


@pytest.fixture(scope="session")
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters(n_boats=12, n_leaders=2, pool="narrow", bw_s=0.0)


def program(variable: str, *names: str) -> str:
    wanted = (os.environ.get(variable), *names)
    found = next((path for path in map(shutil.which, filter(None, wanted)) if path), None)
    if found is None:
        pytest.fail(f"{names[0]} was not found: `make test-browser` says what to install")
    return found


@pytest.fixture(scope="session")
def chromium() -> Iterator:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = program("CHROMIUM", "chromium")
    # Containers run as root, where Chromium's own sandbox refuses to start, with little /dev/shm.
    for argument in ("headless=new", "no-sandbox", "disable-dev-shm-usage", *_QUIET):
        options.add_argument(f"--{argument}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    service = Service(program("CHROMEDRIVER", "chromedriver"))
    driver = webdriver.Chrome(options=options, service=service)
    resize(driver, *SIZE)
    yield driver
    driver.quit()


def resize(driver, width: int, height: int) -> None:
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


@pytest.fixture(scope="session")
def law(parameters) -> flockenv.Recording:
    return flockenv.simulate(parameters, 7, 120.0, contacts=True)


@pytest.fixture(scope="session")
def damped(parameters) -> flockenv.Recording:
    return flockenv.simulate(parameters, 7, 90.0, policy="damped law", contacts=True)


@pytest.fixture(scope="session")
def pages(law, damped, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    write_replay(folder / "one.html", {"law": law})
    write_replay(folder / "two.html", {"law": law, "damped": damped})
    return folder


@pytest.fixture
def open_page(chromium) -> Callable[..., "ReplayPage"]:
    def opened(
        path: Path, *, size: tuple[int, int] = SIZE, waits: bool = True, rests: bool = True
    ) -> ReplayPage:
        resize(chromium, *size)
        page = ReplayPage(chromium, path.as_uri(), waits=waits)
        if rests and page.state() == "true":
            page.rest()
        return page

    return opened


@pytest.fixture
def page(open_page, pages) -> "ReplayPage":
    return open_page(pages / "one.html")


@pytest.fixture
def pair(open_page, pages) -> "ReplayPage":
    return open_page(pages / "two.html")


@pytest.fixture
def open_link(chromium) -> Callable[[Path, str], "ReplayPage"]:
    def opened(path: Path, fragment: str) -> ReplayPage:
        resize(chromium, *SIZE)
        return ReplayPage(chromium, path.as_uri() + fragment)

    return opened


class Page:
    """A page in the browser, as one who clicks and reads it."""

    def __init__(self, driver) -> None:
        self.driver = driver

    def open(self, address: str) -> None:
        # From one fragment of a page to another nothing would be loaded.
        self.driver.get("about:blank")
        self.complaints()
        self.driver.get_log("performance")
        self.driver.get(address)

    def script(self, source: str, *arguments):
        return self.driver.execute_script(source, *arguments)

    def until(self, source: str, *arguments):
        # Installed for these tests alone: nothing of it may be needed to collect them.
        from selenium.webdriver.support.ui import WebDriverWait

        wait = WebDriverWait(self.driver, 60, poll_frequency=0.05)
        return wait.until(lambda _: self.script(source, *arguments))

    def state(self) -> str | None:
        return self.script("return document.body.dataset.ready")

    def find(self, selector: str, run: int | None = None):
        scope = "" if run is None else f".run[data-run='{run}'] "
        return self.driver.find_element("css selector", scope + selector)

    def text(self, selector: str, run: int | None = None) -> str:
        return self.find(selector, run).text

    def actions(self):
        from selenium.webdriver.common.action_chains import ActionChains

        return ActionChains(self.driver)

    def press(self, *names: str) -> None:
        from selenium.webdriver.common.keys import Keys

        self.actions().send_keys(*(getattr(Keys, name, name) for name in names)).perform()

    def choose(self, selector: str, value: str) -> None:
        from selenium.webdriver.support.ui import Select

        Select(self.find(selector)).select_by_value(value)

    def complaints(self) -> list[str]:
        return [each["message"] for each in self.driver.get_log("browser")]

    def requested(self) -> list[str]:
        """What the page requested since it was opened, its own address included."""
        log = [json.loads(each["message"]) for each in self.driver.get_log("performance")]
        sent = (each["message"] for each in log)
        return [
            each["params"]["request"]["url"]
            for each in sent
            if each["method"] == "Network.requestWillBeSent"
        ]


@pytest.fixture
def downloads(chromium, tmp_path) -> Path:
    """Return the folder into which the browser saves until the test ends."""
    behavior = {"behavior": "allow", "downloadPath": str(tmp_path), "eventsEnabled": False}
    chromium.execute_cdp_cmd("Browser.setDownloadBehavior", behavior)
    return tmp_path


@pytest.fixture
def emulated(chromium) -> Iterator[Callable[[str, str], None]]:
    """Set a feature of the media, such as a color scheme, until the test ends."""

    def emulate(name: str, value: str) -> None:
        features = [{"name": name, "value": value}]
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})

    yield emulate
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


class ReplayPage(Page):
    def __init__(self, driver, address: str, *, waits: bool = True) -> None:
        super().__init__(driver)
        self.open(address)
        if waits:  # Until the page has started, or failed to.
            self.until("return document.body.dataset.ready")

    def rest(self) -> None:
        """Pause at the start, in real time."""
        self.script("""
            if (player.playing) player.toggle();
            player.controls.speed.value = 1;
            player.seek(player.start)""")
        self.wait_until_drawn()

    def is_playing(self) -> bool:
        return self.find("#play").get_attribute("aria-label") == "Pause"

    def number(self, selector: str, run: int | None = None) -> float:
        return number(self.text(selector, run))

    def time(self) -> float:
        return number(self.text("#clock"))

    def click(self, selector: str) -> None:
        self.find(selector).click()

    def press(self, *names: str) -> None:
        super().press(*names)
        self.wait_until_drawn()

    def choose(self, selector: str, value: str) -> None:
        super().choose(selector, value)
        self.wait_until_drawn()

    def click_at(self, selector: str, share: float) -> None:
        """Click at a share of an element's width, at half its height."""
        element = self.find(selector)
        x = (share - 0.5) * element.size["width"]
        self.actions().move_to_element_with_offset(element, round(x), 0).click().perform()
        self.wait_until_drawn()

    def point_at(self, run: int, x: float, y: float) -> None:
        """Move the pointer to a place on a run's canvas."""
        canvas = self.find("canvas", run)
        x, y = x - canvas.size["width"] / 2, y - canvas.size["height"] / 2
        self.actions().move_to_element_with_offset(canvas, round(x), round(y)).perform()
        self.wait_until_drawn()

    def wait_until_drawn(self) -> None:
        """Wait until the requested picture is drawn."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done))"
        )

    def sample(self, recording: flockenv.Recording) -> int:
        """The recording's sample that is shown."""
        sample = np.searchsorted(recording.time_s, self.time() + 1e-6, side="right") - 1
        return min(int(sample), len(recording) - 1)

    def check(self, recording: flockenv.Recording, run: int = 0) -> None:
        """Check the numbers around a run's picture against its recording."""
        k, order = self.sample(recording), recording.order
        signed = order.signed_order(recording.parameters.target)
        assert self.number(".time", run) == pytest.approx(recording.time_s[k], abs=0.051)
        assert self.number(".psi", run) == pytest.approx(order.psi_o[k], abs=LAST_DIGIT)
        assert self.number(".phi", run) == pytest.approx(order.phi_o[k], abs=LAST_DIGIT)
        assert self.number(".signed", run) == pytest.approx(signed[k], abs=LAST_DIGIT)
        phase = self.find(".phase.now", run).get_attribute("data-phase")
        assert phase == recording.phase[k]

    def place_of(self, recording: flockenv.Recording, boat: int) -> tuple[float, float]:
        """Where a boat is on the first run's canvas."""
        x, y, _ = recording.pose[self.sample(recording), boat]
        return self.pixels(0, x, y)

    def pixels(self, run: int, x_cm: float, y_cm: float) -> tuple[float, float]:
        """Where a point of the pool is on a run's canvas."""
        size = self.find("canvas", run).size
        scale = min(size["width"], size["height"]) * (0.5 - 0.022) / OUTER_CM
        return size["width"] / 2 + x_cm * scale, size["height"] / 2 - y_cm * scale

    def color(self, run: int, x: float, y: float) -> tuple[int, ...]:
        source = """
            const canvas = document.querySelector(`.run[data-run="${arguments[0]}"] canvas`);
            const ratio = canvas.width / canvas.clientWidth;
            const place = [Math.round(arguments[1] * ratio), Math.round(arguments[2] * ratio)];
            return Array.from(canvas.getContext("2d").getImageData(...place, 1, 1).data)"""
        return tuple(self.script(source, run, x, y))[:3]

    def picture(self, selector: str) -> str:
        return self.script("return document.querySelector(arguments[0]).toDataURL()", selector)


def number(text: str) -> float:
    """The number that a text starts with."""
    word = text.split()[0].replace("−", "-")
    return math.nan if word == "–" else float(word)


class LivePage(Page):
    def __init__(self, driver, file: Path, size: tuple[int, int]) -> None:
        super().__init__(driver)
        self.file = file
        resize(driver, *size)

    def go(self, fragment: str = FLOCK, *, plays: bool = False) -> "LivePage":
        self.open(self.file.as_uri() + fragment)
        self.until("return document.body.dataset.ready")
        if not plays and self.script("return window.page?.playing"):
            self.click("#play")
        return self

    def click(self, selector: str) -> None:
        self.unfold(selector)
        source = "document.querySelector(arguments[0]).scrollIntoView({block: 'center'})"
        self.script(source, selector)
        self.find(selector).click()

    def choose(self, selector: str, value: str) -> None:
        self.unfold(selector)
        super().choose(selector, value)
        self.wait()

    def unfold(self, selector: str) -> None:
        """Open what an element is folded in."""
        source = """
            const element = document.querySelector(arguments[0]);
            const folded = element.closest("details");
            if (folded && !element.matches("summary")) folded.open = true;"""
        self.script(source, selector)

    def wait(self) -> None:
        """Wait until the simulator has answered all its questions."""
        self.until(
            "return !page.changing && !page.playback.advancing && page.simulator.open.size === 0"
        )

    def run_to(self, seconds: float) -> None:
        """Let the flock run fast until this time at least, and pause."""
        self.choose("#speed", "64")
        self.click("#play")
        self.until("return page.runs[0].end >= arguments[0]", seconds)
        self.click("#play")
        self.wait()

    def rows(self, name: str, run: int = 0) -> np.ndarray:
        """All samples that the page holds of a column, a row each."""
        source = """
            const run = page.runs[arguments[0]];
            return Array.from(run.raw[arguments[1]].from(0)).concat(run.length)"""
        *numbers, samples = self.script(source, run, name)
        return np.array(numbers).reshape(int(samples), -1)

    def parameters(self, run: int = 0) -> dict[str, str]:
        return self.script("return page.runs[arguments[0]].parameters", run)

    def status(self) -> str:
        return self.text("#status")


@pytest.fixture(scope="session")
def file(pytestconfig) -> Path:
    return pytestconfig.rootpath / "flockenv" / "replay" / "live.html"


@pytest.fixture
def open_live(chromium, file) -> Iterator[Callable[..., LivePage]]:
    yield lambda size=LAPTOP: LivePage(chromium, file, size)
    # Its flock would continue beside the next test.
    chromium.get("about:blank")


@pytest.fixture
def live(open_live) -> LivePage:
    return open_live().go()
