"""Policies as vectors of numbers that a search moves: networks and leaning laws."""

import itertools
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

import flockenv
from flockenv.envs.observation import observation_entries
from flockenv.policies import DampedLaw, HiddenUnits, LeaningLaw, NetworkPolicy
from flockenv.policies.laws import stacked_rudders
from flockenv.policies.leaning_law import (
    FEATURES,
    FELLOW_FEATURES,
    FURTHER_FEATURES,
    GAINS,
    features,
    leaned,
    observed_features,
)

NAMES = [entry.name for entry in observation_entries()]


class Form(Protocol):
    """A kind of policy, as vectors of numbers; it observes the default layout and `blocks`."""

    size: int
    blocks: dict[str, Any]

    def steering(self, flat: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """What maps rows (candidates, rows, inputs) to rudders, for vectors (candidates, size)."""

    def policy(self, flat: np.ndarray, provenance: dict[str, str]) -> NetworkPolicy | LeaningLaw:
        """Return the policy of one vector."""

    def first(self, random: np.random.Generator) -> np.ndarray:
        """Return the vector that a search starts from."""


class Shape:
    """A network's layers within one vector of weights."""

    def __init__(
        self, inputs: int, hidden: list[int], blocks: dict[str, Any] | None = None
    ) -> None:
        self.blocks = blocks or {}
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
            observation=self.blocks,
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
    """A leaning law's numbers within one vector; a step of 1 is worth trying for each of them.

    They are logarithms of gains, the bias and the weights, and with hidden units the units'
    outputs, biases and weights. The zero vector is the initial law. Hidden units that it does not
    have are drawn at random, with outputs of zero.
    """

    log_gain_steps, bias_step_rad, lean_step_rad = np.array([0.3, 0.4, 0.3]), 0.12, 0.1
    #: Of a hidden unit's bias, and of the root mean square of what its weights change in it.
    unit_step = 0.3

    def __init__(
        self,
        initial: DampedLaw | LeaningLaw,
        watched: Sequence[tuple[flockenv.LeadersVectorEnv, list[int], int]],
        wanted: Sequence[str] = FEATURES,
        hidden: int = 0,
        random: np.random.Generator | None = None,
    ) -> None:
        """Measure the features of the initial law's observations, so that all get equal steps.

        Parameters
        ----------
        initial
            The law, for the observations of the environments.
        watched
            Environments, seeds and control steps to measure in.
        wanted, hidden
            The features, and the number of hidden units.
        random
            Where hidden units are drawn from.
        """
        self.initial, self.wanted, self.hidden = initial, tuple(wanted), hidden
        self.blocks = dict(initial.observation)
        self.names = [entry.name for entry in observation_entries(self.blocks)]
        means, deviations = [], []
        for env, seeds, steps in watched:
            rows, _ = env.reset(seed=seeds)
            seen = []
            for _ in range(steps):
                rows, *_ = env.step(initial.predict(rows)[0])
                seen.append(features(rows.reshape(-1, len(self.names)), self.names, self.wanted))
            means.append(np.mean(seen, axis=(0, 1)))
            deviations.append(np.std(seen, axis=(0, 1)))
        # Of a mixture: deviations within scenarios and between them.
        self.usual = np.mean(means, axis=0)
        spread = deviations[0]
        if len(watched) > 1:
            spread = np.sqrt(np.mean(np.square(deviations), axis=0) + np.var(means, axis=0))
        spread = np.maximum(spread, 0.05)
        self.steps = self.lean_step_rad / spread
        self.unit_steps = self.unit_step / np.sqrt(len(self.wanted)) / spread
        self.size = len(GAINS) + 1 + len(self.wanted) + hidden * (2 + len(self.wanted))
        law = initial if isinstance(initial, LeaningLaw) else LeaningLaw(initial.gains, 0.0, {})
        self._gains = np.array([law.gains[name] for name in GAINS])
        self._bias = law.bias
        self._weights = np.array([law.weights.get(name, 0.0) for name in self.wanted])
        self._units = self._first_units(law.hidden, spread, random) if hidden else None

    def _first_units(
        self, given: HiddenUnits | None, spread: np.ndarray, random: np.random.Generator | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        random = random or np.random.default_rng(0)
        inner = random.standard_normal((len(self.wanted), self.hidden))
        inner /= np.sqrt(len(self.wanted)) * spread[:, None]
        biases = random.uniform(-1.0, 1.0, self.hidden) - self.usual @ inner
        outputs = np.zeros(self.hidden)
        if given is not None:
            count = len(given)
            inner[:, :count], biases[:count], outputs[:count] = given.arrays(self.wanted)
        return inner, biases, outputs

    def split(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gains, biases and weights of vectors (..., size)."""
        start = len(GAINS) + 1
        gains = self._gains * np.exp(self.log_gain_steps * flat[..., : len(GAINS)])
        weights = self.steps * flat[..., start : start + len(self.wanted)]
        bias = self.bias_step_rad * flat[..., len(GAINS)] - weights @ self.usual
        return gains, self._bias + bias, self._weights + weights

    def units(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Weights, biases and outputs of the hidden units of vectors (..., size), if there are."""
        if self._units is None:
            return None
        inner, biases, outputs = self._units
        rest = flat[..., len(GAINS) + 1 + len(self.wanted) :]
        own, shifts, turned = np.split(rest, [self.hidden, 2 * self.hidden], axis=-1)
        changes = turned.reshape(*flat.shape[:-1], len(self.wanted), self.hidden)
        changes = self.unit_steps[:, None] * changes
        shifts = self.unit_step * shifts - self.usual @ changes
        return inner + changes, biases + shifts, outputs + self.lean_step_rad * own

    def steering(self, flat: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """What maps rows (candidates, rows, size) to rudders, for vectors (candidates, size)."""
        (gains, bias, weights), units = self.split(flat), self.units(flat)
        laws = [
            DampedLaw(*each, observation=self.blocks, mirror_to_target=True)
            for each in gains.tolist()
        ]

        def steer(rows: np.ndarray) -> np.ndarray:
            turned = leaned(rows, bias, weights, self.names, self.wanted, units)
            return stacked_rudders(laws, turned)

        return steer

    def policy(self, flat: np.ndarray, provenance: dict[str, str]) -> LeaningLaw:
        (gains, bias, weights), units = self.split(flat), self.units(flat)
        hidden = None
        if units is not None:
            inner, biases, outputs = units
            hidden = HiddenUnits(dict(zip(self.wanted, inner, strict=True)), biases, outputs)
        return LeaningLaw(
            dict(zip(GAINS, gains.tolist(), strict=True)),
            float(bias),
            dict(zip(self.wanted, weights.tolist(), strict=True)),
            hidden=hidden,
            observation=self.blocks,
            provenance=provenance,
        )

    def first(self, random: np.random.Generator) -> np.ndarray:
        """Return the initial law."""
        return np.zeros(self.size)


def law_observing(law: DampedLaw | LeaningLaw, blocks: dict[str, Any]) -> DampedLaw | LeaningLaw:
    """Return a law for observations with these blocks, mirrored to the target."""
    if isinstance(law, DampedLaw):
        return DampedLaw(**law.gains, observation=blocks, mirror_to_target=True)
    return LeaningLaw(law.gains, law.bias, law.weights, hidden=law.hidden, observation=blocks)


def features_of(law: DampedLaw | LeaningLaw, *, every: bool) -> tuple[str, ...]:
    """Return the features that a search gives a law: its own, and those that it may have.

    Those are `FEATURES` and the gaps to fellow leaders, or every one that is observed.
    """
    observed = observed_features([entry.name for entry in observation_entries(law.observation)])
    own = law.features if isinstance(law, LeaningLaw) else ()
    wanted = {*FEATURES, *own, *(observed if every else {*observed} & {*FELLOW_FEATURES})}
    return tuple(name for name in (*FEATURES, *FURTHER_FEATURES) if name in wanted)
