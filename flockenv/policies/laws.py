"""Laws of leaders. Their formulas are in the Rust core, which can steer by them without Python."""

import copy
import json
import math
import os
from collections.abc import Callable, Mapping
from functools import partial
from hashlib import sha256
from numbers import Real
from typing import Any, ClassVar, Self, Unpack

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.arguments import number
from flockenv._io.atomic_write import write_text
from flockenv._io.toml import read_limited
from flockenv.envs.observation import observation_entries
from flockenv.errors import ParameterError, short_repr
from flockenv.policies.base import CONTROL_HZ, Layout, RowPolicy
from flockenv.policies.model import ModelPolicy, vec_normalize_of
from flockenv.policies.names import LEARNED, PAPERS_LAW, TUNED_LAW

LEAN_FEATURES: tuple[str, ...] = tuple(_core.LEAN_FEATURES)
"""The features of a lean, in the order of the observation's block ``lean_features``."""

LARGEST_LEAN: float = _core.LARGEST_LEAN
"""Angle in rad of an action of 1 with ``action_mode="lean"``."""


class LawPolicy(RowPolicy):
    """A law evaluated from observations, with the interface of an SB3 policy.

    Parameters
    ----------
    law
        The core's law. If no other policy steers, the core evaluates it without Python.
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.

    Raises
    ------
    ParameterError
        If a block that the law reads is switched off.
    """

    #: Attributes that only another law has otherwise, besides the gains.
    _fixed: ClassVar[tuple[str, ...]] = ("law", "gains", "observation", "mirror_to_target")

    def __init__(
        self, law: _core.Law, observation: Mapping[str, object] | None, mirror_to_target: bool
    ) -> None:
        super().__init__(observation=observation, mirror_to_target=mirror_to_target)
        self.law = law
        self._observed = _core.ObservedLaw(law, self.observation, mirror_to_target)

    @property
    def gains(self) -> dict[str, float]:
        """The gains by name; empty for the paper's law."""
        return dict(self.law.gains)

    @property
    def is_law_itself(self) -> bool:
        """Whether the core's law acts as this policy does: no subclass changes its rudders."""
        methods = ("predict", "_rudders", "_steer")
        return all(getattr(type(self), name) is getattr(LawPolicy, name) for name in methods)

    def __setattr__(self, name: str, value: object) -> None:
        """Set an attribute; raise AttributeError for those that the core's law depends on."""
        if hasattr(self, "_observed") and name in {*self._fixed, *self.gains}:
            raise AttributeError(f"{name!r} of {self!r} is fixed: make another law")
        super().__setattr__(name, value)

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        return self._observed.actions(rows)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        # Not by `__reduce__`: a subclass may have another constructor, and attributes of its own.
        copied, fixed = type(self).__new__(type(self)), ("law", "_observed")
        own = {name: value for name, value in vars(self).items() if name not in fixed}
        shared = {name: vars(self)[name] for name in fixed}
        vars(copied).update(copy.deepcopy(own, memo) | shared)
        return copied

    def __reduce__(self) -> tuple[object, ...]:
        constructor: Callable[..., object] = type(self)
        layout = {"observation": self.observation, "mirror_to_target": self.mirror_to_target}
        return partial(constructor, *self.gains.values(), **layout), ()

    def __repr__(self) -> str:
        gains = ", ".join(f"{name}={value:g}" for name, value in self.gains.items())
        return f"{type(self).__name__}({gains})"


class SteeringLaw(LawPolicy):
    """The paper's law, eq. (10): s = clamp(6·wrap(β - α)/π, -1, 1).

    β is the tangential heading of the target direction at the leader's own position. The
    law is evaluated once per control step, from the observation; `Flock.advance` without rudders
    evaluates it at every substep, from the pose.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations; see `LawPolicy`.
    """

    def __init__(
        self, *, observation: Mapping[str, object] | None = None, mirror_to_target: bool = False
    ) -> None:
        super().__init__(_core.Law.named(PAPERS_LAW), observation, mirror_to_target)


class NamedLaw(LawPolicy):
    """A law of the core without a Python class of its own, made by name.

    Parameters
    ----------
    name
        The name, one of those that `flockenv compare --policy` takes.
    observation, mirror_to_target
        Layout of the observations; see `LawPolicy`.

    Raises
    ------
    ParameterError
        For other names, and for laws that depend on the pool.
    """

    def __init__(
        self,
        name: str,
        *,
        observation: Mapping[str, object] | None = None,
        mirror_to_target: bool = False,
    ) -> None:
        super().__init__(_core.Law.named(name), observation, mirror_to_target)
        self.name = name

    def __reduce__(self) -> tuple[object, ...]:
        layout: Layout = {
            "observation": self.observation,
            "mirror_to_target": self.mirror_to_target,
        }
        return partial(type(self), self.name, **layout), ()

    def __repr__(self) -> str:
        return self.name


class DampedLaw(LawPolicy):
    """A law that steers well when backing, too, and counters the turning that makes boats spin.

    Moving forward: s = clamp(gain·wrap(β - α), -1, 1). Moving backward, where a rudder works in
    reverse: s = clamp(-backward_gain·wrap(β - α) + damping·α˙, -1, 1). The *tuned law* is this one
    with the gains that were tuned in the pool.

    Parameters
    ----------
    gain
        Rudder per rad of misalignment while moving forward; 6/π in eq. (10).
    backward_gain
        Rudder per rad of misalignment while moving backward.
    damping
        Rudder per rad/s of angular velocity while moving backward.
    observation, mirror_to_target
        Layout of the observations; see `LawPolicy`.

    Raises
    ------
    ParameterError
        For gains that are not finite.
    """

    def __init__(
        self,
        gain: float = 6.0 / math.pi,
        backward_gain: float = 6.0 / math.pi,
        damping: float = 3.0,
        *,
        observation: Mapping[str, object] | None = None,
        mirror_to_target: bool = False,
    ) -> None:
        gains = {"gain": gain, "backward_gain": backward_gain, "damping": damping}
        law = _core.Law.damped(*(number(value, name) for name, value in gains.items()))
        super().__init__(law, observation, mirror_to_target)

    @classmethod
    def tuned(cls, pool: str, **layout: Unpack[Layout]) -> Self:
        """Return the tuned law of a named pool, for observations with this layout.

        Raises ParameterError for other pools.
        """
        tuned_gains = dict(_core.Law.named(TUNED_LAW, pool).gains)
        return cls(*tuned_gains.values(), **layout)


class LeaningLaw(LawPolicy):
    """The damped law, steering to a heading that leans outward of the target's tangent.

    The lean is bias + Σ weight·feature in rad, bounded to ±1.2 rad. The observation's block
    ``lean_features`` has the features: standardized, in the frame of the target. In a file whose
    gains are null the sum is the rudder itself, bounded to ±1.

    Parameters
    ----------
    pool
        Name of the pool that it is for; its features are standardized by their usual values there.
    bias
        Lean in rad if every feature has its usual value.
    weights
        Rad per standard deviation of a feature, by its name in `LEAN_FEATURES`; missing features
        have 0.
    gains
        The gains of the damped law, by name. None: those tuned in the pool.
    bound
        How a lean is kept within ±1.2 rad: ``"tanh"`` or ``"clip"``.
    decision_period_s
        Time in s for which a lean is held, a whole number of control steps. None: one control step.
        If it is given, the gains have to be the tuned ones, and the policy's actions are leans, for
        environments with ``action_mode="lean"`` and this ``decision_period_s``.
    judged
        Scores of the law: ``signed_order``, its 95 % ``interval``, ``n_boats``, ``n_leaders``,
        ``bw_s``, ``episode_s``, and the first and the last of the ``seeds``.
    provenance
        The law's origin: short texts by name.

    Raises
    ------
    ParameterError
        For pools that have no lean features, unknown names, numbers that are not finite, and a
        `decision_period_s` with gains other than the tuned ones.
    """

    _fixed = (*LawPolicy._fixed, "bias", "weights")

    def __init__(
        self,
        pool: str,
        bias: float,
        weights: Mapping[str, float],
        *,
        gains: Mapping[str, float] | None = None,
        bound: str = "tanh",
        decision_period_s: float | None = None,
        judged: Mapping[str, object] | None = None,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        if gains is None:
            gains = dict(_core.Law.named(TUNED_LAW, pool).gains)
        values = {
            "format": 1,
            "pool": pool,
            "judged": judged,
            "gains": dict(gains),
            "bound": bound,
            "decision_period_s": decision_period_s,
            "bias": bias,
            "weights": dict.fromkeys(LEAN_FEATURES, 0.0) | dict(weights),
            "provenance": dict(provenance or {}),
        }
        self._set_from_json(_json_text(values))

    @classmethod
    def from_model(
        cls,
        model: Any,
        pool: str,
        *,
        judged: Mapping[str, object] | None = None,
        provenance: Mapping[str, str] | None = None,
    ) -> Self:
        """Return the law that a model of stable-baselines3 has learned; the law needs no torch.

        Parameters
        ----------
        model
            A model such as ``PPO`` whose actions are leans, trained on `LeaderVecEnv` with
            ``mirror_to_target=True`` and the observation's block ``lean_features`` alone. Its
            actor is linear (``net_arch={"pi": [], ...}``).
        pool
            Name of the pool that it was trained in.
        judged, provenance
            As for `LeaningLaw`.

        Raises
        ------
        ParameterError
            For models that observe, decide or act in another way, for models that were trained in
            ``VecNormalize``, and for weights that are not finite.
        """
        policy, model_policy = getattr(model, "policy", model), ModelPolicy(model)
        _check_is_leaning_law(model, model_policy)
        weights, bias = (
            LARGEST_LEAN * tensor.detach().cpu().double().numpy().ravel()
            for tensor in (policy.action_net.weight, policy.action_net.bias)
        )
        return cls(
            pool,
            bias.item(),
            dict(zip(LEAN_FEATURES, weights.tolist(), strict=True)),
            bound="tanh" if policy.squash_output else "clip",
            decision_period_s=model_policy.decision_period_s,
            judged=judged,
            provenance=provenance,
        )

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the law of a JSON text from `to_json`.

        Raises ParameterError for a text that is not a complete law.
        """
        law = cls.__new__(cls)
        law._set_from_json(text)
        return law

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a law from its JSON file, in which nothing is executed.

        Raises the errors of `flockenv.policies.load`.
        """
        content = read_limited(path, f"{path} is not a policy")
        try:
            return cls.from_json(content.decode("utf-8-sig"))
        except ValueError as error:
            raise ParameterError(f"{path} is not a complete policy: {error}") from error

    @classmethod
    def learned(cls, pool: str) -> Self:
        """Return the pretrained leaders of a named pool.

        Raises ParameterError for other pools.
        """
        return cls.from_json(_core.Law.named(LEARNED, pool).to_json())

    def _set_from_json(self, text: str) -> None:
        law = _core.Law.from_json(text)
        self._values = values = json.loads(law.to_json())
        self.pool: str = values["pool"]
        self.bias: float = values["bias"]
        self.weights: dict[str, float] = values["weights"]
        self.judged: dict[str, object] | None = values.get("judged")
        self.provenance: dict[str, str] = values.get("provenance", {})
        self.decision_period_s = values.get("decision_period_s")
        sum_is_rudder = values["gains"] is None
        action_is_lean = self.decision_period_s is not None and not sum_is_rudder
        self.action_mode = "lean" if action_is_lean else "rudder"
        # Only a law that steers to its lean itself reads the boat's own course.
        steers_to_lean = not (action_is_lean or sum_is_rudder)
        unread = {"phase": False, "target": False, "neighbors": 0, "order": False}
        layout = {"own": steers_to_lean, **unread, "lean_features": True}
        super().__init__(law, layout, mirror_to_target=True)

    def to_json(self) -> str:
        """Return the law as a JSON text, from which `from_json` makes the same law to the bit."""
        return self.law.to_json()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the law to a JSON file, whole or not at all.

        If it cannot be written, an OSError is raised and the old file is still there.
        """
        write_text(path, self.to_json() + "\n")

    @property
    def digest(self) -> str:
        """``sha256:`` and 12 digits of the SHA-256 of the law without `judged` and `provenance`."""
        numbers = {**self._values, "judged": None, "provenance": None}
        return f"sha256:{sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()[:12]}"

    def __reduce__(self) -> tuple[object, ...]:
        return LeaningLaw.from_json, (self.to_json(),)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.pool!r}, bias={self.bias:.3g}, 29 weights)"


def _check_is_leaning_law(model: Any, model_policy: ModelPolicy) -> None:
    """Refuse a model whose leans are not linear in the lean features."""
    policy = getattr(model, "policy", model)
    entries = [entry.name for entry in observation_entries(model_policy.observation)]
    hidden_layers = len(getattr(getattr(policy, "mlp_extractor", None), "policy_net", ()))
    # Usually the extractor has no weights, and only flattens observations.
    extractor = getattr(policy, "features_extractor", None)
    has_weights = extractor is not None and any(True for _ in extractor.parameters())
    has_layers = hidden_layers or has_weights or hasattr(policy, "lstm_actor")
    mode, control_hz = model_policy.action_mode, model_policy.control_hz
    for differs, property_words in (
        (mode != "lean", f"actions of action_mode {mode!r}"),
        (entries != [*LEAN_FEATURES], f"{len(entries)} numbers observed"),
        (not model_policy.mirror_to_target, "mirror_to_target=False"),
        (control_hz != CONTROL_HZ, f"{control_hz:g} control steps per second"),
        (model_policy.leaders != 1, f"{model_policy.leaders} leaders at once"),
        (vec_normalize_of(model) is not None, "VecNormalize around its environment"),
        (has_layers or not hasattr(policy, "action_net"), "an actor of more than one layer"),
    ):
        if differs:
            raise ParameterError(
                f"a model with {property_words} is not accepted as a leaning law: its leans must "
                f"be linear in the {len(LEAN_FEATURES)} lean features, with mirror_to_target=True"
            )


def _json_text(values: dict[str, object]) -> str:
    """Return the values of a law as JSON; refuse numbers that are not finite."""
    try:
        return json.dumps(values, allow_nan=False, default=_as_float)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"a law of {short_repr(values)} is not accepted: {error}") from error


def _as_float(value: object) -> float:
    """Return a number of a type that JSON does not know, such as NumPy's, as a float."""
    if isinstance(value, Real):
        return float(value)
    raise TypeError(f"{short_repr(value)} is not a number")
