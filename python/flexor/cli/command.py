"""A command whose options are given once."""

from __future__ import annotations

import itertools
from typing import Any

from typer.core import TyperCommand

from flexor.cli.console import print_error
from flexor.cli.studies import INTERRUPTED
from flexor.errors import InputError


class Command(TyperCommand):
    """A command that refuses options given twice, of which the last would win silently."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command; say it where nothing else is said of an interruption."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            print_error("interrupted.")
            return INTERRUPTED

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Check for repeated options before parsing."""
        names = {
            name: parameter
            for parameter in self.params
            if parameter.param_type_name == "option" and not parameter.multiple
            for name in parameter.opts
        }
        given: set[str] = set()
        for word in itertools.takewhile(lambda word: word != "--", args):
            parameter = names.get(word.partition("=")[0])
            if parameter is None or parameter.name is None:
                continue
            if parameter.name in given:
                raise InputError(f"{max(parameter.opts, key=len)} is given twice: give it once.")
            given.add(parameter.name)
        return super().parse_args(ctx, args)
