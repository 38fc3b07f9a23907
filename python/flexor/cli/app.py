"""The command-line application: its commands and exit codes."""

from __future__ import annotations

import itertools
import os
import sys
import warnings
from functools import cache
from typing import Annotated, Any

import typer
from typer.core import TyperCommand
from typer.main import get_command

from flexor.cli import (
    bench,
    calibrate,
    compare,
    export,
    front,
    import_model,
    landscape,
    listings,
    materials,
    new,
    optimize,
    rerun,
    share,
    simulate,
    studio,
)
from flexor.cli.console import note, print_error, print_warnings, replace_unencodable_characters
from flexor.cli.folders import INTERRUPTED, LOST
from flexor.cli.interruption import interruptions_not_ignored
from flexor.errors import ClusterError, InputError


class Command(TyperCommand):
    """A command that rejects repeated options, of which the last would be used silently."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command; report an interruption that the command itself does not."""
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


class Calibrate(Command):
    """`flexor calibrate`, which takes `--out FOLDER --resume` as well, as it was until 0.1."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the older form as `--resume FOLDER`."""
        at = args.index("--resume") if "--resume" in args else len(args)
        alone = at == len(args) - 1 or (at < len(args) and args[at + 1].startswith("-"))
        if alone and "--out" in args[:-1]:
            note("deprecated: --out FOLDER --resume is now --resume FOLDER.")
            args = [*args[:at], *args[at + 1 :]]
            args[args.index("--out")] = "--resume"
        return super().parse_args(ctx, args)


app = typer.Typer(
    name="flexor",
    help="Design soft exosuits with the wearer in the loop.",
    epilog="Start with: flexor simulate finger --plot finger.png",
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)
# One line per command.
app.command("simulate", cls=Command)(simulate.simulate)
app.command("optimize", cls=Command)(optimize.optimize)
app.command("front", cls=Command)(front.front)
app.command("landscape", cls=Command)(landscape.landscape)
app.command("compare", cls=Command)(compare.compare)
app.command("rerun", cls=Command)(rerun.rerun)
app.command("calibrate", cls=Calibrate)(calibrate.calibrate)
app.command("export", cls=Command)(export.export)
app.command("import", cls=Command)(import_model.import_model)
app.command("bench", cls=Command)(bench.bench)
app.command("materials", cls=Command)(materials.materials)
app.command("share", cls=Command)(share.share)
app.command("studio", cls=Command)(studio.studio)
app.command("new", cls=Command)(new.new)
app.command("presets")(listings.presets)
app.command("sets")(listings.sets)
app.command("methods")(listings.methods)


@app.command(
    "reproduce",
    hidden=True,
    context_settings={"allow_extra_args": True, "ignore_unknown_options": True},
)
def reproduce(_: typer.Context) -> int:
    """Refer to `./dev reproduce`."""
    raise InputError(
        "flexor reproduce is now `./dev reproduce`, in a clone of the repository of Flexor."
    )


def _version(requested: bool) -> None:
    if requested:
        import flexor

        print(f"flexor {flexor.__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def root(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Design soft exosuits with the wearer in the loop."""
    if context.invoked_subcommand is None:
        print(context.get_help())


@cache
def _command() -> Any:
    """Return the application with all of its commands, which are built once per process."""
    return get_command(app)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line, with the arguments of the process by default, and exit.

    Exit codes: 0 success; 1 completed with failures (such as a load step without equilibrium);
    2 invalid input; 3 cluster lost; 130 interrupted.
    """
    replace_unencodable_characters()
    try:
        with warnings.catch_warnings(), interruptions_not_ignored():
            print_warnings()
            code = _command()(args=arguments, prog_name="flexor", standalone_mode=False)
    except InputError as error:
        print_error(str(error))
        code = 2
    except BrokenPipeError:
        # The reader closed the pipe; discard what is still buffered.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 141
    except OSError as error:
        where = f'"{error.filename}"' if error.filename else "a file"
        print_error(f"{where} cannot be written or read: {(error.strerror or str(error)).lower()}.")
        code = 2
    except MemoryError:
        print_error("there is not enough memory: ask for fewer steps, designs, elements or points.")
        code = 2
    except ClusterError as error:
        print_error(str(error))
        code = LOST
    except typer.TyperException as error:
        message = error.format_message()
        print_error(message if message.endswith((".", "?")) else f"{message}.")
        code = error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        print_error("interrupted.")
        code = INTERRUPTED
    sys.exit(code if isinstance(code, int) else 0)
