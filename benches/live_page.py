"""Measure the live page in headless Chromium: its start, its frames, and its memory in a long run.

`make live`, then `python benches/live_page.py`; `--minutes 60` lets it run for an hour after that.
"""

import argparse
import os
import statistics
import sys
import threading
import time
from contextlib import suppress
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

WEB = Path(__file__).parents[1] / "flockenv" / "replay"
LOADS = 9
SECONDS = 15.0
DONE = ("simulating", "drawing")
FLOCK = "#n_leaders=4&bw_s=0.3&seed=7"
LESSONS = ("noise", "leaders", "learned", "forces", "opposed")
# Scenes of the long run, a minute each, repeated.
SCENES = (*LESSONS, f"{FLOCK}&n_boats=27&leaders=you&speed=8", f"{FLOCK}&n_boats=300&speed=max")
# Stores when the first picture with a flock was drawn, in ms since the page was requested.
WATCH = """
    const watch = new MutationObserver(() => {
      if (document.body?.dataset.ready) {
        watch.disconnect();
        const note = () => { window.shownAt = performance.now(); };
        requestAnimationFrame(() => requestAnimationFrame(note));
      }
    });
    watch.observe(document, {subtree: true, childList: true, attributes: true});"""


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


def served() -> str:
    """Serve the page from this machine, and return its address."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=WEB))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/live.html"


def browser() -> webdriver.Chrome:
    options = webdriver.ChromeOptions()
    options.binary_location = os.environ.get("CHROMIUM", "/usr/bin/chromium")
    for argument in ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu"):
        options.add_argument(f"--{argument}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(
        options, Service(os.environ.get("CHROMEDRIVER", "/usr/bin/chromedriver"))
    )
    size = {"width": 1280, "height": 800, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    return driver


def until(driver: webdriver.Chrome, source: str) -> Any:
    return WebDriverWait(driver, 60).until(lambda _: driver.execute_script(source))


def starts(driver: webdriver.Chrome, address: str) -> list[float]:
    """Return the time in ms from the request to the first flock on the screen, for each load."""
    watch = driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": WATCH})
    driver.execute_cdp_cmd("Network.setCacheDisabled", {"cacheDisabled": True})
    times_ms = []
    for _ in range(LOADS):
        driver.get("about:blank")
        driver.get(address)
        times_ms.append(float(until(driver, "return window.shownAt")))
    driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", watch)
    return times_ms


def processor_ms(driver: webdriver.Chrome) -> dict[str, float]:
    """Return the processor time in ms of the browser's threads, by what they do."""
    tick_ms = 1000 / os.sysconf("SC_CLK_TCK")
    parents, spent = {}, dict.fromkeys(("simulating", "drawing", "painting"), 0.0)
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            parents[int(stat.parent.name)] = int(stat.read_text().rsplit(")", 1)[1].split()[1])
    processes = {driver.service.process.pid}
    while children := {c for c, parent in parents.items() if parent in processes} - processes:
        processes |= children
    for thread in (stat for pid in processes for stat in Path(f"/proc/{pid}/task").glob("*/stat")):
        with suppress(OSError):
            name, numbers = thread.read_text().split("(", 1)[1].rsplit(")", 1)
            pid, number = thread.parts[2], thread.parts[4]
            is_page = (
                pid == number and b"--type=renderer" in Path(f"/proc/{pid}/cmdline").read_bytes()
            )
            kind = "simulating" if name.startswith("DedicatedWorker") else "painting"
            spent["drawing" if is_page else kind] += tick_ms * sum(map(int, numbers.split()[11:13]))
    return spent


def frames(driver: webdriver.Chrome, address: str, boats: int) -> dict[str, float]:
    """Return rates and costs of frames with this number of boats at eight times real time."""
    driver.get("about:blank")
    driver.get(f"{address}{FLOCK}&n_boats={boats}&speed=8")
    until(driver, "return document.body.dataset.ready && page.time > 4")
    note = "return [performance.now(), page.time, page.playback.costs]"
    before, time_before, _ = driver.execute_script(
        f"page.playback.costs = {{frames: 0, drawing: 0, simulating: 0, memory: 0}}; {note}"
    )
    spent = processor_ms(driver)
    time.sleep(SECONDS)
    spent_later = processor_ms(driver)
    after, time_after, costs = driver.execute_script(note)
    return {
        "frames per second": 1000 * costs["frames"] / (after - before),
        "times real time": 1000 * (time_after - time_before) / (after - before),
        **{f"ms of {kind} per frame": costs[kind] / costs["frames"] for kind in DONE},
        **{
            f"processor's ms of {kind}": (spent_later[kind] - spent[kind]) / costs["frames"]
            for kind in spent
        },
    }


def memory(driver: webdriver.Chrome) -> tuple[float, float]:
    """Return the memory in MB of the page's objects, without garbage, and of the simulator."""
    driver.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
    metrics = driver.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    used = next(metric["value"] for metric in metrics if metric["name"] == "JSHeapUsedSize")
    return used / 1e6, driver.execute_script("return page.playback.costs.memory") / 1e6


def soak(driver: webdriver.Chrome, address: str, minutes: int) -> None:
    """Run the page, with another scene each minute, and print its memory; stop at an error."""
    driver.execute_cdp_cmd("Performance.enable", {})
    driver.get("about:blank")
    driver.get(address)
    until(driver, "return document.body.dataset.ready")
    total = 0.0
    for minute in range(minutes):
        scene = SCENES[minute % len(SCENES)]
        click = "document.querySelector(`#lessons a[data-lesson='${arguments[0]}']`).click()"
        follow = "location.hash = arguments[0]"
        driver.execute_script(click if scene in LESSONS else follow, scene)
        end = time.monotonic() + 60.0
        turn = "document.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}))"
        driver.execute_script(f"{turn}; page.set('bw_s', '0.5')")
        if not driver.execute_script("return page.playing"):
            driver.execute_script("page.toggle()")
        time.sleep(max(end - time.monotonic(), 0.0))
        simulated = driver.execute_script("return page.runs[0].end")
        total += simulated
        used, compiled = memory(driver)
        sys.stdout.write(
            f"minute {minute + 1:3d}  {used:6.2f} MB of objects  {compiled:6.2f} MB of simulator  "
            f"{simulated:9.1f} s  {scene}\n"
        )
        sys.stdout.flush()
        complaints = driver.get_log("browser")
        if complaints or not simulated > 0.0:
            raise SystemExit(f"after {minute + 1} minutes: {complaints}")
    sys.stdout.write(f"no complaint in {minutes} minutes, {total:.0f} s simulated\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=int, default=0, help="length of the long run")
    minutes = parser.parse_args().minutes
    driver = browser()
    try:
        address = served()
        sys.stdout.write(
            f"{(WEB / 'live.html').stat().st_size} bytes, load {os.getloadavg()[0]:.1f}\n"
        )
        shown = starts(driver, address)
        sys.stdout.write(
            f"on the screen after {statistics.median(shown):.0f} ms "
            f"({min(shown):.0f} to {max(shown):.0f})\n"
        )
        for boats in (27, 300):
            costs = frames(driver, address, boats)
            words = ", ".join(f"{value:.1f} {name}" for name, value in costs.items())
            sys.stdout.write(f"{boats} boats: {words}\n")
        soak(driver, address, minutes) if minutes else None
    finally:
        driver.quit()


if __name__ == "__main__":
    main()
