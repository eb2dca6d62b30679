"""Train the leaders of examples/train_leaders.py with TRPO: pip install sb3-contrib.

    python baselines/train_with_trpo.py SEED FLOCK_HOURS FOLDER

Seeds 0 to 4 reach an order of 0.464 to 0.500 with 500 flock-hours, 3.1 to 3.4 minutes of one core
each. The tuned law has 0.451 (results version 5).

Flocks, reward, policy and exploration are as in `flockenv train`; only the algorithm differs.
"""

import sys
import time
from pathlib import Path
from typing import Any

from sb3_contrib import TRPO

from flockenv.policies import LeaningLaw
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import SharedNoisePolicy
from flockenv.training.ppo import TrainingSettings


def trpo(settings: TrainingSettings, venv: Any, target_kl: float) -> TRPO:
    """Return TRPO before its first sample."""
    ppo = settings.model(venv)
    names = ("n_steps", "batch_size", "gamma", "gae_lambda", "policy_kwargs")
    options = {name: getattr(ppo, name) for name in names}
    options |= {"use_sde": True, "seed": settings.seed, "device": "cpu"}
    model = TRPO(SharedNoisePolicy, venv, target_kl=target_kl, **options)
    # The width of the exploration is not learned, and TRPO refuses a parameter without a gradient.
    log_std = model.policy.log_std.detach()
    del model.policy.log_std
    model.policy.log_std = log_std
    return model


if __name__ == "__main__":
    seed, hours, out = int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])
    settings = TrainingSettings(seed=seed, flock_hours=hours)
    venv = settings.venv()
    model = trpo(settings, venv, target_kl=0.01)
    venv.seed(POLICY_SEEDS["training"].seeds(1, run=seed)[0])
    model.learn(settings.samples(venv))
    out.mkdir(parents=True, exist_ok=True)
    learned = LeaningLaw.from_model(model, "wide")  # decides every second, as the model does
    law = LeaningLaw("wide", learned.bias, learned.weights)  # decides at every control step
    law.save(out / "policy.json")
    print(f"{time.process_time() / 60:.1f} minutes of one core")
