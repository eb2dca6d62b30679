"""Law: the installed package is this source tree, and importing it needs no optional library."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import flockenv

REPOSITORY = Path(__file__).parents[2]
OPTIONAL = (
    "torch",
    "stable_baselines3",
    "matplotlib",
    "pandas",
    "scipy",
    "pyarrow",
    "pygame",
    "ray",
)


def test_version_is_the_one_of_cargo_toml():
    cargo = (REPOSITORY / "Cargo.toml").read_text()
    assert flockenv.__version__ == re.search(r'^version = "(.+)"$', cargo, re.MULTILINE)[1]


def test_import_needs_no_optional_library():
    blocked = f"import sys; sys.modules.update(dict.fromkeys({OPTIONAL}))"
    subprocess.run([sys.executable, "-c", f"{blocked}; import flockenv"], check=True)


def test_sources_without_the_compiled_simulator_say_so(tmp_path):
    compiled = shutil.ignore_patterns("*.so", "*.pyd")
    shutil.copytree(REPOSITORY / "flockenv", tmp_path / "flockenv", ignore=compiled)
    failed = subprocess.run(
        [sys.executable, "-c", "import flockenv"], cwd=tmp_path, capture_output=True, text=True
    )
    assert failed.returncode == 1
    assert "start Python in another folder than the clone's" in failed.stderr
