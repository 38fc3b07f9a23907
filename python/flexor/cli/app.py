"""The command-line application: its commands and exit codes."""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from flexor.cli import (
    calibrate,
    compare,
    landscape,
    materials,
    methods,
    optimize,
    presets,
    reproduce,
    rerun,
    sets,
    simulate,
)
from flexor.cli.command import Command
from flexor.cli.console import print_error, spell_what_streams_lack
from flexor.cli.studies import LOST
from flexor.errors import ClusterError, InputError

app = typer.Typer(
    name="flexor",
    help="Design soft exosuits with the wearer in the loop.",
    epilog="Start with: flexor simulate finger --plot finger.png",
    add_completion=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)
# One line per command.
app.command("simulate", cls=Command)(simulate.simulate)
app.command("optimize", cls=Command)(optimize.optimize)
app.command("landscape", cls=Command)(landscape.landscape)
app.command("compare", cls=Command)(compare.compare)
app.command("rerun", cls=Command)(rerun.rerun)
app.command("calibrate", cls=Command)(calibrate.calibrate)
app.command("reproduce", hidden=True, context_settings=reproduce.ANYTHING)(reproduce.reproduce)
app.command("materials", cls=Command)(materials.materials)
app.command("presets")(presets.presets)
app.command("sets")(sets.sets)
app.command("methods")(methods.methods)


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


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and exit.

    Parameters
    ----------
    arguments : list of str, optional
        Arguments after `flexor`; by default those of the process.

    Notes
    -----
    Exit codes: 0 success; 1 completed with failures (such as a load step without equilibrium);
    2 invalid input; 3 cluster lost; 130 interrupted.
    """
    spell_what_streams_lack()
    try:
        code = app(args=arguments, prog_name="flexor", standalone_mode=False)
    except InputError as error:
        print_error(str(error))
        code = 2
    except BrokenPipeError:
        # Whoever read has left; what is still buffered goes nowhere.
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
        code = 130
    sys.exit(code if isinstance(code, int) else 0)
