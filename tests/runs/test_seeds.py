"""Law: seeds of different uses never meet, and every script takes its own from the one table."""

import re
from itertools import combinations
from pathlib import Path

import pytest

from flockenv import ParameterError
from flockenv.runs.seeds import MODEL_SEEDS, POLICY_SEEDS, training_seed

REPOSITORY = Path(__file__).parents[2]
MAKERS = [*(REPOSITORY / "baselines").glob("*.py"), *(REPOSITORY / "flockenv").rglob("*.py")]


@pytest.mark.parametrize("table", [POLICY_SEEDS, MODEL_SEEDS])
def test_no_two_uses_meet(table):
    for one, other in combinations([each.every for each in table.values()], 2):
        assert one.stop <= other.start or other.stop <= one.start, (one, other)
    assert all(0 <= each.every.start < each.every.stop <= 2**64 for each in table.values())


def test_runs_of_one_use_do_not_meet():
    for seeds in POLICY_SEEDS.values():
        for run in (0, (seeds.runs - 1) // 2):
            whole = seeds.seeds(seeds.of_a_run, run)
            assert whole.start == seeds.first + run * seeds.of_a_run
            assert whole.stop <= seeds.every.stop
            if seeds.runs > 1:
                assert seeds.seeds(1, run + 1)[0] == whole.stop


def test_training_runs_keep_the_seeds_that_they_had():
    """Checkpoints of earlier versions resume with them."""
    assert POLICY_SEEDS["training"].seeds(2, 3, 5) == range(2**32 + 3 * 2**20 + 5, 2**32 + 3145735)
    assert POLICY_SEEDS["validation"].seeds(1)[0] == 2**32 + 2**62
    assert MODEL_SEEDS["calibration check"].seeds(1)[0] == 1_000_000


def test_each_use_that_makes_policies_has_one_script():
    scripts = {use: set() for use in POLICY_SEEDS}
    for path in MAKERS:
        for use in re.findall(r'POLICY_SEEDS\["([^"]+)"\]', path.read_text()):
            scripts[use].add(path.name)
    # Those that train policies draw from one range, and judge none of each other's.
    trainers = {"settings.py", "ppo_single_file.py", "tasks.py"}
    assert scripts.pop("training") == trainers
    assert all(len(found) == 1 for use, found in scripts.items() if use != "evaluation"), scripts


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((1, 2**32), "seed = 4294967296 is not accepted: from 0 to 4294967295"),
        ((1, -1), "seed = -1"),
        ((2**24 + 1,), "16777217 seeds are not accepted: there are 16777216"),
        ((1, 0, 2**24), "for each run of ablation"),
        ((-1,), "-1 seeds"),
    ],
)
def test_seeds_that_a_use_has_not_are_refused(arguments, words):
    with pytest.raises(ParameterError, match=words):
        POLICY_SEEDS["ablation"].seeds(*arguments)


def test_the_old_name_warns():
    with pytest.warns(DeprecationWarning, match="POLICY_SEEDS"):
        assert training_seed(7) == 2**32 + 7
    with (
        pytest.warns(DeprecationWarning, match="POLICY_SEEDS"),
        pytest.raises(ParameterError, match="seed = -1"),
    ):
        training_seed(-1)
