"""Write docs/replay.webp and its still: pictures of the replay page in headless Chromium."""

import io
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import Select, WebDriverWait

import flockenv
from flockenv.replay import write_replay

PARAMETERS = flockenv.FlockParameters(n_boats=27, n_leaders=4, pool="wide", bw_s=0.3)
SEED, DURATION_S = 7, 480.0
POLICIES = {"paper's law": None, "learned": "learned"}
SIZE = (1160, 960)
# The part of the page with the flocks and their order, without controls and charts.
CROP = (0, 0, 1160, 604)
STYLE = """
    #watch, .origin, .corner.top, .corner.bottom.left { display: none }
    h2 { font-size: 26px; justify-content: center }
    .corner { grid-column: 1 / -1; font-size: 22px; text-align: center }
    .corner .gauge { width: 100%; height: 10px }
    .signed { display: none }
"""
START_S, STEP_S, FRAMES, FPS = 150.0, 0.4, 60, 10.0


def main() -> None:
    """Record the runs, write the page, and take pictures of it."""
    runs = {
        name: flockenv.simulate(PARAMETERS, SEED, DURATION_S, policy=policy, contacts=True)
        for name, policy in POLICIES.items()
    }
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "replay.html")
        write_replay(page, runs)
        first, *others = frames(page)
    folder = Path(__file__).parents[1]
    first.save(
        folder / "replay.webp",
        save_all=True,
        append_images=others,
        duration=round(1000 / FPS),
        loop=0,
        quality=50,
        method=6,
    )
    # The still is for systems that ask for less motion.
    others[-1].save(folder / "replay-still.webp", quality=70)


def frames(page: Path) -> Iterator[Image.Image]:
    """Yield pictures of the page as it plays."""
    driver = chromium()
    try:
        driver.get(page.as_uri())
        WebDriverWait(driver, 20).until(
            lambda d: d.execute_script("return document.body.dataset.ready")
        )
        # The page's policy allows no other style element.
        driver.execute_script(
            "const style = new CSSStyleSheet(); style.replaceSync(arguments[0]);"
            "document.adoptedStyleSheets = [style];",
            STYLE,
        )
        Select(driver.find_element("id", "speed")).select_by_value(f"{STEP_S * FPS:g}")
        Select(driver.find_element("id", "trails")).select_by_value("5")
        # The page plays in real time, but these frames are taken at fixed times of the recording.
        driver.execute_script("document.activeElement.blur(); player.toggle()")
        for frame in range(FRAMES):
            driver.execute_script(
                "player.seek(arguments[0]); player.show()", START_S + STEP_S * frame
            )
            picture = Image.open(io.BytesIO(driver.get_screenshot_as_png()))
            yield picture.crop(CROP).convert("RGB")
    finally:
        driver.quit()


def chromium() -> webdriver.Chrome:
    """Return a headless Chromium with a window of the picture's size."""
    options = webdriver.ChromeOptions()
    options.binary_location = program("CHROMIUM", "chromium")
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--hide-scrollbars",
    ):
        options.add_argument(argument)
    driver = webdriver.Chrome(
        options=options, service=Service(program("CHROMEDRIVER", "chromedriver"))
    )
    width, height = SIZE
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    return driver


def program(variable: str, name: str) -> str:
    """Return a program's path; `tests/browser/need_chromium.sh` checks that it is installed."""
    return shutil.which(os.environ.get(variable, name)) or name


if __name__ == "__main__":
    main()
