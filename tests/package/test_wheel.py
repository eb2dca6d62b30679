"""Law: what users install works in an empty environment, and brings the core dependencies only.

`make test-wheel` builds the wheel and the source distribution first.
"""

import json
import os
import platform
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from flockenv import _core

pytestmark = [pytest.mark.wheel, pytest.mark.timeout(1800)]

REPOSITORY = Path(__file__).parents[2]
DIST = REPOSITORY / "dist"
CORE = {"flockenv", "gymnasium", "numpy", "pettingzoo", "rich", "tomli-w", "typer"}
OPTIONAL = {
    "matplotlib",
    "pandas",
    "pyarrow",
    "pygame-ce",
    "ray",
    "scipy",
    "stable-baselines3",
    "torch",
    "xarray",
}
LIGHT = f"""
import sys
import flockenv
found = sorted({{name.replace("-", "_") for name in {sorted(OPTIONAL)}}} | {{"pygame"}})
print([name for name in found if name in sys.modules])
"""
#: 200 random scenes; a line for each.
SCENES = Path(__file__).with_name("scenes.py")
SIMULATION = """
import numpy as np
import flockenv
parameters = flockenv.FlockParameters(n_boats=27, n_leaders=3)
run = flockenv.simulate(parameters, seed=0, duration_s=10.0)
assert run.pose.shape == (101, 27, 3) and np.isfinite(run.velocity).all()
env = flockenv.LeadersEnv(n_leaders=3, episode_s=2.0, render_mode="rgb_array")
observation, _ = env.reset(seed=0)
law = flockenv.policies.SteeringLaw()
for _ in range(20):
    observation, reward, _, over, _ = env.step(law.predict(observation)[0])
assert over and np.isfinite(reward) and env.render().shape == (600, 600, 3)
flock = flockenv.Flock(parameters, 0)
flock.advance(10.0)
print(flock.pose.sum().hex())
"""


def only(pattern: str) -> Path:
    (found,) = DIST.glob(pattern)
    return found


SOURCES: dict[str, Callable[[], Path]] = {
    "wheel": lambda: only("*.whl"),
    "source distribution": lambda: only("*.tar.gz"),
    "folder": lambda: REPOSITORY,
}


class Installed:
    """An environment with nothing but what was installed."""

    def __init__(self, folder: Path, interpreter: str, source: Path) -> None:
        self.bin, self.folder = folder / "venv" / "bin", folder
        subprocess.run([interpreter, "-m", "venv", str(folder / "venv")], check=True)
        # Compiled crates are taken from where they are; the package itself is compiled again.
        target = {"CARGO_TARGET_DIR": str(REPOSITORY / "target")}
        self.run("python", "-m", "pip", "install", "--quiet", str(source), **target)

    def run(self, program: str, *arguments: str, **environment: str) -> str:
        done = self.attempt(program, *arguments, **environment)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def attempt(
        self, program: str, *arguments: str, **environment: str
    ) -> subprocess.CompletedProcess[str]:
        plain = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
        return subprocess.run(
            [str(self.bin / program), *arguments],
            cwd=self.folder,
            env={**plain, "PIP_DISABLE_PIP_VERSION_CHECK": "1", **environment},
            capture_output=True,
            text=True,
            check=False,
        )


@pytest.fixture(scope="module", params=SOURCES)
def installed(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed")
    return Installed(folder, sys.executable, SOURCES[request.param]())


def test_only_core_dependencies_come_along(installed):
    rows = json.loads(installed.run("python", "-m", "pip", "list", "--format", "json"))
    names = {row["name"].lower().replace("_", "-") for row in rows}
    assert names >= CORE
    assert names.isdisjoint(OPTIONAL)
    installed.run("python", "-m", "pip", "check")


def test_import_loads_no_optional_library(installed):
    assert installed.run("python", "-I", "-c", LIGHT) == "[]\n"


def test_simulates_and_draws_as_here(installed):
    # The same sources on the same machine: the same bits as the development build's.
    here = subprocess.run(
        [sys.executable, "-c", SIMULATION], check=True, capture_output=True, text=True
    )
    assert installed.run("python", "-I", "-c", SIMULATION) == here.stdout


@pytest.mark.skipif(not _core.HAS_AVX2, reason="needs AVX2")
def test_a_wheel_uses_avx2_where_it_can_and_gives_the_same_bits(tmp_path):
    installed = Installed(tmp_path, sys.executable, only("*.whl"))
    look = "import flockenv; print(flockenv._core.USES_AVX2)"
    (fast,) = tmp_path.rglob("_core_avx2.abi3.so")
    assert installed.run("python", "-I", "-c", look) == "True\n"
    simulated = ("python", "-I", "-c", SIMULATION), ("python", "-I", str(SCENES))
    with_avx2 = [installed.run(*each) for each in simulated]
    assert len(with_avx2[1].splitlines()) == 200
    fast.unlink()
    assert installed.run("python", "-I", "-c", look) == "False\n"
    assert [installed.run(*each) for each in simulated] == with_avx2
    # What was added is in the list of files: without it the wheel would not be uninstalled.
    installed.run("python", "-m", "pip", "uninstall", "--quiet", "--yes", "flockenv")
    assert not [*tmp_path.rglob("flockenv/*.so")]


def test_command_line_works(installed, page_runs):
    assert "compare" in installed.run("flockenv", "--help")
    version = installed.run("python", "-c", "import flockenv; print(flockenv.__version__)")
    assert installed.run("flockenv", "--version") == version
    installed.run("flockenv", "demo", "--minutes", "0.2", "--no-open", "--quiet")
    installed.run("flockenv", "run", "--minutes", "0.2", "--out", "run.npz", "--quiet")
    installed.run("flockenv", "replay", "run.npz", "--quiet")
    assert page_runs(installed.folder / "run.html") == [("run", "0", 121, 20)]


def test_leaders_are_trained_compared_and_shown_without_any_extra(installed, page_runs):
    short = ("--flock-hours", "0.3", "--set", "pairs=4", "--episodes", "2", "--out", "branches")
    flock = ("--pool", "narrow", "--n-leaders", "3")
    printed = installed.run("flockenv", "train", "--algorithm", "branches", *flock, *short)
    assert "trained minus tuned law: " in printed
    written = {path.name for path in (installed.folder / "branches").iterdir()}
    assert {"policy.json", "curve.csv", "comparison.csv"} <= written
    assert "curve.png" not in written
    led = ("--policy", "branches/policy.json", "--minutes", "0.2", "--out", "led.npz", "--quiet")
    installed.run("flockenv", "run", *flock, *led)
    installed.run("flockenv", "replay", "led.npz", "--quiet")
    assert page_runs(installed.folder / "led.html") == [("led", "0", 121, 20)]


def test_missing_extra_is_named(installed):
    done = installed.attempt("flockenv", "compare", "--episodes", "2", "--minutes", "0.1")
    assert done.returncode == 2
    assert "'FILE.whl[plot]' with its wheel" in done.stderr


def test_wheel_holds_all_that_it_should():
    wheel = only("*.whl")
    assert "-cp311-abi3-" in wheel.name
    names = zipfile.ZipFile(wheel).namelist()
    tracked = subprocess.run(
        ["git", "ls-files", "flockenv"], cwd=REPOSITORY, check=True, capture_output=True, text=True
    )
    assert set(tracked.stdout.split()) <= set(names)
    assert {"flockenv/py.typed", "flockenv/_core.pyi"} <= set(names)
    # Git does not know the live page: it is in the wheel if `make live` has built it.
    page = "flockenv/replay/live.html"
    assert (page in names) == (REPOSITORY / page).exists()
    cores = {"flockenv/_core.abi3.so"}
    if platform.machine() == "x86_64":
        cores.add("flockenv/_core_avx2.abi3.so")
    assert {name for name in names if name.endswith((".so", ".pyd", ".dylib"))} == cores
    licenses = [name.partition("/licenses/")[2] for name in names if "/licenses/" in name]
    wanted = {"LICENSE", *(f"LICENSES/{path.name}" for path in REPOSITORY.glob("LICENSES/*"))}
    assert set(licenses) == wanted


@pytest.mark.parametrize("interpreter", os.environ.get("PYTHONS", "").split() or [None])
def test_one_wheel_fits_newer_interpreters(interpreter, tmp_path):
    if interpreter is None:
        pytest.skip("PYTHONS names no other interpreters")
    installed = Installed(tmp_path, interpreter, only("*.whl"))
    installed.run("python", "-I", "-c", SIMULATION)
    assert installed.run("python", "-I", "-c", LIGHT) == "[]\n"
    installed.run("flockenv", "--help")
