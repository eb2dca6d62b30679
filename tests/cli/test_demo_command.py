"""`flockenv demo`: the two runs of the README, on one page, in one command."""

import json
from importlib import import_module
from pathlib import Path

import pytest

import flockenv
from flockenv.replay.demo import DEMO_PARAMETERS

NO_SCREEN = {"DISPLAY": None, "WAYLAND_DISPLAY": None}


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_both_runs_are_those_of_simulate(cli, page_runs, tmp_path: Path) -> None:
    done = cli("demo", "--minutes", "1", "--no-open", "--json")
    assert done.stderr == ""
    reported = json.loads(done.stdout)
    names = ("paper's law", "learned")
    assert page_runs(tmp_path / reported["html"]) == [(name, "7", 601, 27) for name in names]
    assert list(reported["runs"]) == ["paper's law", "learned"]
    for name, policy in (("paper's law", None), ("learned", "learned")):
        run = flockenv.simulate(DEMO_PARAMETERS, 7, 60.0, policy=policy)
        late = run.in_analysis_window & (run.time_s > 6.0)
        assert (
            reported["runs"][name]["signed_order_mean"] == run.order.signed_order("cw")[late].mean()
        )


def test_without_a_browser_it_says_where_the_page_is(cli, tmp_path: Path) -> None:
    done = cli.process("demo", "--minutes", "0.2", "-q", BROWSER="", **NO_SCREEN)
    assert done.returncode == 0
    page = tmp_path / "results" / "demo.html"
    assert page.resolve().as_uri() in done.stderr


def test_the_page_is_opened_unless_it_is_not_wanted(cli, tmp_path: Path) -> None:
    browser = tmp_path / "browser.sh"
    browser.write_text(f'#!/bin/sh\necho "$1" >> {tmp_path}/opened\n')
    browser.chmod(0o755)
    quick = ["--minutes", "0.2", "-q", "--out", "page.html"]
    opened_by = {"BROWSER": f"{browser} %s", **NO_SCREEN}
    assert cli.process("demo", *quick, "--no-open", **opened_by).returncode == 0
    assert not (tmp_path / "opened").exists()
    done = cli.process("demo", *quick, **opened_by)
    assert done.stderr == ""
    assert (tmp_path / "opened").read_text().strip() == (tmp_path / "page.html").as_uri()


def test_where_the_live_page_is_built_it_opens_with_the_two_flocks(
    cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built = tmp_path / "live.html"
    built.write_text('<script>{"version": "0", "opening": null}</script>')
    monkeypatch.setattr("flockenv.replay.demo.live_page", lambda: built)
    opened = []
    monkeypatch.setattr(import_module("flockenv.cli.demo"), "open_page", opened.append)
    done = cli("demo", "--seed", "11", "--out", "page.html")
    assert "Written to page.html" in done.stdout
    assert opened == [Path("page.html")]
    page = Path("page.html").read_text()
    link = json.loads(page.removeprefix("<script>").removesuffix("</script>"))["opening"]
    assert "n_boats=27&n_leaders=4&pool=wide&bw_s=0.3&seed=11" in link
    assert "beside.leaders=" in link
    done = cli("demo", "--minutes", "0.2", "--out", "recorded.html")
    assert "paper's law: " in done.stdout
    assert opened[1:] == [Path("recorded.html")]
    assert "n_boats=27&n_leaders=4" not in Path("recorded.html").read_text()
