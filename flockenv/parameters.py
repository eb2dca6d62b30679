"""Every constant that defines a flock. Values and range checks live in the Rust core."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, Self

import tomli_w

from flockenv import _core
from flockenv._io.arguments import materialized
from flockenv._io.toml import read_toml
from flockenv.errors import ParameterError, refuse_unknown, short_repr

_DECLARATIONS = {parameter["name"]: parameter for parameter in _core.PARAMETERS}

OBSTACLES = tuple(
    name for name, declared in _DECLARATIONS.items() if declared["kind"].startswith("tuple of ")
)
"""Fields with a row for each obstacle, in the order in which contacts number them."""


def _declared(name: str) -> Any:
    """Return a dataclass field with the core's declaration: default, unit, range and meaning."""
    return field(default=_DECLARATIONS[name]["default"], metadata=_DECLARATIONS[name])


@dataclass(frozen=True, kw_only=True)
class FlockParameters:
    """Parameters of a flock: frozen, checked once on construction, hashable, picklable.

    Fields that are not given have the values of the preset ``"simulation"``. They are stored as
    plain Python numbers and strings, a list of targets as a tuple, and a pool that equals a named
    one as its name.

    docs/environments/tables.md lists the fields with their meanings, units, ranges and values in
    the presets; ``dataclasses.fields`` has the same as metadata.

    Raises
    ------
    ParameterError
        For a value out of range or an unknown field; the message names the field, the value and
        what would be accepted.
    TypeError
        For a value of the wrong type.
    """

    n_boats: int = _declared("n_boats")
    n_leaders: int = _declared("n_leaders")
    pool: str | tuple[float, float] = _declared("pool")
    boat_radius_cm: float = _declared("boat_radius_cm")
    boat_shape: float = _declared("boat_shape")
    gyration_radius_cm: float = _declared("gyration_radius_cm")
    speed_cm_s: float = _declared("speed_cm_s")
    reverse_speed_cm_s: float = _declared("reverse_speed_cm_s")
    c0: float = _declared("c0")
    c1: float = _declared("c1")
    c2: float = _declared("c2")
    c3: float = _declared("c3")
    c4: float = _declared("c4")
    fw_s: float = _declared("fw_s")
    nop1_s: float = _declared("nop1_s")
    bw_s: float = _declared("bw_s")
    nop2_s: float = _declared("nop2_s")
    leaders_reverse: bool = _declared("leaders_reverse")
    target: str | tuple[str, ...] = _declared("target")
    scheme: str = _declared("scheme")
    noise_scheme: str = _declared("noise_scheme")
    solver: str = _declared("solver")
    dt_s: float = _declared("dt_s")
    overlap_tolerance_cm: float = _declared("overlap_tolerance_cm")
    tolerance_cm: float = _declared("tolerance_cm")
    turning_bias: float = _declared("turning_bias")
    speed_spread_cm_s: float = _declared("speed_spread_cm_s")
    current_gain: float = _declared("current_gain")
    current_cap_cm_s: float = _declared("current_cap_cm_s")
    discs: tuple[tuple[float, float, float], ...] = _declared("discs")
    walls: tuple[tuple[float, float, float, float], ...] = _declared("walls")
    leader_speed_factor: float = _declared("leader_speed_factor")
    current_relaxation_s: float = _declared("current_relaxation_s")

    if not TYPE_CHECKING:  # Editors complete the fields, as the dataclass declares them.

        def __init__(self, **values: object) -> None:
            self._set_core(_checked("simulation", values))

    @classmethod
    def _from_core(cls, core: _core.Parameters) -> Self:
        """Return the parameters that the core has checked."""
        parameters = cls.__new__(cls)
        parameters._set_core(core)
        return parameters

    def _set_core(self, core: _core.Parameters) -> None:
        vars(self).update(core.values, _in_core=core)

    @property
    def _in_core(self) -> _core.Parameters:
        """The checked values, as the core takes them."""
        core: _core.Parameters = vars(self)["_in_core"]
        return core

    def __reduce__(self) -> tuple[Any, ...]:
        # Unpickled parameters are checked, too.
        return type(self).from_dict, (self.to_dict(),)

    @classmethod
    def presets(cls) -> list[str]:
        """Return the names of the presets."""
        return list(_core.PRESETS)

    @classmethod
    def preset(cls, name: str) -> Self:
        """Return a named set of parameters.

        Parameters
        ----------
        name
            ``"simulation"``: Table 3 with `leapfrog` and white noise, whose statistics do not
            depend on dt. ``"paper"``: Table 3 with the paper's literal scheme and per-step noise.
            ``"experiment"``: Table 1, with constants fitted to Section 4.

        Raises
        ------
        ParameterError
            For an unknown name.
        """
        return cls._from_core(_core.Parameters(name, {}))

    @classmethod
    def preset_sources(cls, name: str) -> dict[str, str]:
        """Return where each number of a preset comes from, by field.

        Raises ParameterError for an unknown name.
        """
        return _core.preset_sources(name)

    @classmethod
    def critical_bw_s(
        cls, preset: str | None = None, pool: str | tuple[float, float] | None = None
    ) -> float:
        """Return the critical noise of 27 boats: the bw_s at which leaderless flocks lose order.

        At this noise the mean Ψ_o of leaderless runs falls through the middle between its ordered
        and its disordered level. ``studies/critical_noise`` measured it for Table 3's presets in
        both named pools, and for ``"experiment"`` in ``"narrow"``. Raises ParameterError for other
        presets and pools, since no value was measured for them.
        """
        if not isinstance(preset, str) or pool is None:
            raise ParameterError(
                "critical_bw_s takes a preset and a pool, as in FlockParameters.critical_bw_s("
                "'simulation', 'wide'), and is known for 27 boats with the preset's constants; for "
                "a flock of your own `flockenv sweep FILE.toml` measures it, with bw_s in the grid "
                "(docs/runs.md has the file)"
            )
        bw_s = _core.critical_bw_s(preset, pool)
        if bw_s is None:
            raise ParameterError(
                f"pool = {short_repr(pool)}: the critical noise of preset {preset!r} has not been "
                "measured there. Choose another pool, or give a backward duration (bw_s; on the "
                "command line `--pool narrow` or `--bw-s 1.0`); `flockenv sweep` measures it"
            )
        return bw_s

    @property
    def pool_radii_cm(self) -> tuple[float, float]:
        """Radii of the outer and the inner wall; the outer one is infinite in open water."""
        return _core.pool_radii_cm(self.pool)

    @property
    def common_target(self) -> str | None:
        """The direction that all leaders head for; None if they differ or there are no leaders."""
        targets = self.target if isinstance(self.target, tuple) else (self.target,)
        return targets[0] if self.n_leaders and len(set(targets)) == 1 else None

    def replace(self, **changes: object) -> Self:
        """Return these parameters with some fields changed; see the class for the errors.

        If the hull is resized, the radius of gyration scales with it, unless ``gyration_radius_cm``
        is among the changes.
        """
        return self._from_core(_checked(self._in_core, changes))

    def to_dict(self) -> dict[str, Any]:
        """Return every field by name, as plain numbers, bools, strings and tuples."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Return parameters from fields by name; see the class for the errors.

        Parameters
        ----------
        values
            Any of the fields. Missing fields have the values of the preset that ``"preset"`` names,
            or of ``"simulation"``.
        """
        if not isinstance(values, Mapping):
            raise TypeError(f"parameters must be a mapping of fields, not {type(values).__name__}")
        changes = {str(name): value for name, value in values.items()}
        return cls._from_core(_checked(changes.pop("preset", "simulation"), changes))

    def to_toml(self) -> str:
        """Return the parameters as TOML, one field per line."""
        return tomli_w.dumps(self.to_dict())

    @classmethod
    def from_toml(cls, text: str) -> Self:
        """Return parameters from TOML, with the keys of `from_dict`.

        Raises the errors of the class, and ParameterError for text that is not TOML.
        """
        return cls.from_dict(read_toml(text, "the text of parameters"))


_NAMES = tuple(parameter.name for parameter in fields(FlockParameters))


def _checked(base: _core.Parameters | str, changes: Mapping[str, Any]) -> _core.Parameters:
    """Return a preset, or other parameters, with some fields changed, after checking them."""
    refuse_unknown(changes, _NAMES, "field of FlockParameters")
    bw_s = changes.get("bw_s")
    if isinstance(bw_s, tuple | list) and len(bw_s) == 2:
        raise TypeError(
            f"bw_s must be a number, not {short_repr(bw_s)}: environments take a range, from which "
            "each episode draws its own, "
            'as in gymnasium.make("flockenv/Leaders-v0", bw_s=(0.1, 0.4))'
        )
    target = changes.get("target")
    if isinstance(target, str) and target in ("random", "alternate"):
        raise ParameterError(
            f'target = "{target}" is not accepted: "cw" or "ccw"; environments take it, as in '
            f'gymnasium.make("flockenv/Leaders-v0", target="{target}")'
        )
    return _core.Parameters(base, {name: _as_tuple(value) for name, value in changes.items()})


def _as_tuple(value: object) -> object:
    """Return an iterator, such as a generator of discs, as a tuple; other values unchanged."""
    items = materialized(value)
    return value if items is value else tuple(materialized(item) for item in items)
