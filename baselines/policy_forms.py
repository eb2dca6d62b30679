"""Policies as vectors of numbers that a search moves: networks and leaning laws."""

import itertools
from collections.abc import Callable

import numpy as np

import flockenv
from flockenv.envs.observation import observation_entries
from flockenv.policies import DampedLaw, LeaningLaw, NetworkPolicy
from flockenv.policies.leaning_law import FEATURES, GAINS, features, leaned

NAMES = [entry.name for entry in observation_entries()]


class Shape:
    """A network's layers within one vector of weights."""

    def __init__(self, inputs: int, hidden: list[int]) -> None:
        sizes = [inputs, *hidden, 1]
        self.layers = list(itertools.pairwise(sizes))
        self.size = sum(i * o + o for i, o in self.layers)

    def split(self, flat: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Matrices and biases of vectors (..., size)."""
        parts, start = [], 0
        for i, o in self.layers:
            matrix = flat[..., start : start + i * o].reshape(*flat.shape[:-1], i, o)
            bias = flat[..., start + i * o : start + i * o + o]
            parts.append((matrix, bias[..., None, :]))
            start += i * o + o
        return parts

    def steering(self, flat: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """What maps rows (candidates, rows, inputs) to rudders, for weights (candidates, size)."""
        layers = self.split(flat.astype(np.float32))

        def steer(rows: np.ndarray) -> np.ndarray:
            for matrix, bias in layers[:-1]:
                rows = np.tanh(rows @ matrix + bias)
            matrix, bias = layers[-1]
            return np.clip(rows @ matrix + bias, -1.0, 1.0)[..., 0]

        return steer

    def policy(self, flat: np.ndarray, provenance: dict[str, str]) -> NetworkPolicy:
        layers = self.split(flat)
        return NetworkPolicy(
            [matrix for matrix, _ in layers],
            [bias[0] for _, bias in layers],
            "tanh",
            mirror_to_target=True,
            provenance=provenance,
        )

    def first(self, random: np.random.Generator) -> np.ndarray:
        """Small random hidden layers; an output layer of zeros: leaders that go straight ahead."""
        parts = [
            np.concatenate([random.standard_normal(i * o) / np.sqrt(i), np.zeros(o)])
            for i, o in self.layers
        ]
        parts[-1][:] = 0.0
        return np.concatenate(parts)


class LeaningShape:
    """A leaning law's numbers within one vector; a step of 1 is worth trying for each of them."""

    size = len(GAINS) + 1 + len(FEATURES)
    log_gain_steps, bias_step_rad, lean_step_rad = np.array([0.3, 0.4, 0.3]), 0.12, 0.1

    def __init__(
        self, initial: DampedLaw, env: flockenv.LeadersVectorEnv, seeds: list[int], steps: int
    ) -> None:
        """Measure the features of the initial law's observations, so that all get equal steps."""
        self.initial = initial
        rows, _ = env.reset(seed=seeds)
        seen = []
        for _ in range(steps):
            rows, *_ = env.step(initial.predict(rows)[0])
            seen.append(features(rows.reshape(-1, len(NAMES)), NAMES))
        self.usual = np.mean(seen, axis=(0, 1))
        self.steps = self.lean_step_rad / np.maximum(np.std(seen, axis=(0, 1)), 0.05)

    def split(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gains, biases and weights of vectors (..., size)."""
        initial = np.array([self.initial.gains[name] for name in GAINS])
        gains = initial * np.exp(self.log_gain_steps * flat[..., : len(GAINS)])
        weights = self.steps * flat[..., len(GAINS) + 1 :]
        bias = self.bias_step_rad * flat[..., len(GAINS)] - weights @ self.usual
        return gains, bias, weights

    def steering(self, flat: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """What maps rows (candidates, rows, size) to rudders, for vectors (candidates, size)."""
        gains, bias, weights = self.split(flat)
        laws = [DampedLaw(*each, mirror_to_target=True) for each in gains.tolist()]

        def steer(rows: np.ndarray) -> np.ndarray:
            turned = leaned(rows, bias, weights, NAMES)
            pairs = zip(laws, turned, strict=True)
            return np.stack([law.predict(each)[0][:, 0] for law, each in pairs])

        return steer

    def policy(self, flat: np.ndarray, provenance: dict[str, str]) -> LeaningLaw:
        gains, bias, weights = self.split(flat)
        return LeaningLaw(
            dict(zip(GAINS, gains.tolist(), strict=True)),
            float(bias),
            dict(zip(FEATURES, weights.tolist(), strict=True)),
            provenance=provenance,
        )

    def first(self, random: np.random.Generator) -> np.ndarray:
        """Return the initial law."""
        return np.zeros(self.size)
