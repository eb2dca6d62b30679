"""Options that a command does not have are answered with the line to type, or come twice."""

import shlex
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from flockenv.envs.options import OPTIONS
from flockenv.errors import ParameterError, nearest
from flockenv.parameters import FlockParameters

_FIELDS = tuple(each.name for each in fields(FlockParameters))


def refuse_unknown_options(commands: Any, words: Sequence[str]) -> None:
    """Refuse the first option that the command of a line does not have, or whose value it ignores.

    An unknown one is answered with the line to type. Of a value that comes twice the last would
    count. Commands are click's by name; the line comes without the program.
    """
    if not words or words[0] not in commands:
        return
    named = {
        name: each
        for each in commands[words[0]].params
        for name in (*each.opts, *each.secondary_opts)
        if name.startswith("-")
    }
    takes_value = {name: not getattr(each, "is_flag", False) for name, each in named.items()} | {
        "--help": False
    }
    place, given = 1, dict[str, int]()
    while place < len(words) and words[place] != "--":
        name, equals, _ = words[place].partition("=")
        if name.startswith("--") and name not in takes_value:
            raise ParameterError(_answer(words, place, list(takes_value)))
        if name in named and not (each := named[name]).multiple:
            # The same flag twice says the same.
            value = name in each.secondary_opts if not takes_value[name] else place
            if given.setdefault(each.name, value) != value:
                raise ParameterError(f"{each.opts[0]} is given twice: give it once")
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
