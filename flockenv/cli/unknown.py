"""An option that a command does not have is answered with the line to type."""

import shlex
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from flockenv.envs.options import OPTIONS
from flockenv.errors import ParameterError, nearest
from flockenv.parameters import FlockParameters

_FIELDS = tuple(each.name for each in fields(FlockParameters))


def refuse_unknown_options(commands: Any, words: Sequence[str]) -> None:
    """Refuse the first option that the command of a line does not have, with the line to type.

    Commands are click's by name; the line comes without the program.
    """
    if not words or words[0] not in commands:
        return
    command = commands[words[0]]
    takes_value = {
        name: not getattr(each, "is_flag", False)
        for each in command.params
        for name in (*each.opts, *each.secondary_opts)
        if name.startswith("-")
    } | {"--help": False}
    place = 1
    while place < len(words) and words[place] != "--":
        name, equals, _ = words[place].partition("=")
        if name.startswith("--") and name not in takes_value:
            raise ParameterError(_answer(words, place, list(takes_value)))
        place += 2 if takes_value.get(name) and not equals else 1


def _answer(words: Sequence[str], place: int, known: list[str]) -> str:
    """Say what an unknown option of a line may have meant."""
    given, equals, value = words[place].partition("=")
    rest = list(words[place + 1 :])
    if not equals and rest and not rest[0].startswith("--"):
        value = rest.pop(0)
    refused = f"flockenv {words[0]} has no option {given}"
    meant = given[2:].replace("-", "_")
    own = {name[2:].replace("-", "_"): name for name in known if name.startswith("--")}
    others = (*_FIELDS, *OPTIONS) if "--set" in known else ()
    found = meant if meant in {*own, *others} else nearest(meant, (*own, *others), cutoff=0.6)
    if found is None:
        if meant in _FIELDS:
            line = shlex.join(["flockenv", "run", "--set", f"{meant}={value or 'VALUE'}"])
            return f"{refused}: {meant} is a field of the flock: set it by `{line}`"
        return f"{refused}: see --help"
    if found in own:
        typed = [own[found], *([value] if value else [])]
    else:
        option = "--env" if found not in _FIELDS and "--env" in known else "--set"
        typed = [option, f"{found}={value or 'VALUE'}"]
    line = shlex.join(["flockenv", *words[:place], *typed, *rest])
    return f"{refused}: type `{line}`"
