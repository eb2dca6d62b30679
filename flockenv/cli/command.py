"""Commands that answer an unknown option with the corrected command line."""

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

_DECIMAL_COMMA = r"[+-]?\d*,\d+"
_FIELDS = tuple(parameter.name for parameter in fields(FlockParameters))


class Command(typer.core.TyperCommand):
    """A command that refuses unknown options and options that are given twice.

    The error of an unknown option shows the corrected command line. Of an option that is given
    twice, click would silently take the last value.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the command's arguments, as click does."""
        if not ctx.resilient_parsing:  # A shell's completion parses unfinished lines.
            words = [self.name or "", *args]
            try:
                _, _, parsed_options = self.make_parser(ctx).parse_args(args=list(args))
            except Exception as error:
                # Typer does not export click's class of this error.
                name = getattr(error, "option_name", "")
                if type(error).__name__ != "NoSuchOption" or not name.startswith("--"):
                    raise
                known = [spelling for parameter in self.params for spelling in parameter.opts]
                raise ParameterError(_unknown_option(words, name, known)) from None
            _refuse_repeated(parsed_options, {word.partition("=")[0] for word in args})
        try:
            return super().parse_args(ctx, list(args))
        except typer.BadParameter as error:
            _refuse_decimal_comma(args, error)
            raise


def _refuse_decimal_comma(args: Sequence[str], error: typer.BadParameter) -> None:
    """Suggest a point for a number that was typed with a comma."""
    spellings = error.param.opts if error.param else []
    if "integer" in error.message:
        return  # A whole number with a point would be refused, too.
    for argument, next_argument in zip(args, [*args[1:], ""], strict=True):
        name, equals, value = argument.partition("=")
        number = value if equals else next_argument
        if name in spellings and re.fullmatch(_DECIMAL_COMMA, number):
            with_point = number.replace(",", ".")
            raise ParameterError(
                f"{name} {number} is not accepted: type `{name} {with_point}`"
            ) from None


def _refuse_repeated(parsed_options: Sequence[Any], spellings: Set[str]) -> None:
    """Refuse an option that takes one value and is given twice.

    A flag may be repeated, but not together with its opposite. `spellings` are the options as they
    were typed.
    """
    for parameter, times in Counter(parsed_options).items():
        if parameter.multiple or times == 1 or parameter.param_type_name == "argument":
            continue
        is_contradicted = spellings & {*parameter.opts} and spellings & {*parameter.secondary_opts}
        if not parameter.is_flag or is_contradicted:
            raise ParameterError(f"{parameter.opts[0]} is given twice: give it once")


def _unknown_option(words: Sequence[str], unknown: str, known: list[str]) -> str:
    """Return the error's text for an unknown option, with the corrected line if there is one.

    `words` are the command's name and its arguments; `known` are the spellings of its options.
    """
    index = [word.partition("=")[0] for word in words].index(unknown)
    spelling, equals, value = words[index].partition("=")
    following = list(words[index + 1 :])
    # Without an equals sign, the next word may be the value.
    if not equals and following and not following[0].startswith("--"):
        value = following.pop(0)
    refused = f"flockenv {words[0]} has no option {spelling}"
    name = spelling[2:].replace("-", "_")
    options = {option[2:].replace("-", "_"): option for option in known if option.startswith("--")}
    settable = (*_FIELDS, *OPTIONS) if "--set" in known else ()
    candidates = (*options, *settable)
    match = name if name in candidates else nearest(name, candidates, cutoff=0.6)
    if match is None:
        # Only a command without --set gets here with the name of a field.
        if name in _FIELDS:
            line = shlex.join(["flockenv", "run", "--set", f"{name}={value or 'VALUE'}"])
            return f"{refused}: {name} is a field of the flock: set it by `{line}`"
        return f"{refused}: see --help"
    if match in options:
        corrected = [options[match], *([value] if value else [])]
    else:
        option = "--env" if match not in _FIELDS and "--env" in known else "--set"
        corrected = [option, f"{match}={value or 'VALUE'}"]
    line = shlex.join(["flockenv", *words[:index], *corrected, *following])
    return f"{refused}: type `{line}`"
