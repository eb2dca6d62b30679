"""Law: seeds of different uses never meet, and every script takes its own from the one table."""

import re
from itertools import combinations
from pathlib import Path

import pytest

from flockenv import LeadersVectorEnv, ParameterError
from flockenv.runs.seeds import FIRST_TRAINING_SEED, POLICY_SEEDS, check_evaluation_seeds

REPOSITORY = Path(__file__).parents[2]
MAKERS = [
    path
    for folder in ("baselines", "flockenv", "studies")
    for path in (REPOSITORY / folder).rglob("*.py")
    if not path.name.startswith("test_")
]


def test_no_two_uses_meet():
    for one, other in combinations([each.every for each in POLICY_SEEDS.values()], 2):
        assert one.stop <= other.start or other.stop <= one.start, (one, other)
    assert all(0 <= each.every.start < each.every.stop <= 2**64 for each in POLICY_SEEDS.values())


def test_each_use_that_makes_policies_has_one_script():
    scripts = {use: set() for use in POLICY_SEEDS}
    for path in MAKERS:
        for use in re.findall(r'POLICY_SEEDS\["([^"]+)"\]', path.read_text()):
            scripts[use].add(path.name)
    # A training in another task takes its algorithm's own range. Seeds of trainings judge nothing.
    trained = ("training", "evolution strategy", "branches")
    assert all(POLICY_SEEDS[use].first >= FIRST_TRAINING_SEED for use in trained)
    shared = (*trained, "evaluation", "paper")
    assert all(len(found) == 1 for use, found in scripts.items() if use not in shared), scripts


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((1, 2**32), "seed = 4294967296 is not accepted: from 0 to 4294967295"),
        ((1, -1), "seed = -1"),
        ((2**24 + 1,), "16777217 seeds are not accepted: there are 16777216"),
        ((1, 0, 2**24), "for each run of law tuning"),
        ((-1,), "-1 seeds"),
    ],
)
def test_seeds_that_a_use_has_not_are_refused(arguments, words):
    with pytest.raises(ParameterError, match=words):
        POLICY_SEEDS["law tuning"].seeds(*arguments)


@pytest.mark.parametrize(
    "use",
    [
        lambda huge: check_evaluation_seeds([huge]),
        lambda huge: check_evaluation_seeds(range(huge)),
        lambda huge: POLICY_SEEDS["training"].seeds(huge),
        lambda huge: LeadersVectorEnv(huge),
        lambda huge: LeadersVectorEnv(2).reset(seed=[huge, 1]),
    ],
)
def test_whole_numbers_that_python_cannot_print_are_named_errors(use):
    with pytest.raises(ParameterError, match=r"a value that cannot be printed|seed = 4294967296"):
        use(10**5000)


def test_a_long_range_of_seeds_is_checked_at_once():
    check_evaluation_seeds(range(1 << 32))
    check_evaluation_seeds(range(0))
