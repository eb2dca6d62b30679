"""Every script: Ctrl-C ends it in one line, and seeds that nothing takes are refused by name."""

import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from flockenv.policies import LeaningLaw

BASELINES = Path(__file__).parents[2] / "baselines"
#: What is at work when Ctrl-C comes, and arguments without those of the output.
AT_WORK = {
    "ablate_leaning": ("run_episodes", ["{law}", "--pool", "narrow", "--quiet"]),
    "critical_noise": ("order_of_run", ["--seeds", "1", "--pool", "narrow"]),
    "evolution_strategy": ("scores", ["--quiet"]),
    "learning_check": ("train", []),
    "search_ppo": ("settings_of", ["--quiet"]),
    "tune_laws": ("run_episodes", ["--quiet"]),
    "understand_leaders": ("watch", ["--quiet"]),
}


@pytest.fixture
def imported(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], ModuleType]:
    def found(name: str) -> ModuleType:
        spec = importlib.util.spec_from_file_location(name, BASELINES / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
        return module

    monkeypatch.syspath_prepend(str(BASELINES))
    return found


@pytest.fixture
def arguments(tmp_path: Path) -> Callable[[str], list[str]]:
    law = tmp_path / "law.npz"
    LeaningLaw({"gain": 1.0, "backward_gain": 2.0, "damping": 9.0}, 0.1, {}).save(law)

    def found(name: str) -> list[str]:
        given = [each.format(law=law) for each in AT_WORK[name][1]]
        return [*given, "--out", str(tmp_path / "out" / "found")]

    return found


@pytest.mark.parametrize("name", AT_WORK)
def test_an_interrupt_ends_in_one_line(name: str, imported, arguments, monkeypatch, capsys) -> None:
    def interrupted(*_arguments, **_options):
        raise KeyboardInterrupt

    script = imported(name)
    monkeypatch.setattr(script, AT_WORK[name][0], interrupted)
    if name == "ablate_leaning":
        monkeypatch.setattr(script, "usual", lambda *_: dict.fromkeys(script.FEATURES, 0.0))
    with pytest.raises(SystemExit, match=r"^Interrupted: .*$"):
        script.main(arguments(name))


@pytest.mark.parametrize("seed", ["-1", "99999999999999"])
@pytest.mark.parametrize("name", [name for name in AT_WORK if name != "critical_noise"])
def test_seeds_out_of_range(name: str, seed: str, imported, arguments, capsys) -> None:
    with pytest.raises(SystemExit) as ended:
        imported(name).main([*arguments(name), "--seed", seed])
    reported = str(ended.value) + capsys.readouterr().err
    assert "is not accepted: " in reported
    assert f"{seed} " in reported
    assert "from 0 to " in reported


def test_training_seeds_are_none_to_be_understood_by(imported, arguments) -> None:
    with pytest.raises(SystemExit, match="seeds for evaluation are from 0"):
        imported("understand_leaders").main(
            [*arguments("understand_leaders"), "--seed", f"{2**32}"]
        )


def test_no_critical_noise_without_runs(imported, arguments, capsys) -> None:
    with pytest.raises(SystemExit):
        imported("critical_noise").main([*arguments("critical_noise"), "--seeds", "0"])
    assert "--seeds is at least 1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("stored", "words"), [(False, "no checkpoint yet"), (True, "--resume continues")]
)
def test_ppo_reports_what_is_stored(
    imported, tmp_path: Path, monkeypatch, stored: bool, words: str
) -> None:
    def interrupted(settings, out, **_options):
        if stored:
            np.savez(out / "checkpoint.npz")
        raise KeyboardInterrupt

    script = imported("ppo_shared_policy")
    monkeypatch.setattr(script.training, "train", interrupted)
    with pytest.raises(SystemExit, match=f"Interrupted: .*{words}"):
        script.main(["--out", str(tmp_path)])
