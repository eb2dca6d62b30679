"""Law: the live page runs in Firefox as it does in Chromium."""

import contextlib
import itertools
import json
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from typing import Any

import pytest

pytestmark = pytest.mark.live

WAIT_S = 60.0


class Marionette:
    """Firefox's own protocol: messages `[0, number, command, arguments]` with their length."""

    def __init__(self, port: int) -> None:
        self.numbers = itertools.count()
        end = time.monotonic() + WAIT_S
        while True:
            try:
                self.socket = socket.create_connection(("127.0.0.1", port), timeout=WAIT_S)
                break
            except OSError:
                assert time.monotonic() < end, "Firefox does not listen"
                time.sleep(0.2)
        self.stream = self.socket.makefile("rb")
        self._read()
        self("WebDriver:NewSession", {"capabilities": {}})

    def __call__(self, command: str, arguments: dict[str, Any]) -> Any:
        text = json.dumps([0, next(self.numbers), command, arguments]).encode()
        self.socket.sendall(b"%d:%s" % (len(text), text))
        _, _, error, answer = self._read()
        assert error is None, error
        return answer

    def close(self) -> None:
        self.stream.close()
        self.socket.close()

    def _read(self) -> Any:
        length = b""
        while (letter := self.stream.read(1)) != b":":
            length += letter
        return json.loads(self.stream.read(int(length)))

    def script(self, source: str) -> Any:
        arguments = {"script": source, "args": [], "sandbox": None}
        return self("WebDriver:ExecuteScript", arguments)["value"]

    def until(self, source: str) -> None:
        end = time.monotonic() + WAIT_S
        while not self.script(source):
            assert time.monotonic() < end, source
            time.sleep(0.1)

    def press(self, key: str, kind: str) -> None:
        keys = {"type": "key", "id": "keys", "actions": [{"type": kind, "value": key}]}
        self("WebDriver:PerformActions", {"actions": [keys]})


@pytest.fixture
def firefox(tmp_path) -> Iterator[Marionette]:
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if program is None:
        pytest.fail("firefox-esr was not found: `make test-live` installs it")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    (tmp_path / "user.js").write_text(f'user_pref("marionette.port", {port});\n')
    command = [program, "--headless", "--marionette", "--no-remote", "--profile", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            with contextlib.closing(Marionette(port)) as driver:
                yield driver
        finally:
            process.terminate()


def test_it_plays_is_steered_and_draws_the_same_numbers(firefox, file, open_live):
    fragment = "#n_boats=12&n_leaders=2&bw_s=0.3&seed=7&speed=64"
    firefox("WebDriver:Navigate", {"url": file.as_uri() + fragment})
    firefox.until("return document.body.dataset.ready === 'true'")
    firefox.until("return page.runs[0].end > 5")
    source = "return [...{}.runs[0].raw.pose.from(0).slice(30 * 36, 31 * 36)]"
    # Before its oldest samples are forgotten.
    ours = firefox.script(source.format("page"))
    theirs = open_live().go(fragment)
    theirs.run_to(5.0)
    assert len(ours) == 36
    assert ours == theirs.script(source.format("page"))
    # Arrows steer whatever had the focus, such as a choice that they would change.
    firefox.script("page.set('leaders', 'you')")
    firefox.until("return page.flocks.areYours")
    firefox.script("document.getElementById('more').open = true")
    firefox.script("document.getElementById('pool').focus()")
    firefox.press("\ue012", "keyDown")
    firefox.until("return page.helm.value === -15 / 180")
    assert firefox.script("return document.activeElement.id") == "thumb"
    firefox.press("\ue012", "keyUp")
    # The heading stays where it was turned to.
    assert firefox.script("return page.helm.value === -15 / 180")
    assert firefox.script("return document.getElementById('pool').value") == "wide"
    assert firefox.script("return document.getElementById('status').textContent") == ""
