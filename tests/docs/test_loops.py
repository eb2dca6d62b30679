"""Law: the moving picture of a page is what the commands beside it make, and drawn once."""

import re
from pathlib import Path

import pytest
from PIL import Image

from docs.scripts import id_pages, loops
from flockenv.envs.ids import ENVIRONMENTS

DOCS = Path(__file__).parents[2] / "docs"
LOOP = re.compile(r"^```\{loop\} (\S+)\n:alt: .+\n((?:flockenv .*\n(?: .*\n)*)+)```$", re.MULTILINE)
GALLERY = (DOCS / "pictures.md").read_text("utf-8")
SMALL = """flockenv run -q --n-boats 3 --minutes 0.1 --out small.npz
flockenv replay -q small.npz --gif small.gif --seconds 0.5
"""


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.setattr(loops, "SHOWN", tmp_path / "shown")
    monkeypatch.setattr(loops, "_KEYS", tmp_path / "keys")


def test_a_loop_is_drawn_again_only_if_it_would_differ(tmp_path):
    loops.draw_commands("small", SMALL)
    still, moving = sorted((tmp_path / "shown").iterdir())
    with Image.open(moving) as picture:
        assert (picture.n_frames, picture.size) == (6, (loops.HEIGHT, loops.HEIGHT))
    for text, is_drawn in ((SMALL, False), (SMALL.replace("0.5", "0.25"), True)):
        still.write_bytes(b"before")
        loops.draw_commands("small", text)
        assert (still.read_bytes() != b"before") == is_drawn


@pytest.mark.parametrize(
    ("commands", "why"),
    [
        (SMALL.replace("--n-boats 3", "--n-boats none"), "--n-boats"),
        (SMALL.replace("small.gif", "other.gif"), "no command writes small.gif"),
        ("rm small.npz", "rm is not flockenv"),
    ],
)
def test_a_loop_that_cannot_be_drawn_says_why(commands, why):
    with pytest.raises(loops.LoopError, match=why):
        loops.draw_commands("small", commands)


def test_each_scene_of_the_gallery_writes_its_own_picture():
    scenes = LOOP.findall(GALLERY)
    assert len(scenes) == GALLERY.count("```{loop}") == len({name for name, _ in scenes})
    assert all(f"--gif {name}.gif" in commands for name, commands in scenes)


@pytest.mark.parametrize("env_id", ENVIRONMENTS)
def test_an_id_has_a_page_with_a_film_and_what_policies_reach(env_id, monkeypatch):
    monkeypatch.setattr(id_pages, "FRAMES", 1)
    monkeypatch.setattr(id_pages, "BEFORE_S", 25.0)
    name = id_pages.page_name(env_id)
    text = id_pages.page(env_id)
    assert f"loops/{name}.webp" in text
    assert f'gymnasium.make("flockenv:{env_id}")' in text
    assert "- v0: initial version." in text
    assert f"({name}.md)" in id_pages.registered()
    assert f"loops/{name}.png" in text
    (frame,) = id_pages.film(env_id)
    assert frame.size == (loops.HEIGHT, loops.HEIGHT)


def test_the_page_of_an_id_says_what_differs():
    arguments = id_pages.page("flockenv/Noises-v0").split("## Arguments")[1].split("## ")[0]
    row = re.compile(r"^\| `(\S+)` \| `(.*?)` \| `(.*?)` \|", re.MULTILINE)
    here = {name: (own, usual) for name, own, usual in row.findall(arguments)}
    differ = {name: own for name, (own, usual) in here.items() if own != usual}
    assert differ == {"bw_s": "(0.155, 0.3875)"}
