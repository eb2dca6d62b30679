"""Circles of Rust modules are found, also through what a `mod.rs` re-exports."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("cycles.py")


def check(root):
    run = [sys.executable, str(SCRIPT), str(root)]
    return subprocess.run(run, capture_output=True, text=True, check=False)


def write(root, **files):
    for name, text in files.items():
        path = root / (name.replace("__", "/") + ".rs")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


ONE_WAY = {
    "lib": "mod hull;\nmod pool;\npub use pool::Pool;\n",
    "hull": "pub struct Hull;\n",
    "pool__mod": "mod wall;\npub use wall::Wall;\npub struct Pool(Wall);\n",
    "pool__wall": "use crate::hull::Hull;\npub struct Wall(Hull);\n",
}


def test_one_way_is_accepted(tmp_path):
    write(tmp_path, **ONE_WAY)
    done = check(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    "back",
    [
        "use crate::pool::Wall;\n",
        "use crate::{\n    pool::{Wall as Other},\n};\n",
        "fn walls() -> usize { crate::pool::Wall::COUNT }\n",
        "use super::pool::wall::Wall;\n",
    ],
)
def test_a_circle_through_a_reexport_is_named(tmp_path, back):
    write(tmp_path, **ONE_WAY | {"hull": back})
    done = check(tmp_path)
    assert done.returncode == 1
    assert all(word in done.stderr for word in ("circle", "hull", "pool"))


def test_a_circle_inside_a_folder_is_named(tmp_path):
    wall = "use super::gap::Gap;\nuse crate::hull::Hull;\n"
    gap = "use super::Wall;\n"
    write(tmp_path, **ONE_WAY | {"pool__wall": wall, "pool__gap": gap})
    done = check(tmp_path)
    assert done.returncode == 1
    assert "pool::gap" in done.stderr


def test_comments_and_names_of_other_crates_do_not_count(tmp_path):
    write(tmp_path, **ONE_WAY | {"hull": "// crate::pool::Wall\nuse serde::Serialize;\n"})
    assert check(tmp_path).returncode == 0
