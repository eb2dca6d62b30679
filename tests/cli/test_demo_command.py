"""`flockenv demo`: the two runs of the README, on one page, in one command."""

import json
import os
import subprocess
import sys
from pathlib import Path

import flockenv
from flockenv.replay.demo import DEMO_SCENE

COMMAND = [sys.executable, "-m", "flockenv", "demo"]


def demo(folder: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    plain = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.run(
        [*COMMAND, *arguments],
        cwd=folder,
        env={**plain, "COLUMNS": "80", **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def test_both_runs_are_those_of_simulate(tmp_path: Path) -> None:
    done = demo(tmp_path, "--minutes", "1", "--no-open", "--json")
    assert done.stderr == ""
    reported = json.loads(done.stdout)
    assert (tmp_path / reported["html"]).stat().st_size > 100_000
    assert list(reported["runs"]) == ["paper's law", "learned"]
    for name, policy in (("paper's law", "law"), ("learned", "learned")):
        run = flockenv.simulate(DEMO_SCENE, 7, 60.0, policy=policy)
        late = run.in_analysis_window & (run.time_s > 6.0)
        assert reported["runs"][name]["signed_order"] == run.order.signed_order("cw")[late].mean()


def test_without_a_browser_it_says_where_the_page_is(tmp_path: Path) -> None:
    done = demo(tmp_path, "--minutes", "0.2", "-q", BROWSER="")
    assert done.returncode == 0
    page = tmp_path / "results" / "demo.html"
    assert page.resolve().as_uri() in done.stderr
    assert "order towards target" in done.stdout


def test_the_page_is_opened_unless_it_is_not_wanted(tmp_path: Path) -> None:
    browser = tmp_path / "browser.sh"
    browser.write_text(f'#!/bin/sh\necho "$1" >> {tmp_path}/opened\n')
    browser.chmod(0o755)
    quick = ["--minutes", "0.2", "-q", "--out", "page.html"]
    assert demo(tmp_path, *quick, "--no-open", BROWSER=f"{browser} %s").returncode == 0
    assert not (tmp_path / "opened").exists()
    done = demo(tmp_path, *quick, BROWSER=f"{browser} %s")
    assert done.stderr == ""
    assert (tmp_path / "opened").read_text().strip() == (tmp_path / "page.html").as_uri()
