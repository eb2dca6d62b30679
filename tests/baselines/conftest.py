"""The script that a test module is about: test_NAME.py tests baselines/NAME.py."""

import importlib.util
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest

from flockenv.policies import load

BASELINES = Path(__file__).parents[2] / "baselines"


@pytest.fixture(scope="module")
def script(request: pytest.FixtureRequest) -> Iterator[ModuleType]:
    """Return the script as a module, which finds the other scripts as when it is run."""
    name = request.module.__name__.rpartition(".")[2].removeprefix("test_")
    spec = importlib.util.spec_from_file_location(name, BASELINES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their own module up
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BASELINES))
        spec.loader.exec_module(module)
        yield module


@pytest.fixture
def assert_repeats(script: ModuleType, tmp_path: Path) -> Callable[[list[str]], None]:
    """Return a function that trains with seeds 3, 3 and 4, and compares the laws."""

    def train(arguments: list[str]) -> None:
        runs = (("a", "3"), ("b", "3"), ("c", "4"))
        for folder, seed in runs:
            script.main([*arguments, "--seed", seed, "--out", str(tmp_path / folder)])
        one, same, other = (load(tmp_path / folder / seed / "policy.json") for folder, seed in runs)
        assert one.weights == same.weights != other.weights
        assert any(one.weights.values())

    return train
