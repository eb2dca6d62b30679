"""Exceptions that users meet, and parts of their messages."""

import difflib
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, ClassVar, NoReturn

from flockenv._core import EpisodeError, FlockError, InUseError, ParameterError, SolverError

__all__ = [
    "EpisodeError",
    "FlockError",
    "HintsAtNames",
    "InUseError",
    "ParameterError",
    "SolverError",
    "UnknownOptionError",
    "hint",
    "nearest",
    "refuse_unknown",
    "short_repr",
]


class UnknownOptionError(ParameterError, TypeError):
    """An environment was given a keyword argument that is not one of its options.

    It is a `TypeError`, too, because libraries try optional arguments and drop those that raise a
    `TypeError` (TorchRL's ``GymEnv`` tries ``frameskip``).
    """


def short_repr(value: object) -> str:
    """Return the repr of a value for a message, cut after 80 characters."""
    try:
        text = repr(value)
    except Exception:  # An int of more than 4300 digits has no repr; a user's repr may fail.
        return "a value that cannot be printed"
    return text if len(text) <= 80 else f"{text[:80]}…"


def nearest(name: object, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Return the known name that is most similar to `name`; None if none reaches `cutoff`."""
    by_lower_case = {word.casefold(): word for word in known}
    matches = difflib.get_close_matches(str(name).casefold(), by_lower_case, n=1, cutoff=cutoff)
    return by_lower_case[matches[0]] if matches else None


def hint(name: object, known: Iterable[str]) -> str:
    """Return a suggestion for an unknown name, or all known names."""
    known = list(known)
    near = nearest(name, known)
    return f"did you mean {near!r}?" if near else f"there are {', '.join(known)}"


def refuse_unknown(names: Iterable[object], known: Iterable[str], noun: str) -> None:
    """Refuse unknown names; the error calls a name by a noun, such as "field of a state"."""
    known = list(known)
    for name in names:
        if name not in known:
            article = "an" if noun[0] in "aeiou" else "a"
            raise ParameterError(f"{name!r} is not {article} {noun}: {hint(name, known)}")


class HintsAtNames:
    """An object whose error for a missing attribute suggests the right name."""

    __slots__ = ()
    #: Hints for names that other libraries use.
    _meanings: ClassVar[Mapping[str, str]] = {}

    # Hidden from type checkers, which would accept any name as an attribute.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            message = f"{type(self).__name__!r} object has no attribute {name!r}"
            # Libraries look for private names; they need no suggestion.
            if not name.startswith("_"):
                near = nearest(name, (word for word in dir(type(self)) if word[0] != "_"))
                if meant := self._meanings.get(name, near and repr(near)):
                    message += f": did you mean {meant}?"
            raise AttributeError(message)
