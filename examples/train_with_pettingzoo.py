"""PPO in one file on PettingZoo's parallel environment: one network for all leaders.

    python examples/train_with_pettingzoo.py            # 200 episodes of a flock
    python examples/train_with_pettingzoo.py 2          # two, to see that it runs

Needs torch (extra `train`). The environment is one flock of `flockenv/Order-easy-v0`, whose four
leaders are four agents. `docs/train.md` steps 64 flocks at once, which is much faster; this file is
a start for your own loop over agents.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pettingzoo
import torch
from torch import nn
from torch.distributions import Normal

import flockenv  # noqa: F401 - registers the environments
from flockenv.policies import NetworkPolicy


@dataclass
class Settings:
    """Settings of the training; one sample is one agent's decision."""

    episodes: int = 200
    seed: int = 0
    learning_rate: float = 1e-3
    gamma: float = 0.99
    gae_lambda: float = 0.95
    epochs: int = 6
    minibatches: int = 4
    clip: float = 0.2
    value_weight: float = 0.5
    largest_gradient: float = 0.5
    first_log_std: float = -0.5
    out: Path = Path("results/train_with_pettingzoo/policy.npz")


def network(inputs: int, last_gain: float) -> nn.Sequential:
    """Return a network with one output and orthogonal weights."""
    sizes = ((inputs, 32, 2**0.5), (32, 32, 2**0.5), (32, 1, last_gain))
    layers: list[nn.Module] = []
    for size_in, size_out, gain in sizes:
        layer = nn.Linear(size_in, size_out)
        nn.init.orthogonal_(layer.weight, gain)
        nn.init.zeros_(layer.bias)
        layers += [layer, nn.Tanh()]
    return nn.Sequential(*layers[:-1])


settings = Settings(*map(int, sys.argv[1:2]))
torch.manual_seed(settings.seed)
torch.set_num_threads(1)

env = pettingzoo.make("parallel", "flockenv/Order-easy-v0")
agents = env.possible_agents
space = env.observation_space(agents[0])
actor, critic = network(space.shape[0], 0.01), network(space.shape[0], 1.0)
log_std = nn.Parameter(torch.full((1,), settings.first_log_std))
parameters = [*actor.parameters(), log_std, *critic.parameters()]
optimizer = torch.optim.Adam(parameters, settings.learning_rate, eps=1e-5)


def stacked(by_agent: dict[str, np.ndarray]) -> torch.Tensor:
    """Return the arrays of all agents, a row for each agent."""
    return torch.tensor(np.array([by_agent[agent] for agent in agents]), dtype=torch.float32)


# Seeds from 2³² on are for training.
first_seed = (1 << 32) + settings.seed * (1 << 20)
for episode in range(settings.episodes):
    optimizer.param_groups[0]["lr"] = settings.learning_rate * (1.0 - episode / settings.episodes)

    # One episode, in which every agent explores.
    observations, infos = env.reset(seed=first_seed + episode)
    observed, actions, log_probs, rewards = [], [], [], []
    with torch.no_grad():
        while env.agents:
            observed.append(stacked(observations))
            distribution = Normal(actor(observed[-1]).squeeze(-1), log_std.exp())
            actions.append(distribution.sample())
            log_probs.append(distribution.log_prob(actions[-1]))
            rudders = actions[-1].clamp(-1.0, 1.0).numpy()
            by_agent = {agent: rudders[[index]] for index, agent in enumerate(agents)}
            observations, step_rewards, _, _, infos = env.step(by_agent)
            rewards.append(stacked(step_rewards))
        observed.append(stacked(observations))

        # Advantages, backward in time. The episode ended only by its time limit, so its last state
        # still has a value.
        rows = torch.stack(observed)
        values = critic(rows).squeeze(-1)
        advantages, advantage = torch.zeros_like(values[:-1]), torch.zeros(len(agents))
        for step in reversed(range(len(rewards))):
            error = rewards[step] + settings.gamma * values[step + 1] - values[step]
            advantage = error + settings.gamma * settings.gae_lambda * advantage
            advantages[step] = advantage
        returns = advantages + values[:-1]

    # The decisions of all agents are samples of one policy.
    batch = [
        tensor.flatten(0, 1)
        for tensor in (rows[:-1], torch.stack(actions), torch.stack(log_probs), advantages, returns)
    ]
    for _ in range(settings.epochs):
        for part in torch.randperm(len(batch[0])).chunk(settings.minibatches):
            states, taken, old_log_prob, gain, targets = (tensor[part] for tensor in batch)
            gain = (gain - gain.mean()) / (gain.std() + 1e-8)
            log_prob = Normal(actor(states).squeeze(-1), log_std.exp()).log_prob(taken)
            ratio = (log_prob - old_log_prob).exp()
            clipped = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip)
            actor_loss = -torch.minimum(ratio * gain, clipped * gain).mean()
            value_loss = (critic(states).squeeze(-1) - targets).pow(2).mean()
            loss = actor_loss + settings.value_weight * value_loss
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(parameters, settings.largest_gradient)
            optimizer.step()

    order = infos[agents[0]]["episode_summary"]["signed_order"]
    print(f"episode {episode}: signed order {order:.3f}")

settings.out.parent.mkdir(parents=True, exist_ok=True)
NetworkPolicy.from_module(actor, space, provenance={"command": " ".join(sys.argv)}).save(
    settings.out
)
print(f"written to {settings.out}")
