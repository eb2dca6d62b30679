"""Law: a page is one file that loads nothing, holds its size, and says what was recorded."""

import base64
import hashlib
import json
import re

import numpy as np
import pytest

import flockenv
from flockenv.policies.names import LAWS
from flockenv.replay import MOST_BYTES, page, write_replay

PARAMETERS = flockenv.FlockParameters(n_boats=27, n_leaders=3, bw_s=0.3)


@pytest.fixture(scope="module")
def hour():
    return flockenv.simulate(PARAMETERS, 7, 3600.0, contacts=True)


def test_two_hours_side_by_side_are_under_the_limit_with_every_sample(hour, tmp_path):
    written = write_replay(tmp_path / "pair.html", {"a": hour, "b": hour})
    assert written.size == (tmp_path / "pair.html").stat().st_size < MOST_BYTES
    assert written.every == 1


def test_what_does_not_fit_is_thinned(hour, tmp_path, monkeypatch):
    monkeypatch.setattr(page, "MOST_BYTES", 2_000_000)
    written = write_replay(tmp_path / "thin.html", {"thin": hour})
    assert written.size <= 2_000_000
    assert written.every > 1
    monkeypatch.setattr(page, "MOST_BYTES", 10_000)
    with pytest.raises(flockenv.ParameterError, match="do not fit a page of 10000 bytes"):
        write_replay(tmp_path / "none.html", {"none": hour})
    assert not (tmp_path / "none.html").exists()


def test_nothing_is_loaded_and_only_its_own_script_runs(tmp_path):
    write_replay(tmp_path / "run.html", {"run": flockenv.simulate(PARAMETERS, 7, 1.0)})
    text = (tmp_path / "run.html").read_text("utf-8")
    assert re.findall(r"https?:|//[a-z]+\.|@import|url\(", text) == []
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert "default-src 'none'" in policy
    script = re.search(r'<script type="module">(.*?)</script>', text, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy
    assert re.findall(r"^(?:import|export)\b.*", script, re.MULTILINE) == []


def test_words_cannot_leave_their_place(tmp_path):
    run = flockenv.simulate(PARAMETERS, 7, 1.0)
    write_replay(tmp_path / "run.html", {"</script><b>&{{script}}": run})
    text = (tmp_path / "run.html").read_text("utf-8")
    assert text.count("</script>") == 2
    assert "<b>" not in text
    assert text.count("class Player") == 1


@pytest.mark.parametrize("law", LAWS)
def test_a_page_names_the_law_that_led(tmp_path, law):
    path = tmp_path / "run.html"
    write_replay(path, {"run": flockenv.simulate(PARAMETERS, 7, 1.0, policy=law)})
    assert f'"law":{json.dumps(law)},' in path.read_text("utf-8")


def test_a_page_names_no_law_of_others(tmp_path):
    path, own = tmp_path / "run.html", flockenv.policies.DampedLaw(gain=1.0)
    narrow = PARAMETERS.replace(pool=(80.0, 30.0))  # For which nothing was tuned.
    write_replay(path, {"run": flockenv.simulate(narrow, 7, 1.0, policy=own)})
    assert '"law":null,' in path.read_text("utf-8")


def test_a_recording_is_named_after_its_file(tmp_path):
    run = flockenv.simulate(PARAMETERS, 7, 1.0)
    write_replay(tmp_path / "evening.html", run)
    write_replay(tmp_path / "named.html", {"evening": run})
    pages = [(tmp_path / f"{name}.html").read_bytes() for name in ("evening", "named")]
    assert b"<title>evening " in pages[0]
    assert pages[0] == pages[1]


def test_what_cannot_be_played_is_named(tmp_path):
    run = flockenv.simulate(flockenv.FlockParameters(n_boats=2), 1, 1.0)
    for given, words in (
        (run.without_poses(), "recording 'page'"),
        (run.analyzed(after=1.0), "recording 'page'"),
        ([run], "a list is not accepted: a recording, or"),
        ({}, "0 recordings"),
        (dict.fromkeys("abc", run), "3 recordings"),
        ({1: run}, "recordings by their names"),
        ({"run": "run.npz"}, "recordings by their names"),
    ):
        with pytest.raises(flockenv.ParameterError, match=words):
            write_replay(tmp_path / "page.html", given)
    for name in ("page.npz", "page", "page.gif"):
        with pytest.raises(flockenv.ParameterError, match=r"a name in .html or .htm"):
            write_replay(tmp_path / name, run)
    assert list(tmp_path.iterdir()) == []


def test_open_water_far_out_and_one_sample(tmp_path):
    parameters = PARAMETERS.replace(pool=(np.inf, 0.0), n_leaders=0)
    assert (
        write_replay(tmp_path / "x.html", {"x": flockenv.simulate(parameters, 7, 0.0)}).every == 1
    )


def test_a_page_holds_the_obstacles(tmp_path):
    arena = PARAMETERS.replace(discs=[(140, 0, 10)], walls=[(0, 100, 0, 150)])
    write_replay(tmp_path / "run.html", {"run": flockenv.simulate(arena, 7, 40.0, contacts=True)})
    text = (tmp_path / "run.html").read_text("utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["runs"][0]["discs"] == [[140.0, 0.0, 10.0]]
    assert data["runs"][0]["walls"] == [[0.0, 100.0, 0.0, 150.0]]
