"""Train, choose and judge the pretrained leaders of both pools.

    make pretrained                              # an hour and a half of one core
    python baselines/pretrained.py --trial       # every step with few flocks, a minute
    python baselines/pretrained.py --ship        # copies what passes to src/policies/learned

In `wide` three leaders reach a signed order of 0.503 on average over eight seeds (0.481 to 0.520).
The tuned law reaches 0.451. In `narrow` no seed passes the tuned law.

The design was fixed before the first training. In `wide` eight trainings differ from `flockenv
train` only in the number of leaders: equally many flocks have one, two, three and four leaders. In
`narrow`, where PPO does not pass the tuned law, eight searches compare paired branches
(paired_branches.py) with three leaders. Each PPO training has 1100 flock-hours, each search 400,
and no setting was searched for.

Every policy is linear, so policies can be averaged by taking the mean of their weights. This mean
is the pool's policy if it leads at least as well in the validation flocks as the best single
policy; otherwise the best single policy is. The score is the mean signed order with one to four
leaders, in 128 validation flocks each, at the default physics. Then the policy is judged with three
leaders in flocks that nobody has used. Its file holds that order, the command, the seeds and the
flock-hours.

A training whose policy is in `--out` already is skipped, so an interrupted command resumes. PPO
also keeps its policy after 500 flock-hours. judge_trainings.py has the commands that compare all
seeds.

The policy of a pool ships if it leads at least as well in the validation flocks as the tuned law
and the present shipped policy. studies/trainings keeps what the command wrote, without the rows of
the policies that shipped before.
"""

import argparse
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import configure

from flockenv import FlockParameters
from flockenv.comparison import run_episodes, score_policies
from flockenv.policies import DampedLaw, LeaningLaw
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds
from flockenv.training.ppo import TrainingSettings

SHIPPED = Path(__file__).parents[1] / "src" / "policies" / "learned"


@dataclass(frozen=True)
class Settings:
    """Everything that the policies depend on."""

    seeds: tuple[int, ...] = tuple(range(8))
    #: Flocks of a PPO training; the numbers of leaders are dealt out to them in turn.
    environment: Mapping[str, Any] = field(default_factory=lambda: {"n_leaders": [1, 2, 3, 4]})
    #: Flock-hours of each training; PPO also saves its policy after `early_hours`.
    wide_hours: float = 1100.0
    early_hours: float = 500.0
    narrow_hours: float = 400.0
    num_flocks: int = 128
    #: Number of validation flocks for each number of leaders, one to four, and of judging flocks.
    validation_flocks: int = 128
    judging_flocks: int = 512
    episode_s: float = 480.0


TRIAL = Settings(
    seeds=(0, 1),
    wide_hours=1.5,
    early_hours=0.5,
    narrow_hours=1.0,
    num_flocks=8,
    validation_flocks=2,
    judging_flocks=4,
    episode_s=16.0,
)


class SaveEarly(BaseCallback):
    """Saves the policy at the first rollout that starts after this many samples."""

    def __init__(self, samples: int, pool: str, path: Path) -> None:
        super().__init__()
        self.samples, self.pool, self.path = samples, pool, path

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self.samples and not self.path.exists():
            self.path.parent.mkdir(parents=True, exist_ok=True)
            at_every_step(LeaningLaw.from_model(self.model, self.pool), {}).save(self.path)

    def _on_step(self) -> bool:
        return True


def at_every_step(law: LeaningLaw, provenance: dict[str, str]) -> LeaningLaw:
    """Return a law that decides at every control step instead of once per second as in training."""
    return LeaningLaw(law.pool, law.bias, law.weights, provenance=provenance)


def train_wide(settings: Settings, seed: int, folder: Path, command: str) -> LeaningLaw:
    """Return the law of leans that PPO learns with this seed."""
    start_s = time.process_time()
    training = TrainingSettings(
        pool="wide",
        seed=seed,
        flock_hours=settings.wide_hours,
        num_flocks=settings.num_flocks,
        environment=settings.environment,
    )
    env = training.venv()
    env.seed(POLICY_SEEDS["training"].seeds(1, run=seed)[0])
    model = training.model(env)
    model.set_logger(configure(str(folder), ["csv"]))
    early = training.replace(flock_hours=settings.early_hours)
    early_folder = folder.parent.with_name(f"{folder.parent.name}-{settings.early_hours:g}")
    model.learn(
        training.samples(env),
        callback=SaveEarly(early.samples(env), "wide", early_folder / str(seed) / "policy.json"),
    )
    model.logger.close()
    provenance = provenance_of(
        command,
        seed=seed,
        samples=model.num_timesteps,
        cpu_s=time.process_time() - start_s,
        flock_hours=model.num_timesteps / env.num_envs * settings.num_flocks / 3600.0,
    )
    return at_every_step(LeaningLaw.from_model(model, "wide"), provenance)


def search_narrow(settings: Settings, seed: int, folder: Path, _command: str) -> LeaningLaw:
    """Return the law of leans that paired_branches.py finds, with its command as provenance."""
    words = ["--pool", "narrow", "--pairs", str(settings.num_flocks // 2), "--seed", str(seed)]
    words += ["--flock-hours", str(settings.narrow_hours), "--out", str(folder.parent)]
    script = Path(__file__).with_name("paired_branches.py")
    subprocess.run([sys.executable, str(script), *words], check=True)
    return LeaningLaw.load(folder / "policy.json")


MAKERS: dict[str, Any] = {"wide": train_wide, "narrow": search_narrow}
#: How each pool's policy bounds its leans.
BOUND = {"wide": "tanh", "narrow": "clip"}


def orders(policy: Any, pool: str, leaders: int, seeds: Any, episode_s: float) -> np.ndarray:
    """Return the signed order of each flock at the pool's critical noise."""
    bw_s = FlockParameters.critical_bw_s("simulation", pool)
    flock = FlockParameters(n_boats=27, pool=pool, bw_s=bw_s, n_leaders=leaders)
    return run_episodes(flock, policy, seeds, episode_s)["signed_order"]


def combined_provenance(laws: list[LeaningLaw], command: str, chosen: str) -> dict[str, str]:
    """Return the provenance of a law, or of the mean of several, with sums of their costs."""
    provenances = [law.provenance for law in laws]
    return {
        "command": command,
        "chosen": chosen,
        "flockenv": provenances[0]["flockenv"],
        "commit": ", ".join(sorted({provenance["commit"] for provenance in provenances})),
        "seed": ", ".join(provenance["seed"] for provenance in provenances),
        **{
            name: f"{sum(float(provenance[name]) for provenance in provenances):.10g}"
            for name in ("samples", "flock_hours", "cpu_s")
        },
    }


def mean_of(laws: list[LeaningLaw], provenance: dict[str, str] | None = None) -> LeaningLaw:
    """Return the law with the mean weights and the mean bias of these laws of one pool."""
    pool = laws[0].pool
    weights = {
        name: float(np.mean([law.weights[name] for law in laws])) for name in laws[0].weights
    }
    bias = float(np.mean([law.bias for law in laws]))
    return LeaningLaw(pool, bias, weights, bound=BOUND[pool], provenance=provenance or {})


def validated(settings: Settings, pool: str, candidates: dict[str, Any]) -> pd.DataFrame:
    """Return the order of each candidate in the validation flocks, by number of leaders."""
    seeds = POLICY_SEEDS["validation"].seeds(settings.validation_flocks)
    rows = []
    for name, policy in candidates.items():
        row = {
            f"leaders_{k}": orders(policy, pool, k, seeds, settings.episode_s).mean()
            for k in (1, 2, 3, 4)
        }
        rows.append({"policy": name, **row, "score": np.mean(list(row.values()))})
    return pd.DataFrame(rows)


def trained(settings: Settings, pool: str, out: Path, command: str) -> dict[str, LeaningLaw]:
    """Run the trainings without a stored policy, and return the policy of each seed."""
    laws = {}
    for seed in settings.seeds:
        folder = out / pool / str(seed)
        path = folder / "policy.json"
        folder.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            MAKERS[pool](settings, seed, folder, command).save(path)
        laws[f"seed {seed}"] = LeaningLaw.load(path)
    return laws


def judged(settings: Settings, pool: str, law: LeaningLaw) -> dict[str, Any]:
    """Return the order of new flocks that three leaders with this law lead, and their settings."""
    seeds = release_seeds("pretrained", settings.judging_flocks)
    flock_orders = orders(law, pool, 3, seeds, settings.episode_s)
    score = score_policies({"law": flock_orders}).loc[0, ["signed_order", "low", "high"]]
    signed_order, low, high = (round(float(value), 3) for value in score)
    return {
        "signed_order": signed_order,
        "interval": [low, high],
        "n_boats": 27,
        "n_leaders": 3,
        "bw_s": FlockParameters.critical_bw_s("simulation", pool),
        "episode_s": settings.episode_s,
        "seeds": [seeds[0], seeds[-1]],
    }


def make(settings: Settings, pool: str, out: Path, command: str) -> bool:
    """Train, choose, judge and write a pool's policy; return whether it ships."""
    laws = trained(settings, pool, out, command)
    candidates = {"mean": mean_of(list(laws.values())), **laws}
    to_beat: dict[str, Any] = {"tuned law": DampedLaw.tuned(pool)}
    if (SHIPPED / f"{pool}.json").exists():
        to_beat["ships"] = LeaningLaw.learned(pool)
    scores = validated(settings, pool, {**to_beat, **candidates})
    scores.round(4).to_csv(out / f"validation-{pool}.csv", index=False)
    print(f"{pool}, validation flocks\n{scores.round(3).to_string(index=False)}", flush=True)
    score = scores.set_index("policy")["score"]
    best = str(score[list(laws)].idxmax())
    chosen = "mean" if score["mean"] >= score[best] else best
    parents = list(laws.values()) if chosen == "mean" else [laws[chosen]]
    rule = f"{chosen} of seeds {', '.join(map(str, settings.seeds))}, by validation flocks"
    law = candidates[chosen]
    judgment = judged(settings, pool, law)
    provenance = combined_provenance(parents, command, rule)
    options = {"bound": BOUND[pool], "judged": judgment, "provenance": provenance}
    LeaningLaw(pool, law.bias, law.weights, **options).save(out / f"{pool}.json")
    low, high = judgment["interval"]
    reached = f"{judgment['signed_order']:.3f} [{low:.3f}, {high:.3f}]"
    print(f"{pool}: {chosen}, signed order {reached}", flush=True)
    return bool(score[chosen] >= score[list(to_beat)].max())


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=tuple(MAKERS), action="append", help="[both]")
    parser.add_argument("--trial", action="store_true", help="every step with few flocks")
    parser.add_argument("--ship", action="store_true", help="copy into the core if it passes")
    parser.add_argument("--out", type=Path, default=Path("results/pretrained"))
    options = parser.parse_args(arguments)
    if options.trial and options.ship:
        parser.error("what a trial makes does not ship")
    words = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/pretrained.py", *words])
    for pool in options.pool or MAKERS:
        passes = make(TRIAL if options.trial else Settings(), pool, options.out, command)
        if options.ship and passes:
            shutil.copyfile(options.out / f"{pool}.json", SHIPPED / f"{pool}.json")


if __name__ == "__main__":
    main()
