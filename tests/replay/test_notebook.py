"""Law: a notebook shows a flock as a picture, and a recording as a page that reaches nothing."""

import base64
import html
import io
import re

import matplotlib.image
import numpy as np
import pytest

import flockenv
from flockenv.rendering import frame
from flockenv.replay import MOST_INLINE_BYTES, inline_replay, page

PARAMETERS = flockenv.FlockParameters(n_boats=27, n_leaders=3, bw_s=0.3)


def page_in(element: str) -> str:
    return html.unescape(re.fullmatch(r'<iframe [^>]* srcdoc="([^"]*)"></iframe>', element)[1])


def test_a_flock_is_its_frame():
    flock = flockenv.Flock(PARAMETERS, 7)
    element = flock._repr_html_()
    alt, data = re.fullmatch(r'<img alt="(.*)" src="data:image/png;base64,(.*)">', element).groups()
    assert alt == "flockenv.Flock of 27 boats, 3 of them leaders, seed 7, time 0 s"
    image = matplotlib.image.imread(io.BytesIO(base64.b64decode(data, validate=True)), "png")
    pixels = (255 * image).round().astype(np.uint8)
    assert np.array_equal(pixels[..., :3], frame(flock, 400, 400))
    assert (pixels[..., 3:] == 255).all()


def test_a_recording_is_a_sandboxed_page():
    run = flockenv.simulate(PARAMETERS, 7, 10.0, contacts=True)
    element = inline_replay(run, 'a "name" <b>')
    assert re.findall(r'sandbox="([^"]*)"', element.partition(" srcdoc=")[0]) == ["allow-scripts"]
    inside = page_in(element)
    assert inside.startswith("<!doctype html>")
    assert "default-src 'none'" in inside
    assert '"plays":false' in inside
    assert "<b>" not in element


def test_a_long_run_is_thinned_to_the_bound():
    run = flockenv.simulate(PARAMETERS, 7, 3600.0, contacts=True)
    element = inline_replay(run, "hour")
    assert len(element.encode()) < MOST_INLINE_BYTES
    assert int(re.search(r'"every":(\d+)', page_in(element))[1]) > 1


def test_what_fits_no_page_is_refused(monkeypatch):
    run = flockenv.simulate(PARAMETERS, 7, 1.0)
    monkeypatch.setattr(page, "MOST_INLINE_BYTES", 110_000)
    with pytest.raises(flockenv.ParameterError, match="do not fit a page of 10000 bytes"):
        inline_replay(run, "run")


def test_a_recording_in_a_notebook_is_the_picture_of_its_end():
    run = flockenv.simulate(PARAMETERS, 7, 1.0)
    words = f"<code>{html.escape(repr(run))}</code>"
    assert run._repr_html_() == f"{run.flock_at(1.0)._repr_html_()}<br>{words}"
    assert run.without_poses()._repr_html_() == words
    none = run.analyzed(1.0)
    assert none._repr_html_() == f"<code>{html.escape(repr(none))}</code>"
