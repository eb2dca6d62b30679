"""Check that PPO learns through each interface of the environment, on an easy task.

    python baselines/learning_check.py                      # all interfaces, 500 000 samples each
    python baselines/learning_check.py --interfaces vector --samples 20000

The task is easy on purpose: it has four normal boats and little noise, each leader is rewarded for
its own tangential velocity towards the target, and leaders decide twice per second (at ten
decisions per second, exploring rudders cancel out before a boat has turned, and learning takes
several times as long). Random rudders have a mean reward near zero. The learned policy is compared
with them on the same held-out seeds. The table goes to docs/learning-check.md.
"""

import argparse
import shlex
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from run_number import run_number
from script_end import one_line_end
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnv

import flockenv
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv

#: The task `easy`.
EASY: dict[str, Any] = {
    "n_boats": 6,
    "n_leaders": 2,
    "pool": "wide",
    "bw_s": 0.1,
    "target": "random",
    "control_hz": 2.0,
    "episode_s": 60.0,
    "reward": {"leader_velocity": 1.0},
}
RESULTS = Path(__file__).parents[1] / "docs" / "learning-check.md"


class GymnasiumVecEnv(VecEnv):
    """A Gymnasium vector environment with same-step autoreset, as SB3 takes them."""

    def __init__(self, env: flockenv.LeadersVectorEnv) -> None:
        assert env.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
        self.env = env
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> np.ndarray:
        observations, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        self.actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        observations, rewards, _, truncated, infos = self.env.step(self.actions)
        each: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for flock in np.flatnonzero(truncated):
            each[flock]["terminal_observation"] = infos["final_obs"][flock]
            each[flock]["TimeLimit.truncated"] = True
        return observations, rewards.astype(np.float32), truncated, each

    def close(self) -> None:
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self.env, attr_name)] * len(list(self._get_indices(indices)))

    # SB3 requires these two; PPO never calls them, and one batch has no attributes per slot.
    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError("the flocks of one batch share their attributes")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        raise NotImplementedError("the flocks of one batch share their methods")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        return [False] * self.num_envs


def parallel_interface() -> VecEnv:
    """The parallel environment's agents through LeaderVecEnv: a sample is a leader's step."""
    return LeaderVecEnv(16, **EASY)


def single_interface() -> VecEnv:
    """Gymnasium environments one by one: a sample is a flock's step."""
    return DummyVecEnv([lambda: flockenv.LeadersEnv(**EASY)] * 16)


def vector_interface() -> VecEnv:
    """The native Gymnasium vector environment: a sample is a flock's step."""
    return GymnasiumVecEnv(flockenv.LeadersVectorEnv(16, autoreset_mode="same_step", **EASY))


INTERFACES: dict[str, Callable[[], VecEnv]] = {
    "parallel": parallel_interface,
    "single": single_interface,
    "vector": vector_interface,
}


def train(interface: str, samples: int, seed: int) -> tuple[PPO, float]:
    """Return a policy trained through a interface, and the seconds it took."""
    env = INTERFACES[interface]()
    (first,) = POLICY_SEEDS["learning check"].seeds(1, seed)
    env.seed(first)
    model = PPO(
        "MlpPolicy",
        env,
        n_steps=128,
        batch_size=512,
        n_epochs=6,
        learning_rate=1e-3,
        gamma=0.98,
        ent_coef=0.002,
        policy_kwargs={"net_arch": [64, 64], "log_std_init": -0.5},
        device="cpu",
    )
    # The seed of PPO itself would seed the environment too, with other seeds than those above.
    model.set_random_seed(seed)
    env.seed(first)
    start = time.perf_counter()
    model.learn(samples)
    return model, time.perf_counter() - start


def mean_rewards(
    interface: str, episodes: int, act: Callable[[np.ndarray, np.random.Generator], np.ndarray]
) -> np.ndarray:
    """Return the mean reward per step of each held-out episode.

    `act` takes observations of shape (rows, size).
    """
    leaders = EASY["n_leaders"]
    env = flockenv.LeadersVectorEnv(episodes, autoreset_mode="disabled", **EASY)
    observations, _ = env.reset(seed=0)
    random, ended = np.random.default_rng(0), np.zeros(episodes, bool)
    rows = (episodes * leaders, -1) if interface == "parallel" else (episodes, -1)
    total, steps = np.zeros(episodes), 0
    while not ended.all():
        actions = act(observations.reshape(rows), random).reshape(episodes, leaders)
        observations, rewards, _, ended, _ = env.step(actions)
        total += rewards
        steps += 1
    return total / steps


def summary(values: np.ndarray) -> tuple[float, float, float]:
    """Return the mean and its 95 % interval, by the normal approximation."""
    mean, half = values.mean(), 1.96 * values.std(ddof=1) / np.sqrt(len(values))
    return float(mean), float(mean - half), float(mean + half)


def check(interface: str, samples: int, seed: int, episodes: int) -> dict[str, Any]:
    """Train through a interface and compare with random rudders on the same episodes."""
    model, seconds = train(interface, samples, seed)
    learned = mean_rewards(
        interface, episodes, lambda rows, _: model.predict(rows, deterministic=True)[0]
    )
    random = mean_rewards(
        interface,
        episodes,
        lambda rows, rng: rng.uniform(-1, 1, (episodes, EASY["n_leaders"])).astype(np.float32),
    )
    return {
        "interface": interface,
        "samples": model.num_timesteps,
        "seconds": round(seconds, 1),
        "learned": summary(learned),
        "random": summary(random),
        "clear": summary(learned)[1] > summary(random)[2],
    }


def _conclusion(results: list[dict[str, Any]]) -> str:
    learned = sum(each["clear"] for each in results)
    return (
        f"PPO of stable-baselines3 learns through {learned} of the {len(results)} interfaces of "
        "the environment: its interval lies above that of random rudders."
    )


def report(results: list[dict[str, Any]], command: str, seed: int, episodes: int) -> str:
    """Return the results as a page."""
    lines = [
        "# Learning check",
        "",
        f"{_conclusion(results)} The easy task of `baselines/learning_check.py` has "
        + ", ".join(f"`{k}={v!r}`" for k, v in EASY.items())
        + ".",
        "",
        f"The table holds the mean reward per control step over {episodes} held-out episodes, with "
        "95 % intervals. Random rudders steer the same episodes.",
        "",
        f"`{command}` wrote this page: seed {seed}, flockenv {flockenv.__version__}, observation "
        f"version {flockenv.envs.observation.OBSERVATION_VERSION}, torch {torch.__version__}.",
        "",
        "| interface | samples | training | learned | random rudders | intervals apart |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for each in results:
        learned, random = (
            f"{mean:.3f} [{low:.3f}, {high:.3f}]"
            for mean, low, high in (each["learned"], each["random"])
        )
        lines.append(
            f"| {each['interface']} | {each['samples']} | {each['seconds']:.0f} s | {learned} "
            f"| {random} | {'yes' if each['clear'] else 'no'} |"
        )
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--interfaces", nargs="+", choices=INTERFACES, default=list(INTERFACES))
    parser.add_argument("--samples", type=int, default=500_000)
    parser.add_argument("--episodes", type=int, default=128)
    parser.add_argument("--seed", type=run_number, default=0)
    parser.add_argument("--out", type=Path, default=RESULTS)
    options = parser.parse_args(arguments)
    # Small networks: more threads only wait for each other.
    torch.set_num_threads(1)
    results = []
    with one_line_end(lambda: "no page was written"):
        for interface in options.interfaces:
            results.append(check(interface, options.samples, options.seed, options.episodes))
            print(results[-1], flush=True)
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/learning_check.py", *given])
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(report(results, command, options.seed, options.episodes))
    print(f"written to {options.out}")
    return 0 if all(each["clear"] for each in results) else 1


if __name__ == "__main__":
    sys.exit(main())
