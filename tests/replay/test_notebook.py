"""Law: a notebook shows a flock as a picture, and a recording as a page that reaches nothing."""

import base64
import html
import io
import re

import matplotlib.image
import numpy as np

import flockenv
from flockenv.rendering import frame

PARAMETERS = flockenv.FlockParameters(n_boats=27, n_leaders=3, bw_s=0.3)


def test_a_flock_is_its_frame():
    flock = flockenv.Flock(PARAMETERS, 7)
    element = flock._repr_html_()
    alt, data = re.fullmatch(r'<img alt="(.*)" src="data:image/png;base64,(.*)">', element).groups()
    assert alt == "flockenv.Flock of 27 boats, 3 of them leaders, seed 7, time 0 s"
    image = matplotlib.image.imread(io.BytesIO(base64.b64decode(data, validate=True)), "png")
    pixels = (255 * image).round().astype(np.uint8)
    assert np.array_equal(pixels[..., :3], frame(flock, 400, 400))
    assert (pixels[..., 3:] == 255).all()


def test_a_recording_in_a_notebook_is_the_picture_of_its_end():
    run = flockenv.simulate(PARAMETERS, 7, 1.0)
    words = f"<code>{html.escape(repr(run))}</code>"
    assert run._repr_html_() == f"{run.flock_at(1.0)._repr_html_()}<br>{words}"
    assert run.without_poses()._repr_html_() == words
    none = run.analyzed(1.0)
    assert none._repr_html_() == f"<code>{html.escape(repr(none))}</code>"
