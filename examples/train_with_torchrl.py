"""Train two leaders with PPO of TorchRL, 64 flocks at once, and save a policy for every command.

    python examples/train_with_torchrl.py      # 40 rollouts; another number may follow

All leaders share one actor, which sees what its leader observes. The critic sees the whole flock,
and gives its value to each leader.
"""

import sys
from pathlib import Path

import torch
from tensordict.nn import TensorDictModule, TensorDictSequential
from tensordict.nn.distributions import NormalParamExtractor
from torchrl.modules import MLP, ProbabilisticActor, TanhNormal
from torchrl.objectives import ClipPPOLoss, ValueEstimators

from flockenv.policies import NetworkPolicy
from flockenv.torchrl import LeadersEnv

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
ROLLOUTS = int([*sys.argv, "40"][1])  # the first argument, or 40
EPOCHS, BATCHES = 4, 4
FILE = Path("results/train_with_torchrl/policy.npz")

torch.manual_seed(0)
torch.set_num_threads(1)
env = LeadersEnv(64, state="features", **OPTIONS)
env.set_seed(1 << 32)  # comparisons never use seeds from here on
observed, state = env.observation_space.shape[0], env.observation_spec["state"].shape[-1]

network = MLP(observed, 2, num_cells=[64, 64], activation_class=torch.nn.Tanh)
torch.nn.init.zeros_(network[-1].weight)  # the first leaders do not lean
actor = ProbabilisticActor(
    TensorDictModule(
        torch.nn.Sequential(network, NormalParamExtractor()),
        in_keys=[("leaders", "observation")],
        out_keys=[("leaders", "loc"), ("leaders", "scale")],
    ),
    spec=env.full_action_spec_unbatched["leaders", "action"],
    in_keys=[("leaders", "loc"), ("leaders", "scale")],
    out_keys=[("leaders", "action")],
    distribution_class=TanhNormal,
    return_log_prob=True,
    log_prob_key=("leaders", "log_prob"),
)
critic = TensorDictSequential(
    TensorDictModule(
        MLP(state, 1, num_cells=[64, 64], activation_class=torch.nn.Tanh), ["state"], ["value"]
    ),
    TensorDictModule(
        lambda value: value.unsqueeze(-2).expand(*value.shape[:-1], env.num_leaders, 1),
        ["value"],
        [("leaders", "state_value")],
    ),
)
loss = ClipPPOLoss(actor, critic, clip_epsilon=0.2, entropy_coeff=0.0)
names = ("reward", "action", "done", "terminated", "advantage", "value_target")
loss.set_keys(
    **{name: ("leaders", name) for name in names},
    value=("leaders", "state_value"),
    sample_log_prob=("leaders", "log_prob"),
)
loss.make_value_estimator(ValueEstimators.GAE, gamma=0.95, lmbda=0.95)
optimizer = torch.optim.Adam(loss.parameters(), lr=1e-3)

for rollout in range(ROLLOUTS):
    with torch.no_grad():
        # One episode of each flock. The loss expects its end per leader.
        data = env.rollout(env.episode_steps, actor, break_when_any_done=False)
        for name in ("done", "terminated"):
            end = data["next", name].unsqueeze(-1)
            data["next", "leaders", name] = end.expand(*end.shape[:-2], env.num_leaders, 1)
        loss.value_estimator(
            data,
            params=loss.critic_network_params,
            target_params=loss.target_critic_network_params,
        )
        gain = data["leaders", "advantage"]
        data["leaders", "advantage"] = (gain - gain.mean()) / gain.std()
    samples = data.reshape(-1)
    for _ in range(EPOCHS):
        for part in torch.randperm(len(samples)).chunk(BATCHES):
            terms = loss(samples[part])
            optimizer.zero_grad()
            (terms["loss_objective"] + 0.5 * terms["loss_critic"]).backward()
            torch.nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
            optimizer.step()
    print(rollout + 1, "rollouts, mean reward", data["next", "leaders", "reward"].mean().item())

# The actor's mean, which needs no PyTorch; TanhNormal squashes it.
policy = NetworkPolicy.from_module(
    network,
    env.observation_space,
    squashed=True,
    has_spread=True,
    provenance={"learner": "TorchRL, PPO"},
)
FILE.parent.mkdir(parents=True, exist_ok=True)
policy.save(FILE)
