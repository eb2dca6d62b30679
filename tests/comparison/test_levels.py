"""Law: a level never changes, an id gives what it scores, and no steering has 0, the law 1."""

import hashlib
import json
from dataclasses import replace

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv.comparison.levels import FLOCKS, LEVEL_IDS, LEVELS, budget_of, score
from flockenv.errors import ParameterError
from flockenv.policies import policy
from flockenv.runs.seeds import release_seeds

FIELDS = ("n_boats", "n_leaders", "pool", "bw_s", "scheme", "noise_scheme", "dt_s", "tolerance_cm")
FROZEN = "ad0e229622656d7f"
"""Of all that makes the levels; another digest is another suite."""


def test_levels_never_change() -> None:
    frozen = [
        (
            each.name,
            {name: str(getattr(each.parameters, name)) for name in FIELDS},
            each.episode_s,
            {name: str(value) for name, value in each.environment.items()},
            dict(each.observation),
            (release_seeds("suite v3", FLOCKS)[0], FLOCKS),
        )
        for each in LEVELS.values()
    ]
    digest = hashlib.sha256(json.dumps(frozen, sort_keys=True).encode()).hexdigest()
    assert digest[:16] == FROZEN


@pytest.mark.parametrize(("name", "env_id"), LEVEL_IDS.items())
def test_an_id_gives_what_the_level_scores(name: str, env_id: str) -> None:
    """Bit for bit, by a law that sees what leaders see there."""
    level = replace(LEVELS[name], episode_s=20.0)
    options = gymnasium.spec(env_id).kwargs
    law = policy("damped law")
    layout = {"observation": law.observation, "mirror_to_target": law.mirror_to_target}
    env = flockenv.LeadersVectorEnv(
        2, autoreset_mode="disabled", **{**options, **layout, "episode_s": 20.0}
    )
    seen, _ = env.reset(seed=list(release_seeds("suite v3", FLOCKS)[:2]))
    ended = np.zeros(2, bool)
    while not ended.any():
        seen, _, _, ended, infos = env.step(law.predict(seen)[0])
    found = level.run("damped law", 2)
    assert found["signed_order"].tolist() == infos["episode_summary"]["signed_order"].tolist()


def test_the_scale_is_known_on_paper() -> None:
    none, law = np.array([0.0, 0.1, -0.1, 0.0]), np.array([0.4, 0.4, 0.5, 0.3])
    assert score(none, none, law)[0] == pytest.approx(0.0)
    assert score(law, none, law) == pytest.approx((1.0, 1.0, 1.0))
    half = score([0.5 * (none + law)] * 3, none, law)
    assert half == pytest.approx((0.5, 0.5, 0.5))
    with pytest.raises(ParameterError, match="no scale for a score"):
        score(law, law, none)


def test_an_interval_holds_trainings_and_flocks() -> None:
    """Nine of ten intervals or more hold the true score, of which flocks and trainings draw."""
    held, random = 0, np.random.default_rng(4)
    for _ in range(60):
        none = random.normal(0.0, 0.2, 64)
        law = random.normal(0.4, 0.2, 64)
        own = 0.2 + random.normal(0.0, 0.03, (5, 1)) + random.normal(0.0, 0.2, 64)
        low, high = score(own + random.normal(0.0, 0.1, (5, 64)), none, law)[1:]
        held += low <= 0.5 <= high
    # Binomial with n = 60 and 0.95: 50 or fewer has a chance of 5e-4.
    assert held > 50


def test_a_class_holds_its_last_rollout() -> None:
    assert [budget_of(hours) for hours in (1, 30, 30.6, 30.7, 102, 306, 307)] == [
        *("30", "30", "30", "100", "100", "300", "more")
    ]


def test_only_a_level_s_own_flocks_are_led() -> None:
    with pytest.raises(ParameterError, match="flocks = 513"):
        LEVELS["order-easy"].run("damped law", FLOCKS + 1)
    with pytest.raises(ParameterError, match="action_mode 'lean'"):
        LEVELS["order-wide"].run(_leans(), 2)


def _leans():
    class Leans:
        action_mode = "lean"

        def predict(self, observation, state=None):
            raise AssertionError("it was asked")

    return policy(Leans())
