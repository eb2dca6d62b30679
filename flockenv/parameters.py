"""Every constant that defines a scene. Values and range checks live in the Rust core."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Self

import tomli_w

from flockenv import _core
from flockenv._io.toml import read_toml
from flockenv.errors import ParameterError

__all__ = ["FlockParameters"]

_DEFAULTS = _core.preset_fields("simulation")


def _field(name: str, doc: str) -> Any:
    return field(default=_DEFAULTS[name], metadata={"doc": doc})


@dataclass(frozen=True, slots=True, kw_only=True)
class FlockParameters:
    """Parameters of a flock: frozen, checked once on construction, hashable, picklable.

    Fields that are not given have the values of the preset ``"simulation"``. They are stored as
    plain Python numbers and strings, and a pool that equals a named one is stored as its name.

    Raises
    ------
    ParameterError
        For a value out of range or an unknown field; the message names the field, the value and
        what would be accepted.
    TypeError
        For a value of the wrong type.
    """

    n_boats: int = _field("n_boats", "Number of boats, leaders included (Table 3: n).")
    n_leaders: int = _field("n_leaders", "Number of steerable leaders, boats 0..k-1 (Table 3: k).")
    pool: str | tuple[float, float] = _field(
        "pool",
        '"500-boats" (radii 180 and 97 cm, the free space of Section 2.2), "table-1" '
        "(90 and 48.5 cm, Table 1 as printed) or (outer_radius_cm, inner_radius_cm); inner 0: no "
        "obstacle, outer infinite: open water.",
    )
    boat_radius_cm: float = _field(
        "boat_radius_cm", "Radius of the hull's end discs in cm (Table 3: r)."
    )
    boat_shape: float = _field(
        "boat_shape", "Half-length of the hull's core segment over its radius (Table 3: p)."
    )
    gyration_radius_cm: float = _field(
        "gyration_radius_cm",
        "Radius of gyration in cm (Table 3: ρ; the exact stadium has 4.690).",
    )
    speed_cm_s: float = _field("speed_cm_s", "Preferred forward speed in cm/s (Table 3: v0 in fw).")
    reverse_speed_cm_s: float = _field(
        "reverse_speed_cm_s", "Preferred backward speed in cm/s, positive (Table 3: -v0 in bw)."
    )
    c0: float = _field("c0", "Convergence rate of the velocity in 1/s (eq. 8).")
    c1: float = _field("c1", "Cubic damping of the angular velocity in s (eq. 9).")
    c2: float = _field("c2", "Gain of the rudder in 1/(cm·s) (eq. 9).")
    c3: float = _field("c3", "Weathervane stabilisation of forward motion in 1/cm (eq. 9).")
    c4: float = _field(
        "c4",
        "Strength of the angular noise in rad/s^1.5 (white) or rad/s² (per-step) (eq. 9).",
    )
    fw_s: float = _field("fw_s", "Duration of the forward phase in s (Section 2.1).")
    nop1_s: float = _field("nop1_s", "Duration of the drift after the forward phase in s.")
    bw_s: float = _field("bw_s", "Duration of the backward phase in s: the noise level.")
    nop2_s: float = _field("nop2_s", "Duration of the drift after the backward phase in s.")
    leaders_reverse: bool = _field(
        "leaders_reverse",
        "Whether leaders back up in the bw phase (in the experiment their motor ran in fw only).",
    )
    target: str = _field(
        "target",
        'Direction that eq. (10) steers leaders to: "cw" (LAP orientation +π/2) or "ccw" (-π/2).',
    )
    scheme: str = _field(
        "scheme",
        'How a time step is taken: "leapfrog" (second order), "moreau" (first order) or "paper" '
        "(the appendix taken literally).",
    )
    noise: str = _field(
        "noise",
        'What η of eq. (9) means: "white" (increment c4·sqrt(dt)·N(0, 1)) or "per-step" '
        "(c4·dt·N(0, 1)).",
    )
    solver: str = _field(
        "solver",
        'How contacts are solved: "block-pivoting" (exact), or for comparison "gauss-seidel" or '
        '"clarabel".',
    )
    dt_s: float = _field("dt_s", "Longest substep in s, rounded to 1 ns.")
    overlap_tolerance_cm: float = _field(
        "overlap_tolerance_cm",
        "Overlap that the paper scheme accepts without a projection, in cm.",
    )
    relinearizations: int = _field(
        "relinearizations",
        "How well gaps hold at a substep's end: 0 linearized once; 1 and 2 re-evaluated and solved "
        "again until overlaps are at most 1e-6 and 1e-9 cm.",
    )
    turning_bias: float = _field(
        "turning_bias",
        "Constant rudder of the normal boats in [-1, 1], positive turns counter-clockwise "
        "(Section 4.5); 0: off.",
    )
    speed_spread_cm_s: float = _field(
        "speed_spread_cm_s",
        "Half-width of the uniform spread of the boats' forward speeds in cm/s (Table 1); backward "
        "speeds scale along; 0: off.",
    )
    current_gain: float = _field(
        "current_gain",
        "κ of the net tangential water current -κ·(mean tangential velocity) (Section 4.5); "
        "0: off.",
    )
    current_cap_cm_s: float = _field(
        "current_cap_cm_s", "Cap of that current's speed in cm/s (Section 4.5)."
    )

    def __new__(cls, **values: Any) -> Self:
        """Refuse unknown fields with the nearest name, which a dataclass would not tell."""
        _refuse_unknown(values)
        return object.__new__(cls)

    def __post_init__(self) -> None:
        for name, value in _core.checked_fields(self).items():
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        # Through the constructor, so that what is unpickled is checked too.
        return type(self).from_dict, (self.to_dict(),)

    @classmethod
    def presets(cls) -> list[str]:
        """Names of the presets."""
        return _core.preset_names()

    @classmethod
    def preset(cls, name: str) -> Self:
        """Return a named set of parameters.

        Parameters
        ----------
        name
            ``"simulation"``: Table 3 with `leapfrog` and white noise, whose statistics do not
            depend on dt. ``"paper"``: Table 3 with the paper's literal scheme and per-step noise.
            ``"experiment"``: Table 1, with constants fitted to Section 4 by ``flockenv fit``.

        Raises
        ------
        ParameterError
            For an unknown name.
        """
        return cls(**_core.preset_fields(name))

    @classmethod
    def preset_sources(cls, name: str) -> dict[str, str]:
        """Return where each number of a preset comes from, by field.

        Raises
        ------
        ParameterError
            For an unknown name.
        """
        return _core.preset_sources(name)

    @classmethod
    def critical_bw_s(cls, preset: str, pool: str | tuple[float, float]) -> float:
        """Critical noise of 27 boats: where leaderless order is lost.

        The length of the backward phase, in s, at which mean Ψ_o of leaderless runs falls through
        the middle between its ordered and its disordered level; measured by
        ``baselines/critical_noise.py`` for Table 3's presets in both named pools, for
        ``"experiment"`` in ``"table-1"``.

        Raises
        ------
        ParameterError
            For an unknown preset or pool, and for a pool in which it has not been measured.
        """
        bw_s = _core.critical_bw_s(preset, pool)
        if bw_s is None:
            raise ParameterError(
                f"pool = {pool!r}: the critical noise of preset {preset!r} has not been measured "
                "there. Choose another pool, or name a noise level yourself (bw_s; on the command "
                "line `--pool table-1` or `--set bw_s=1.0`); baselines/critical_noise.py measures "
                "it"
            )
        return bw_s

    def replace(self, **changes: Any) -> Self:
        """Return these parameters with some fields changed; see the class for the errors."""
        return type(self)(**{**self.to_dict(), **changes})

    def to_dict(self) -> dict[str, Any]:
        """Every field by name: ints, floats, bools, strings, and a tuple for an unnamed pool."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Return parameters from fields by name.

        Parameters
        ----------
        values
            Any of the fields. ``"preset"`` may name the preset whose values the missing fields
            take, ``"simulation"`` otherwise.

        Raises
        ------
        ParameterError, TypeError
            As for the class.
        """
        if not isinstance(values, Mapping):
            raise TypeError(f"parameters must be a mapping of fields, not {type(values).__name__}")
        changes = dict(values)
        base = cls.preset(changes.pop("preset", "simulation"))
        return base.replace(**{str(name): value for name, value in changes.items()})

    def to_toml(self) -> str:
        """Return the parameters as TOML, every field on a line of its own."""
        return tomli_w.dumps(self.to_dict())

    @classmethod
    def from_toml(cls, text: str) -> Self:
        """Return parameters from TOML; keys are those of `from_dict`.

        Raises
        ------
        ParameterError
            For text that is no TOML, and as for the class.
        TypeError
            For what is no text, and as for the class.
        """
        return cls.from_dict(read_toml(text, "the text of parameters"))


_NAMES = tuple(each.name for each in fields(FlockParameters))


def _refuse_unknown(names: Iterable[str]) -> None:
    for name in names:
        if name in _NAMES:
            continue
        near = difflib.get_close_matches(name, _NAMES, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(_NAMES)}"
        raise ParameterError(f"{name!r} is no field of FlockParameters: {hint}")


def _attributes() -> str:
    """Return the fields' own descriptions as a numpydoc section."""
    lines = ["    Attributes", "    ----------"]
    for each in fields(FlockParameters):
        kind = (
            each.type if isinstance(each.type, str) else getattr(each.type, "__name__", each.type)
        )
        lines += [f"    {each.name} : {kind}", f"        {each.metadata['doc']}"]
    return "\n".join(lines)


FlockParameters.__doc__ = f"{(FlockParameters.__doc__ or '').rstrip()}\n\n{_attributes()}\n    "
