"""Circles of Rust modules are found, between folders and within one."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("cycles.py")
ONE_WAY = {
    "lib": "pub use pool::Wall;\n",
    "hull": "// crate::pool::Wall\nuse serde::Serialize;\npub struct Hull;\n",
    "pool/mod": "mod gap;\nmod wall;\npub use wall::Wall;\n",
    "pool/wall": "use super::gap::Gap;\nuse crate::{\n    hull::{Hull as Other},\n};\n",
    "pool/gap": "pub struct Gap;\n",
}


@pytest.mark.parametrize(
    ("changes", "circle"),
    [
        ({}, set()),
        ({"hull": "use crate::pool::Wall;\n"}, {"hull", "pool"}),
        ({"hull": "fn walls() -> usize { crate::pool::Wall::COUNT }\n"}, {"hull", "pool"}),
        ({"hull": "use crate::{\n    pool::{Wall},\n};\n"}, {"hull", "pool"}),
        ({"pool/gap": "use super::wall::Wall;\n"}, {"wall", "gap"}),
        # Through a name that mod.rs re-exports, and between a folder and the files beside it.
        ({"pool/gap": "use super::Wall;\n"}, {"wall", "gap"}),
        ({"pool/gap": "use crate::pool::{Wall as Other, Gap};\n"}, {"wall", "gap"}),
        ({"pool/gap/near": "use super::super::wall::Wall;\n"}, {"wall", "gap"}),
        (
            {"pool/gap/near": "use crate::pool::{hull::Hull, wall::{Wall, Side}};\n"},
            {"wall", "gap"},
        ),
        ({"pool/gap/mod": "use super::Wall;\n"}, {"wall", "gap"}),
        ({"pool/gap/near": "use super::Wall;\nuse super::super::super::hull::Hull;\n"}, set()),
    ],
)
def test_circles_are_named(tmp_path, changes, circle):
    for name, text in {**ONE_WAY, **changes}.items():
        path = tmp_path / f"{name}.rs"
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(text)
    run = [sys.executable, str(SCRIPT), str(tmp_path)]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == len({*circle}) // 2
    assert all(word in done.stderr for word in circle)


@pytest.mark.parametrize(
    ("layers", "words"),
    [
        (["pool", "hull"], []),
        (["hull", "pool"], ["pool", "hull", "below"]),
        (["pool | hull"], ["pool", "hull", "below"]),
        (["pool"], ["hull", "no layer"]),
    ],
)
def test_a_module_names_only_what_stands_below_it(tmp_path, layers, words):
    (tmp_path / "Cargo.toml").write_text(f"[package]\nmetadata.layers = {layers}\n")
    for name, text in ONE_WAY.items():
        path = tmp_path / f"src/{name}.rs"
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(text)
    run = [sys.executable, str(SCRIPT), str(tmp_path / "src")]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == bool(words)
    assert all(word in done.stderr for word in words)
