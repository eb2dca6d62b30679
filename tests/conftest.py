import io
import itertools
import json
import os
import random
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import hypothesis
import numpy as np
import pytest

#: `make fuzz` sets it: so many random examples of each hostile input, instead of a few fixed ones.
FUZZ_EXAMPLES = os.environ.get("FUZZ_EXAMPLES")

# A busy machine makes an example slow, not wrong. What `make fuzz` finds becomes an @example.
hypothesis.settings.register_profile(
    "fixed",
    deadline=None,
    derandomize=True,
    # A busy machine is slow; that is no fault of an example.
    suppress_health_check=[hypothesis.HealthCheck.too_slow],
)
hypothesis.settings.register_profile(
    "fuzz",
    max_examples=int(FUZZ_EXAMPLES or 60),
    deadline=None,
    derandomize=FUZZ_EXAMPLES is None,
    suppress_health_check=list(hypothesis.HealthCheck),
)
hypothesis.settings.load_profile("fixed")


@pytest.fixture(scope="session", autouse=True)
def _interruptible() -> None:
    """Shells have what runs in the background ignore Ctrl-C, and so would what tests start."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def _no_chance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever draws without a seed draws the same in each run: spaces, environments, suites."""
    random.seed(2011)
    np.random.seed(2011)  # noqa: NPY002 - the suites of others use the global generator
    numbers, new = itertools.count(2011), np.random.default_rng
    monkeypatch.setattr(
        np.random, "default_rng", lambda seed=None: new(next(numbers) if seed is None else seed)
    )
    seeded = gymnasium.utils.seeding.np_random
    monkeypatch.setattr(
        gymnasium.utils.seeding,
        "np_random",
        lambda seed=None: seeded(next(numbers) if seed is None else seed),
    )


@pytest.fixture(scope="session")
def page_runs():
    """Read a replay page: name, seed, samples and number of boats of each run that it holds."""

    def read(path):
        data = re.search(r'id="data">(.*?)</script>', path.read_text("utf-8"))
        runs = json.loads(data[1])["runs"]
        return [(run["name"], run["seed"], run["samples"], run["boats"]) for run in runs]

    return read


@pytest.fixture
def run_notebook() -> Callable[..., dict[str, Any]]:
    """Run a notebook of the examples, and return the names that it defines.

    Names that are given have a smaller value than in the notebook.
    """

    def run(notebook: str, **smaller: str) -> dict[str, Any]:
        path = Path(__file__).parents[1] / "examples" / notebook
        names: dict[str, Any] = {}
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                assert cell["outputs"] == []
                source = "".join(cell["source"])
                for name, value in smaller.items():
                    source = re.sub(
                        rf"^{name} = [^#\n]*", f"{name} = {value}  ", source, flags=re.M
                    )
                exec(source, names)  # noqa: S102 - the notebook is ours
        assert all(f"{names[name]!r}" == value for name, value in smaller.items())
        return names

    return run


@pytest.fixture
def colors_in() -> Callable[[Path], set[str]]:
    """Return the references, and the colors of other policies, in the picture of a comparison.

    The paper's law has one color at every rate, and one name here.
    """

    def found(path: Path) -> set[str]:
        from matplotlib.colors import to_rgb
        from matplotlib.image import imread

        from flockenv.comparison.figure import COLORS, OTHER_COLORS
        from flockenv.policies.names import EVERY_SUBSTEP

        pixels = imread(path)[..., :3]
        named = {name: color for name, color in COLORS.items() if name != EVERY_SUBSTEP}
        named |= {color: color for color in OTHER_COLORS}
        near = {n: abs(pixels - to_rgb(c)).max(axis=-1) < 0.02 for n, c in named.items()}
        return {name for name, pixels in near.items() if pixels.sum() > 500}

    return found


class CommandLine:
    """`flockenv` as tests call it. Variables are set in the environment, or unset by None."""

    CALL = "from flockenv.cli import main; main()"

    def __call__(self, *words: object, **variables: str | None) -> subprocess.CompletedProcess[str]:
        """Run a command in this process, which has imported already what commands import."""
        from flockenv.cli import main

        streams = [io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2)]
        arguments = list(map(str, words))
        with pytest.MonkeyPatch.context() as patch:
            for name, stream in zip(("stdout", "stderr"), streams, strict=True):
                patch.setattr(sys, name, stream)
            for name, value in {"COLUMNS": "80", "NO_COLOR": "1", **variables}.items():
                patch.delenv(name, raising=False)
                if value is not None:
                    patch.setenv(name, value)
            patch.setattr(sys, "argv", ["flockenv", *arguments])
            with pytest.raises(SystemExit) as ended:
                main()
        texts = (each.buffer.getvalue().decode("utf-8", "surrogateescape") for each in streams)
        return subprocess.CompletedProcess(arguments, ended.value.code or 0, *texts)

    def succeeds(self, *words: object, **variables: str | None) -> subprocess.CompletedProcess[str]:
        """Run a command in this process that must not fail."""
        done = self(*words, **variables)
        assert done.returncode == 0, done.stderr
        return done

    def process(
        self, *words: object, before: str = "", **variables: str | None
    ) -> subprocess.CompletedProcess[str]:
        """Run a command in a process of its own, after some Python code; wait for its end."""
        with self.start(*words, before=before, stdout=subprocess.PIPE, **variables) as process:
            try:
                texts = process.communicate(timeout=120)
            finally:
                process.kill()
        return subprocess.CompletedProcess(process.args, process.returncode, *texts)

    def start(
        self,
        *words: object,
        before: str = "",
        stdout: int | None = None,
        stderr: int = subprocess.PIPE,
        **variables: str | None,
    ) -> subprocess.Popen[str]:
        """Start a command in a process and session of its own, after some Python code."""
        every = {**os.environ, "COLUMNS": "80", **variables}
        return subprocess.Popen(
            [sys.executable, "-c", f"{before}\n{self.CALL}", *map(str, words)],
            stdout=stdout,
            stderr=stderr,
            text=True,
            env={name: value for name, value in every.items() if value is not None},
            start_new_session=True,
        )


@pytest.fixture(scope="session")
def cli() -> CommandLine:
    return CommandLine()
