"""Refuses to set an option as an attribute from outside the class, which would have no effect."""

import sys
from itertools import takewhile
from types import FrameType
from typing import ClassVar

from flockenv.envs.options import ARGUMENTS, NAMES
from flockenv.envs.reset_options import RESET_OPTIONS, UPCOMING_OPTIONS, Spellings


class FixedOptions:
    """An environment whose options cannot be set as attributes from outside.

    Names in another case or without their unit are refused, too. A user's subclass may still have
    such names as class attributes, or set them in its methods, except those in
    `_read_only_attributes`. Once such an attribute exists, it may be set from outside, too.
    """

    #: Attributes of this class that are named like an argument, and set once.
    _read_only_attributes: ClassVar[tuple[str, ...]] = ()
    #: The call that sets options of an episode.
    _next_episode: ClassVar[str] = "reset(options={...})"

    def __setattr__(self, name: str, value: object) -> None:
        """Set an attribute; raise AttributeError for an option, and say what sets it instead."""
        if (refusal := _refusal(name, self._next_episode)) is not None:
            caller = sys._getframe(1)
            if not _is_method_of(self, caller):
                self._refuse_from_outside(name)
            elif name in self._read_only_attributes:
                if not _is_same(vars(self).get(name, value), value):
                    raise AttributeError(refusal)
            elif not caller.f_globals.get("__name__", "").startswith("flockenv."):
                # A method of a user's subclass sets the subclass's own attribute.
                names = vars(self).get("_names_of_subclass", frozenset())
                vars(self)["_names_of_subclass"] = names | {name}
        super().__setattr__(name, value)

    def _refuse_from_outside(self, name: str) -> None:
        """Refuse to set an option, unless a user's subclass has an attribute of that name."""
        refusal = _refusal(name, self._next_episode)
        is_of_subclass = name in vars(self).get("_names_of_subclass", ())
        if name not in self._read_only_attributes:
            subclasses = takewhile(_is_user_defined, type(self).__mro__)
            is_of_subclass = is_of_subclass or any(name in vars(cls) for cls in subclasses)
        if refusal is not None and not is_of_subclass:
            raise AttributeError(refusal)


def _is_user_defined(cls: type) -> bool:
    return not cls.__module__.startswith("flockenv.")


def _is_method_of(env: object, frame: FrameType) -> bool:
    """Return whether a frame is that of a method of `env`, or of a classmethod that makes `env`."""
    cls = frame.f_locals.get("cls")
    return frame.f_locals.get("self") is env or (
        isinstance(cls, type) and issubclass(cls, FixedOptions) and isinstance(env, cls)
    )


def _is_same(first: object, second: object) -> bool:
    return first is second or (type(first) is type(second) and bool(first == second))


_OF_RESET = (*RESET_OPTIONS, "seed", "reset_mask")
_FIXED = (*NAMES, *ARGUMENTS, "parameters", "num_leaders", *_OF_RESET)
_SPELLINGS = Spellings(_FIXED, _FIXED)


def _refusal(name: str, next_episode: str) -> str | None:
    """Return why an attribute cannot be set; None if its name is not that of an option."""
    if name.startswith("_"):
        return None
    meant = _SPELLINGS.meant(name)
    if meant is None:
        return None
    if meant == "seed":
        advice = "it is given to a reset"
    elif meant in _OF_RESET:
        advice = f"{next_episode} sets {meant!r} for an episode"
        if meant in UPCOMING_OPTIONS:
            advice += f", set_next_episodes({meant}=...) for all that are to come"
    else:
        advice = "it is fixed when an environment is made: make another one to change it"
    return f"{name!r} cannot be set as an attribute: {advice}"
