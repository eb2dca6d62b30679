"""PPO in one file on the native vector environment, with a critic that sees the whole flock.

    python baselines/ppo_single_file.py                 # into results/ppo_single_file
    flockenv compare --policy results/ppo_single_file/policy.npz --pool narrow --set n_boats=9

With seed 0 and 102 400 samples, 8 s of one core, the order of 9 boats rises from 0.147 to 0.177, a
gain too small for 64 flocks to show. The file is meant to be read.

All leaders share one actor, which sees what its leader observes. The critic sees features of the
flock (`LeadersVectorEnv.flock_features`) and is needed only in training, so the actor is saved as a
policy that steers any number of leaders without torch. docs/training_reference.md runs it; needs
torch (extra `train`).
"""

import argparse
import csv
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch

import flockenv
from flockenv.policies import NetworkPolicy
from flockenv.runs.seeds import POLICY_SEEDS

#: Nine boats, two of them leaders that lean about the target's tangent every two seconds.
OPTIONS = {
    "n_boats": 9,
    "n_leaders": 2,
    "pool": "narrow",
    "action_mode": "lean",
    "decision_period_s": 2.0,
    "reward": {"contact_push": 1.0, "signed_order": 0.1},
    "reward_horizon_s": 40.0,
    "physics": "training",
    "episode_s": 40.0,
}


@dataclass(frozen=True)
class Settings:
    """Settings of the training; one sample is one leader's decision."""

    samples: int = 100_000
    seed: int = 0
    flocks: int = 64
    steps: int = 20
    epochs: int = 4
    minibatches: int = 4
    learning_rate: float = 1e-3
    gamma: float = 0.95
    gae_lambda: float = 0.95
    clip: float = 0.2
    value_weight: float = 0.5
    largest_gradient: float = 0.5
    first_log_std: float = -1.0
    hidden: int = 64


def layers(inputs: int, hidden: int, last_gain: float) -> torch.nn.Sequential:
    """Return a network with one output and orthogonal weights."""
    network = torch.nn.Sequential(
        torch.nn.Linear(inputs, hidden),
        torch.nn.Tanh(),
        torch.nn.Linear(hidden, hidden),
        torch.nn.Tanh(),
        torch.nn.Linear(hidden, 1),
    )
    for index, gain in ((0, 2**0.5), (2, 2**0.5), (4, last_gain)):
        torch.nn.init.orthogonal_(network[index].weight, gain)
        torch.nn.init.zeros_(network[index].bias)
    return network


class Learner:
    """The actor's and the critic's networks, and the optimizer of both."""

    def __init__(self, settings: Settings, env: flockenv.LeadersVectorEnv) -> None:
        self.settings, self.leaders = settings, env.num_leaders
        size = env.single_observation_space.shape[0] // self.leaders
        self.mean = layers(size, settings.hidden, 0.01)
        self.log_std = torch.nn.Parameter(torch.tensor(settings.first_log_std))
        self.critic = layers(env.flock_feature_space.shape[0], settings.hidden, 1.0)
        self.parameters = [*self.mean.parameters(), self.log_std, *self.critic.parameters()]
        self.optimizer = torch.optim.Adam(self.parameters, settings.learning_rate, eps=1e-5)

    def actions(self, observations: torch.Tensor) -> torch.distributions.Normal:
        """Return the distribution of actions, shape (flocks, leaders).

        `observations` has shape (flocks, leaders * size).
        """
        rows = observations.unflatten(-1, (self.leaders, -1))
        return torch.distributions.Normal(self.mean(rows).squeeze(-1), self.log_std.exp())

    def values(self, features: torch.Tensor) -> torch.Tensor:
        """Return the value of flocks from their features."""
        return self.critic(features).squeeze(-1)

    def update(self, rollout: dict[str, torch.Tensor]) -> None:
        """Update both networks in `epochs` passes over a rollout."""
        settings, size = self.settings, len(rollout["returns"])
        for _ in range(settings.epochs):
            for part in torch.randperm(size).chunk(settings.minibatches):
                batch = {name: values[part] for name, values in rollout.items()}
                advantages = batch["advantages"]
                normalized = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
                gain = normalized.unsqueeze(-1)
                log_probs = self.actions(batch["observations"]).log_prob(batch["actions"])
                ratio = (log_probs - batch["log_probs"]).exp()
                clipped = ratio.clamp(1 - settings.clip, 1 + settings.clip)
                actor_loss = -torch.minimum(ratio * gain, clipped * gain).mean()
                value_errors = self.values(batch["features"]) - batch["returns"]
                loss = actor_loss + settings.value_weight * value_errors.square().mean()
                self.optimizer.zero_grad()
                loss.backward()
                torch.nn.utils.clip_grad_norm_(self.parameters, settings.largest_gradient)
                self.optimizer.step()


@torch.no_grad()
def rollout_of(
    env: flockenv.LeadersVectorEnv, learner: Learner, observations: np.ndarray
) -> tuple[dict[str, torch.Tensor], np.ndarray, float]:
    """Return a rollout with advantages, the observations after it, and its mean reward."""
    settings = learner.settings
    steps: list[dict[str, torch.Tensor]] = []
    for _ in range(settings.steps):
        observed = torch.from_numpy(observations)
        features = torch.from_numpy(env.flock_features())
        distribution = learner.actions(observed)
        actions = distribution.sample()
        observations, rewards, _, truncated, _ = env.step(actions.numpy())
        # A truncated episode would have gone on, so its last state has a value, too.
        next_values = learner.values(torch.from_numpy(env.flock_features()))
        if truncated.any():
            observations, _ = env.reset(options={"reset_mask": truncated})
        steps.append(
            {
                "observations": observed,
                "features": features,
                "actions": actions,
                "log_probs": distribution.log_prob(actions),
                "rewards": torch.from_numpy(rewards.astype(np.float32)),
                "next_values": next_values,
                "continues": torch.from_numpy(~truncated).float(),
            }
        )
    stacked = {name: torch.stack([step[name] for step in steps]) for name in steps[0]}
    values = learner.values(stacked["features"])
    advantages = advantages_of(stacked, values, settings)
    rollout = {name: stacked[name] for name in ("observations", "features", "actions", "log_probs")}
    rollout |= {"advantages": advantages, "returns": advantages + values}
    flat = {name: values.flatten(0, 1) for name, values in rollout.items()}
    return flat, observations, float(stacked["rewards"].mean())


def advantages_of(
    steps: dict[str, torch.Tensor], values: torch.Tensor, settings: Settings
) -> torch.Tensor:
    """Return the advantages of the actions of each step, shape (steps, flocks).

    They are generalized advantage estimates (Schulman et al. 2016, eq. 16), backward in time.
    """
    errors = steps["rewards"] + settings.gamma * steps["next_values"] - values
    advantages, advantage = torch.empty_like(values), torch.zeros_like(values[0])
    decay = settings.gamma * settings.gae_lambda
    for step in reversed(range(len(values))):
        advantage = errors[step] + decay * steps["continues"][step] * advantage
        advantages[step] = advantage
    return advantages


def train(settings: Settings, out: Path, report=print) -> NetworkPolicy:
    """Train, and write the policy and the learning curve into a folder.

    With 0 samples the policy is the one that training starts from.
    """
    torch.manual_seed(settings.seed)
    torch.set_num_threads(1)
    env = flockenv.LeadersVectorEnv(settings.flocks, autoreset_mode="disabled", **OPTIONS)
    learner = Learner(settings, env)
    seeds = POLICY_SEEDS["training"].seeds(settings.flocks, run=settings.seed)
    observations, _ = env.reset(seed=seeds)
    start, samples, curve = time.perf_counter(), 0, []
    while samples < settings.samples:
        rollout, observations, reward = rollout_of(env, learner, observations)
        learner.update(rollout)
        samples += rollout["actions"].numel()
        curve.append({"samples": samples, "reward": reward})
        seconds = time.perf_counter() - start
        report(f"{samples} samples, mean reward {reward:.4f}, {seconds:.0f} s")
    policy = NetworkPolicy.from_module(
        learner.mean,
        env.single_observation_space,
        provenance={
            "learner": "baselines/ppo_single_file.py",
            **{name: str(value) for name, value in asdict(settings).items()},
        },
    )
    out.mkdir(parents=True, exist_ok=True)
    policy.save(out / "policy.npz")
    with (out / "curve.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, ["samples", "reward"])
        writer.writeheader()
        writer.writerows(curve)
    return policy


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=Settings.samples)
    parser.add_argument("--seed", type=int, default=Settings.seed)
    parser.add_argument("--flocks", type=int, default=Settings.flocks)
    parser.add_argument("--out", type=Path, default=Path("results/ppo_single_file"))
    options = vars(parser.parse_args(arguments))
    out = options.pop("out")
    train(Settings(**options), out)
    print(f"written to {out / 'policy.npz'}")


if __name__ == "__main__":
    main()
