"""A command of the command line, which answers an unknown option with the line to type."""

import re
import shlex
from collections import Counter
from collections.abc import Sequence, Set
from dataclasses import fields
from typing import Any

import typer
import typer.core

from flockenv.envs.options import OPTIONS
from flockenv.errors import ParameterError, nearest
from flockenv.parameters import FlockParameters

_COMMA = r"[+-]?\d*,\d+"
_FIELDS = tuple(parameter.name for parameter in fields(FlockParameters))


class Command(typer.core.TyperCommand):
    """A command that refuses an option it does not have, or whose value it would ignore.

    An unknown option is answered with the line to type. If an option came twice, click would
    silently take the last value.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the command's words, as click does."""
        if not ctx.resilient_parsing:
            words = [self.name or "", *args]
            try:
                _, _, order = self.make_parser(ctx).parse_args(args=list(args))
            except Exception as error:
                # Typer has click's classes of errors, and exports few of them.
                name = getattr(error, "option_name", "")
                if type(error).__name__ != "NoSuchOption" or not name.startswith("--"):
                    raise
                known = [spelling for parameter in self.params for spelling in parameter.opts]
                raise ParameterError(_suggestion(words, name, known)) from None
            _refuse_repeated(order, {word.partition("=")[0] for word in args})
        try:
            return super().parse_args(ctx, list(args))
        except typer.BadParameter as error:
            _refuse_decimal_comma(args, error)
            raise


def _refuse_decimal_comma(args: Sequence[str], error: typer.BadParameter) -> None:
    """Suggest a point for a number that was typed with a comma."""
    names = error.param.opts if error.param else []
    pairs = zip(args, [*args[1:], ""], strict=True)
    given = [text.partition("=")[::2] if "=" in text else (text, after) for text, after in pairs]
    for name, text in given:
        if name in names and "integer" not in error.message and re.fullmatch(_COMMA, text):
            point = text.replace(",", ".")
            raise ParameterError(f"{name} {text} is not accepted: type `{name} {point}`") from None


def _refuse_repeated(order: Sequence[Any], given: Set[str]) -> None:
    """Refuse an option that takes one value and is given twice.

    The same flag may be repeated, but not contradicted.
    """
    for parameter, times in Counter(order).items():
        if parameter.multiple or times == 1 or parameter.param_type_name == "argument":
            continue
        if not parameter.is_flag or (
            given & {*parameter.opts} and given & {*parameter.secondary_opts}
        ):
            raise ParameterError(f"{parameter.opts[0]} is given twice: give it once")


def _suggestion(words: Sequence[str], unknown: str, known: list[str]) -> str:
    """Return a suggestion for an unknown option of a line."""
    index = [word.partition("=")[0] for word in words].index(unknown)
    given, equals, value = words[index].partition("=")
    rest = list(words[index + 1 :])
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
    line = shlex.join(["flockenv", *words[:index], *typed, *rest])
    return f"{refused}: type `{line}`"
